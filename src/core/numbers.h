// The numbers that points have, under the names that users choose points by.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/point_cloud.h"

namespace sfumato {

/// The number of point i: of a scalar of the cloud, or x, y, z (world), elevation, red, green, blue, radius.
/// Empty when the cloud has none of that name. It refers to the cloud.
std::function<double(std::size_t)> numbers_of(const PointCloud& cloud, const std::string& name);
/// Every name that `numbers_of` knows.
std::vector<std::string> number_names(const PointCloud& cloud);
/// "the points have no 'x' to choose by; ...": what there is, and what is nearest.
std::string no_such_number(const PointCloud& cloud, const std::string& name);
/// A number, nothing around it, not NaN.
std::optional<double> parse_real(std::string_view text);

}  // namespace sfumato
