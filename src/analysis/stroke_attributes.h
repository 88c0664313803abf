// What stroke-based splatting knows about every point beside its normal: cluster, size, and how far a stroke
// may reach.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "analysis/clusters.h"
#include "analysis/stroke_detail.h"
#include "core/param.h"
#include "core/prepared_cloud.h"

namespace sfumato::analysis {

enum class SizeOf { point, cluster };

/// Parameters of preparation, listed with those of the techniques (analysis/prepare.h).
struct StrokeOptions {
  ClusterOptions clusters;
  Auto<float> cluster_gap;  ///< scene units
  DetailOptions detail;
  int size_neighbors = 8;  ///< K of r
  float size_spread = 1;   ///< eps_r in standard deviations of the distances
  SizeOf size_of = SizeOf::point;
  void describe(ParamList& p);
};

/// s = r + spread eps_r of a point: mean distance to its (at most) K nearest neighbours plus the standard
/// deviation of those distances (dos Anjos 2017, Sec. 3.2.1). `distances` in scene units, any order; 0 when
/// there are none.
float stroke_size(std::vector<float>& distances, int k, float spread = 1);

/// Sizes that have support: no more than twice the median of the neighbours' sizes, so that an outlier
/// before a dense surface stays small; and where points fill space, as outliers and leaves do, no more
/// than twice the cloud's.
void cap_sizes(const NeighborGraph& graph, std::span<const NeighborhoodShape> shapes,
               std::vector<float>& sizes);

/// How far a stroke may reach from each point along the surface, scene units: to the border of the cluster,
/// to a crease (normals 30 degrees apart), to where the points end, or half across a strip. At most 100
/// stroke sizes; that, too, where the graph does not fit into memory.
std::vector<float> stroke_rooms(const NeighborGraph& graph, std::span<const float> labels,
                                std::span<const vec3> normals, std::span<const float> sizes,
                                std::span<const NeighborhoodShape> shapes = {},
                                Progress& progress = no_progress());

/// A direction without sign as a whole number that a float holds, good to a thousandth; 0 stands for none.
float pack_axis(const vec3& axis);
std::optional<vec3> unpack_axis(float code);

/// What `Attribute::cluster` stands for: the scalars `cluster`, `stroke_size`, `stroke_room`, `stroke_detail`
/// and `stroke_axis`
/// (`unpack_axis`: the direction of a strip, pole or fold), and normals where the cloud has none, each from
/// neighbours of its own cluster within 3 r (dos Anjos 2017, Sec. 3.2.2).
void add_clusters(PreparedCloud& prepared, const StrokeOptions& options, Progress& progress = no_progress());

}  // namespace sfumato::analysis
