// What parts of a cloud tell each other of its soft points, so that each part is drawn as it is in a picture
// of the whole. `own_field`: of the part without what surrounds it.
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
VisiblePoints::Values sample_of_field(const PreparedCloud& part, std::span<const float> own_field);

/// About how many points of the whole are soft and solid, at least one each: as a merged first round has it,
/// and so the same for all parts.
struct Numbers {
  std::uint64_t soft = 1, solid = 1;
  bool operator==(const Numbers&) const = default;
};
Numbers numbers_of(const VisiblePoints::Values& field, float threshold);

/// Places in the prepared cloud, ascending, and the `haze_radii` there.
struct SoftOfPart {
  std::vector<std::uint32_t> places;
  std::vector<float> radii;
};
SoftOfPart soft_of(const PreparedCloud& part, std::span<const float> own_field, float threshold);

/// Of a second round, for the threshold of the whole: how many points are soft, and the radii of a sample of
/// so many; two more kinds for discs.
std::vector<VisiblePoints::Values> sizes_of(const PreparedCloud& part, const SoftOfPart& soft,
                                            const Numbers& numbers);
/// Radii of discs at a sample of the solid points, which are measured among themselves, and how far what is
/// around them scatters. `field`: of PreparedCloud::with_surroundings.
void add_discs(std::vector<VisiblePoints::Values>& sizes, const PreparedCloud& part, const SoftOfPart& soft,
               const Numbers& numbers, std::span<const float> field, float threshold);
/// What follows from both rounds.
SolidPart::OfWhole solid_of(const std::vector<VisiblePoints::Values>& merged);
/// Throws Error(usage) where the soft points of the whole are too many to be handed out.
void require_few(std::uint64_t soft);

/// Soft points of a part that may be seen, or that count in the depth of the haze in the `measured` views.
std::vector<VisiblePoints::SeenThrough> soft_in_view(const GpuCloud& part, const SoftOfPart& soft,
                                                     std::span<const float> own_field, const View& view,
                                                     const SplatShape& shape,
                                                     std::span<const Camera> measured);

/// Those of all parts as a cloud of their own.
struct Haze {
  std::unique_ptr<PreparedCloud> prepared;
  std::unique_ptr<GpuCloud> gpu;
  std::vector<float> field;
  /// `origin`: of all parts, of which `part` is one.
  void take_up(std::span<const VisiblePoints::SeenThrough> points, const GpuCloud& part, const dvec3& origin);
};

}  // namespace sfumato::soft
