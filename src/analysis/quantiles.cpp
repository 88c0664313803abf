#include "analysis/quantiles.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace sfumato::analysis {
namespace {

constexpr std::size_t most_values = 1'000'000;

std::vector<float> sample(std::span<const float> values) {
  const std::size_t stride = (values.size() + most_values - 1) / most_values;
  std::vector<float> kept;
  for (std::size_t i = 0; i < values.size(); i += stride)
    if (!std::isnan(values[i])) kept.push_back(values[i]);
  return kept;
}

float quantile_of(std::vector<float>& values, double q) {
  if (values.empty()) return 0;
  const double place = std::clamp(q, 0.0, 1.0) * double(values.size() - 1);
  const auto low = values.begin() + std::ptrdiff_t(place);
  std::nth_element(values.begin(), low, values.end());
  const double fraction = place - std::floor(place);
  if (fraction == 0) return *low;
  const float high = *std::min_element(low + 1, values.end());
  return float(*low + fraction * (double(high) - *low));
}

}  // namespace

float quantile(std::span<const float> values, double q) {
  std::vector<float> kept = sample(values);
  return quantile_of(kept, q);
}

Quantiles quantiles(std::span<const float> values) {
  std::vector<float> kept = sample(values);
  const float q02 = quantile_of(kept, 0.02);
  return {q02, quantile_of(kept, 0.98)};
}

float normalized(float value, const Quantiles& range) {
  const float width = range.q98 - range.q02,
              rounding = 1e-5f * std::max(std::abs(range.q02), std::abs(range.q98));
  if (!(width > rounding) || std::isnan(value)) return 0;
  return std::clamp((value - range.q02) / width, 0.0f, 1.0f);
}

}  // namespace sfumato::analysis
