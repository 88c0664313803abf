// What parts of a cloud tell each other of its soft points, so that each part is drawn as it is in a picture
// of the whole. `field`: of PreparedCloud::with_surroundings.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "passes/gpu_cloud.h"
#include "passes/splat_raster.h"
#include "passes/visible_points.h"
#include "techniques/soft/solid_part.h"

namespace sfumato::soft {

/// VisiblePoints::values of a first round: the field.
VisiblePoints::Values sample_of_field(const PreparedCloud& part, std::span<const float> field);
/// Of a second one, for the threshold of the whole: radii of soft points; and of discs at solid points, where
/// those are measured among themselves, the radii, and how far what is around scatters.
std::vector<VisiblePoints::Values> sizes_of(const PreparedCloud& part, std::span<const float> field,
                                            float threshold, bool among_themselves);
/// What follows from both.
SolidPart::OfWhole solid_of(const std::vector<VisiblePoints::Values>& merged);

/// Soft points of a part that may be seen.
std::vector<VisiblePoints::SeenThrough> soft_in_view(const GpuCloud& part, std::span<const float> field,
                                                     const View& view, const SplatShape& shape);

/// Those of all parts as a cloud of their own.
struct Haze {
  std::unique_ptr<PreparedCloud> prepared;
  std::unique_ptr<GpuCloud> gpu;
  std::vector<float> field;
  /// `origin`: of all parts, of which `part` is one.
  void take_up(std::span<const VisiblePoints::SeenThrough> points, const GpuCloud& part, const dvec3& origin);
};

}  // namespace sfumato::soft
