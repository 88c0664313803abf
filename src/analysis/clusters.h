// Clusters of points that belong together, by colour or, where there is none, by the bend of the surface.
//
// Q. Zhan, Y. Liang, Y. Xiao, "Color-based segmentation of point clouds", ISPRS Laser Scanning 2009, in the
// form of PCL's RegionGrowingRGB: grow, merge regions of like colour, merge what is too small. Seeds come in
// the order of the points, which is that of the curve (morton.h) for a prepared cloud: the result depends on
// neither threads nor the order of the file. A graph that does not fit into memory, and growth by normals, go
// by union-find over undirected edges, in parallel; on symmetric graphs both ways agree.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "analysis/neighbors.h"
#include "core/point_cloud.h"
#include "core/progress.h"

namespace sfumato::analysis {

struct ClusterOptions {
  int neighbors = 30;          ///< K of the graph (PCL's default)
  float point_threshold = 6;   ///< RGB distance, 0..255 each: neighbours this alike grow together
  float region_threshold = 5;  ///< RGB distance of means: segments this alike are merged
  std::optional<float> gap;    ///< scene units: only segments this near are merged; auto: 5 median spacings
  int min_size = 100;          ///< points: smaller clusters join the nearest one
  float angle_deg = 8;         ///< without colours: neighbours whose normals differ less grow together,
  float bend_deg = 12;         ///<   where the normals around a point differ less than this on average
};

/// The K nearest neighbours of every point, kept where memory allows and found again where it does not.
class NeighborGraph {
 public:
  using Visit = std::function<void(std::uint32_t point, std::span<const std::uint32_t> ids)>;
  NeighborGraph(std::span<const vec3> positions, int k, Progress& progress);
  /// From several threads, for different points; the neighbours come in no order.
  void for_each(const Visit& visit, std::string_view text) const;
  std::span<const vec3> positions() const { return tree_.positions(); }
  bool keeps() const { return keeps_; }
  /// Only while `keeps`.
  std::span<const std::uint32_t> of(std::size_t point) const { return {kept_.data() + point * k_, k_}; }

 private:
  NeighborTree tree_;
  std::size_t k_;
  bool keeps_;
  std::vector<std::uint32_t> kept_;
  Progress& progress_;
};

struct Clusters {
  std::vector<std::uint32_t> label;  ///< of every point, in [0, count), numbered by the first point
  std::uint32_t count = 0;
};

/// Throws Cancelled. `median_spacing` in scene units.
Clusters grow_clusters(const PointCloud& cloud, const NeighborGraph& graph, float median_spacing,
                       const ClusterOptions& options, Progress& progress = no_progress());

}  // namespace sfumato::analysis
