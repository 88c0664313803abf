// Points in one place.
#pragma once

#include "core/prepared_cloud.h"

namespace sfumato::analysis {

/// Of more than `most_in_one_place` points in one place the later ones (in file order) are left out:
/// all of them would paint the same pixels, and a picture of 100,000 would take 100,000 times as long as of
/// one. Over 256 nothing is seen of the rest at any opacity that shows at all: 1 - 0.97^256 > 0.999.
inline constexpr std::size_t most_in_one_place = 256;
void thin_places(PreparedCloud& prepared);

}  // namespace sfumato::analysis
