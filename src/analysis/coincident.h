// Points in one place.
#pragma once

#include "core/prepared_cloud.h"

namespace sfumato::analysis {

/// Of more than `most_in_one_place` points in one place the later ones (in file order) are left out:
/// all of them would paint the same pixels, and a picture of 100,000 would take 100,000 times as long as of
/// one. Over 256 nothing is seen of the rest at any opacity that shows at all: 1 - 0.97^256 > 0.999.
inline constexpr std::size_t most_in_one_place = 256;
void thin_places(PreparedCloud& prepared);

/// Of values of points those of some, in their order; of none none.
template <class T>
void keep_only(std::vector<T>& values, const std::vector<std::uint32_t>& kept) {
  if (values.empty()) return;
  for (std::size_t i = 0; i < kept.size(); ++i) values[i] = values[kept[i]];
  values.resize(kept.size());
}

}  // namespace sfumato::analysis
