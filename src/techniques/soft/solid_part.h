// Normals and radii of the solid points. Where points were chosen to be seen through, they are measured among
// the solid ones alone: the ground below trees is sparse, and neighbours in the leaves make it neither flat
// nor closed.
#pragma once

#include <optional>

#include "analysis/nearby.h"
#include "analysis/whole.h"
#include "passes/gpu_cloud.h"

namespace sfumato::soft {

class SolidPart {
 public:
  /// Of the solid points of a cloud of which a part is drawn.
  struct OfWhole {
    std::uint64_t points = 0;
    bool has_soft = false;    ///< there are others beside them
    float median_radius = 0;  ///< of Eq. 20 among themselves, scene units; 0: not measured
    bool is_rough = false;    ///< WholeCloud::is_rough
    bool operator==(const OfWhole&) const = default;
  };
  /// Measures anew when the cloud, its field, the threshold or the settings changed. `field`: of
  /// PreparedCloud::with_surroundings. `among_themselves`: apart from the soft points, where normals and
  /// radii were computed and not given. `clamp`: radii of points that stand alone are cut to `isolated` times
  /// the expected; `all` has the surroundings of every point. `of_whole`: null where the cloud is no part.
  void update(GpuCloud& cloud, std::span<const float> field, float threshold, bool among_themselves,
              bool clamp, const analysis::Nearby* all, const OfWhole* of_whole, Progress& progress);
  /// Of a part what `OfWhole` is made of: discs among the solid points at places of its own. None where
  /// normals and radii were given.
  static analysis::Discs discs_at(const PreparedCloud& part, std::span<const float> field, float threshold,
                                  std::vector<dvec3> places);
  /// Spacing of the solid points, scene units; the cloud's unless measured among themselves.
  float spacing() const { return spacing_; }
  /// Normals and radii of the solid part; null: those of the cloud.
  const std::shared_ptr<const GpuCloud::Shapes>& shapes() const { return shapes_; }

 private:
  struct Key {
    std::uint64_t serial;
    std::shared_ptr<const GpuCloud::Values> field;
    float threshold;
    bool among_themselves, clamp;
    OfWhole of_whole;
    bool operator==(const Key&) const = default;
  };
  std::optional<Key> key_;  ///< what was measured
  float spacing_ = 0;
  std::shared_ptr<const GpuCloud::Shapes> shapes_;
};

}  // namespace sfumato::soft
