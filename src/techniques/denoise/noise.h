// How noisy a cloud is, measured from itself.
#pragma once

#include <vector>

#include "core/prepared_cloud.h"
#include "core/progress.h"

namespace sfumato::denoise {

/// Median over a fixed sample of points of the standard deviation of their 64 nearest neighbours from their common
/// plane, scene units; 0 for fewer than 4 points. Ranging noise and the bend of the surface both count.
float plane_residual(const PreparedCloud& prepared);

constexpr float isolated_support = 1.0f / 64;
constexpr float least_support = 0.1f;  ///< points with less are left out

/// Per point, how much its splat may say about a surface: 1 where it lies among equals, down to `isolated_support` where
/// it is isolated. From the distance R to the 8th neighbour, compared with
///   - the median of R over the neighbours, times 1.5: a stray point near a surface has neighbours that are closer
///     together than it is to them, a point of a sparse surface has not (compare the local outlier factor, Breunig et
///     al. 2000); power of 4. The margin keeps random samples of a surface at 1;
///   - 0.45 times the median of R over places anywhere in the cloud's box, or twice its median over the points if that
///     is more: outliers lie as far apart as places in the empty space lie from them, and 8 of points that lie at random
///     are within half of the usual distance with a probability of 1e-5; power of 12. The median over the points alone
///     would not do: density falls by orders of magnitude with the distance from a scanner.
/// `usual_radius`, when given, becomes the radius of Eq. 20 (Seemann 2018) for those 8 neighbours.
std::vector<float> splat_support(const PreparedCloud& prepared, Progress& progress,
                                 std::vector<float>* usual_radius = nullptr);

/// `support`, and for splats with at least `least` whose radius is cut at `radius_limit` what they lost by it, the
/// ratio of the areas: a surface whose points are far apart then weighs as much where it is covered as any other. Discs
/// below half of `usual_radius` were shrunk because they lie in clutter (leaves): they are worth more by the ratio of the
/// radii, or none would ever be enough.
std::vector<float> splat_worth(const PreparedCloud& prepared, const std::vector<float>& support,
                               const std::vector<float>& usual_radius, float least, float radius_limit);

}  // namespace sfumato::denoise
