// How much splats say about a surface.
#pragma once

#include <vector>

#include "core/prepared_cloud.h"

namespace sfumato::denoise {

constexpr float least_support = 0.1f;  ///< points with less are left out

/// `support` (PreparedCloud), and for splats with at least `least` the ratio of the area that their disc
/// would have by Eq. 20 (Seemann 2018) to what is drawn of it, at most 100: a surface whose discs are cut at
/// `radius_limit`, because its points are far apart, or shrank because they lie in clutter
/// (PreparedCloud::shrunk), is covered by fewer of them, and weighs as much as any other.
std::vector<float> splat_worth(const PreparedCloud& prepared, const std::vector<float>& support, float least,
                               float radius_limit);

}  // namespace sfumato::denoise
