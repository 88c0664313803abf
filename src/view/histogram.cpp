#include "view/histogram.h"

#include <algorithm>
#include <cmath>

#include "core/numbers.h"

namespace sfumato::view {

Histogram histogram_of(const PointCloud& cloud, const std::string& number, std::size_t steps) {
  Histogram out;
  const auto value = numbers_of(cloud, number);
  if (!value) return out;
  bool any = false;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double v = value(i);
    if (!std::isfinite(v)) continue;
    out.low = any ? std::min(out.low, v) : v;
    out.high = any ? std::max(out.high, v) : v;
    any = true;
  }
  if (!any) return out;
  out.counts.resize(steps);
  const double per_unit = out.high > out.low ? double(steps) / (out.high - out.low) : 0;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (const double v = value(i); std::isfinite(v))
      ++out.counts[std::min(steps - 1, std::size_t((v - out.low) * per_unit))];
  return out;
}

}  // namespace sfumato::view
