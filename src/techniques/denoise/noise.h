// How noisy a cloud is, measured from itself.
#pragma once

#include <vector>

#include "core/prepared_cloud.h"
#include "core/progress.h"

namespace sfumato::denoise {

constexpr float isolated_support = 1.0f / 64;
constexpr float least_support = 0.1f;  ///< points with less are left out

/// Per point, how much its splat may say about a surface: 1 where it lies among equals, down to
/// `isolated_support` where it is isolated. From the distance R to the 8th neighbour, compared with
///   - the median of R over the neighbours, times 1.5: an outlier near a surface has neighbours that are
///   closer
///     together than it is to them, a point of a sparse surface has not (compare the local outlier factor,
///     Breunig et al. 2000); power of 4. The margin keeps random samples of a surface at 1;
///   - 0.45 times the median of R over places anywhere in the cloud's box, or twice its median over the
///   points if that
///     is more: outliers lie as far apart as places in the empty space lie from them, and 8 of points that
///     lie at random are within half of the usual distance with a probability of 1e-5; power of 12. The
///     median over the points alone would not do: density falls by orders of magnitude with the distance from
///     a scanner.
std::vector<float> splat_support(const PreparedCloud& prepared, Progress& progress);

/// `support`, and for splats with at least `least` the ratio of the area that their disc would have by Eq. 20
/// (Seemann 2018) to what is drawn of it, at most 100: a surface whose discs are cut at `radius_limit`,
/// because its points are far apart, or shrank because they lie in clutter (PreparedCloud::shrunk), is
/// covered by fewer of them, and weighs as much as any other.
std::vector<float> splat_worth(const PreparedCloud& prepared, const std::vector<float>& support, float least,
                               float radius_limit);

}  // namespace sfumato::denoise
