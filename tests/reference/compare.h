// Comparison of two images in two tiers: where the answer is certain (interior) the largest and the mean
// difference count; where a rounding decides (the band: rims of splats, depth thresholds) only how often
// pixels flip, and whether they flip to one side.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/image.h"
#include "core/vec.h"

namespace sfumato::testing {

struct Difference {
  std::size_t interior = 0, band = 0;  ///< pixels
  double max = 0, mean = 0;  ///< interior, of the largest component; infinite where only one is finite
  double flips = 0;          ///< share of the band's pixels that differ by more than the flip tolerance
  double bias = 0;           ///< band: mean signed difference, flips counted as +-1
};

inline double signed_difference(float a, float b) {
  if (a == b) return 0;  // also two infinities
  const double d = double(a) - double(b);
  return std::isnan(d) ? HUGE_VAL : d;
}
template <int N>
double signed_difference(const glm::vec<N, float>& a, const glm::vec<N, float>& b) {
  double worst = 0;
  for (int k = 0; k < N; ++k) {
    const double d = signed_difference(a[k], b[k]);
    if (std::abs(d) > std::abs(worst)) worst = d;
  }
  return worst;
}

/// `band`: non-zero where a rounding may decide.
template <class T>
Difference compare(const Image<T>& actual, const Image<T>& expected, const Image<std::uint8_t>& band,
                   double flip_tolerance) {
  Difference out;
  double flips = 0;
  for (std::size_t i = 0; i < actual.size(); ++i) {
    const double d = signed_difference(actual.data()[i], expected.data()[i]);
    if (band.data()[i]) {
      ++out.band;
      if (std::abs(d) > flip_tolerance) {
        ++flips;
        out.bias += d > 0 ? 1 : -1;
      }
    } else {
      ++out.interior;
      out.max = std::max(out.max, std::abs(d));
      out.mean += std::abs(d);
    }
  }
  out.mean /= double(std::max<std::size_t>(out.interior, 1));
  out.flips = flips / double(std::max<std::size_t>(out.band, 1));
  out.bias /= double(std::max<std::size_t>(out.band, 1));
  return out;
}

}  // namespace sfumato::testing
