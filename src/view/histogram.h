// How often which value occurs: what a range of colours is chosen by.
#pragma once

#include <string>
#include <vector>

#include "core/point_cloud.h"

namespace sfumato::view {

struct Histogram {
  double low = 0, high = 0;         ///< the least and the greatest value
  std::vector<std::size_t> counts;  ///< of as many equal steps between them; empty: there are no values
};

/// Of a number of the points, as `color_points` shows it (core/numbers.h names them). Values that are no
/// numbers do not count.
Histogram histogram_of(const PointCloud& cloud, const std::string& number, std::size_t steps);

}  // namespace sfumato::view
