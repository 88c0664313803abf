#include "analysis/sight.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "core/order.h"

namespace sfumato::analysis {
namespace {

/// Spearman's, of values of which none is given twice.
double rank_correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const auto ranks = [](const std::vector<double>& values) {
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::sort(order.begin(), order.end(),
              [&](std::size_t i, std::size_t j) { return values[i] < values[j]; });
    std::vector<double> places(values.size());
    for (std::size_t k = 0; k < order.size(); ++k) places[order[k]] = double(k);
    return places;
  };
  const std::vector<double> first = ranks(a), second = ranks(b);
  double squares = 0;
  for (std::size_t i = 0; i < first.size(); ++i) squares += (first[i] - second[i]) * (first[i] - second[i]);
  const double n = double(first.size());
  return n > 1 ? 1 - 6 * squares / (n * (n * n - 1)) : 0;
}

}  // namespace

Sight sight_of(std::span<const dvec3> points, const dvec3& eye, const dvec3& along, const dvec3& up) {
  constexpr double cone = 1, within = 0.98;  // tan 45 degrees
  const dvec3 right = glm::normalize(glm::cross(along, up)), above = glm::cross(right, along);
  std::vector<double> x, y, depths;
  for (const dvec3& p : points) {
    const double depth = glm::dot(p - eye, along);
    const double u = glm::dot(p - eye, right) / depth, v = glm::dot(p - eye, above) / depth;
    if (depth > 0 && std::max(std::abs(u), std::abs(v)) < cone)
      x.push_back(u), y.push_back(v), depths.push_back(depth);
  }
  if (!(double(depths.size()) > within * double(points.size()))) return {};
  const auto ends = [](std::vector<double> values) {
    return std::pair(value_at_share(values, 0.02), value_at_share(values, 0.98));
  };
  const auto [left, end] = ends(x);
  const auto [bottom, top] = ends(y);
  const int side = std::clamp(int(std::sqrt(double(depths.size()) / 8)), 4, 64);  // eight points a cell
  const auto cell = [&](double value, double low, double high) {
    return std::clamp(int((value - low) / std::max(high - low, 1e-300) * side), 0, side - 1);
  };
  std::vector<double> nearest(std::size_t(side * side), 1e300);
  std::vector<std::size_t> place(depths.size());
  for (std::size_t i = 0; i < depths.size(); ++i) {
    place[i] = std::size_t(cell(y[i], bottom, top) * side + cell(x[i], left, end));
    nearest[place[i]] = std::min(nearest[place[i]], depths[i]);
  }
  // A surface at 70 degrees from the line of sight spans three widths of a cell in depth.
  const double behind = 1 + 3 * std::max(end - left, top - bottom) / side;
  std::size_t seen = 0;
  for (std::size_t i = 0; i < depths.size(); ++i) seen += depths[i] < nearest[place[i]] * behind;
  return {double(seen) / double(depths.size()), rank_correlation(y, depths)};
}

double is_one_picture(const Sight& sight) {
  return std::clamp((sight.first - 0.75) / (0.9 - 0.75), 0.0, 1.0);
}

}  // namespace sfumato::analysis
