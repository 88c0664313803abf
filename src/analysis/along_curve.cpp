#include "analysis/along_curve.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "analysis/morton.h"

namespace sfumato::analysis {
namespace {

/// On either side along the curve.
constexpr std::size_t looked_at = 2;

/// What is near the usual places tells them apart on the curve, however far a stray one lies.
std::pair<vec3, vec3> box_along_the_curve(std::span<const vec3> places) {
  PointCloud cloud;
  cloud.positions.assign(places.begin(), places.end());
  const Bounds all = bounds(cloud), usual = robust_bounds(cloud);
  const double reach = 100 * usual.diagonal();
  if (reach == 0) return {vec3(all.min), vec3(all.max)};
  return {vec3(glm::max(all.min, usual.min - reach)), vec3(glm::min(all.max, usual.max + reach))};
}

}  // namespace

std::vector<std::uint32_t> order_along_curve(std::span<const vec3> places) {
  const auto [low, high] = box_along_the_curve(places);
  const std::vector<std::uint64_t> keys = curve_keys(places, low, high);
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
  for (std::uint32_t k = 0; k < places.size(); ++k) order.emplace_back(keys[k], k);
  std::sort(order.begin(), order.end());
  std::vector<std::uint32_t> numbers;
  for (const auto& [key, k] : order) numbers.push_back(k);
  return numbers;
}

std::vector<std::uint32_t> nearest_along_curve(std::span<const vec3> positions, std::span<const vec3> places,
                                               Progress& progress) {
  const std::size_t count = places.size();
  const auto [low, high] = box_along_the_curve(places);
  const std::vector<std::uint64_t> keys = curve_keys(places, low, high);
  std::vector<std::uint32_t> nearest(positions.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, positions.size(), 4096), [&](const auto& range) {
    progress.check();
    const auto own_keys = curve_keys(positions.subspan(range.begin(), range.size()), low, high);
    std::size_t at = 0;
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      // Points follow it: mostly they are the same.
      const std::uint64_t key = own_keys[i - range.begin()];
      if ((at > 0 && keys[at - 1] > key) || (at < count && keys[at] <= key))
        at = std::size_t(std::upper_bound(keys.begin(), keys.end(), key) - keys.begin());
      float least = std::numeric_limits<float>::infinity();
      for (std::size_t k = at - std::min(at, looked_at); k < std::min(count, at + looked_at); ++k) {
        const vec3 away = places[k] - positions[i];
        if (const float distance2 = glm::dot(away, away); distance2 < least)
          least = distance2, nearest[i] = std::uint32_t(k);
      }
    }
  });
  return nearest;
}

}  // namespace sfumato::analysis
