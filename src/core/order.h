// Values by their rank, without sorting all of them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>

namespace sfumato {

/// The value that stood at `place` were they sorted; they come to lie in another order. Needs more than
/// `place`.
template <class Values>
auto nth_value(Values&& values, std::size_t place) {
  const auto at = std::begin(values) + std::ptrdiff_t(place);
  std::nth_element(std::begin(values), at, std::end(values));
  return *at;
}

/// The middle one, of two the upper. Needs one at least.
template <class Values>
auto median(Values&& values) {
  return nth_value(values, std::size(values) / 2);
}

/// The value below which the share `q` of them lies, itself one of them. Needs one at least.
/// (`analysis::quantile` interpolates.)
template <class Values>
auto value_at_share(Values&& values, double q) {
  return nth_value(values, std::size_t(q * double(std::size(values) - 1)));
}

}  // namespace sfumato
