#include "analysis/regions.h"

#include <algorithm>
#include <functional>
#include <limits>

namespace sfumato::analysis {
namespace {

bool holds(const Bounds& region, const dvec3& place, double reach) {
  return glm::all(glm::greaterThanEqual(place, region.min - reach)) &&
         glm::all(glm::lessThan(place, region.max + reach));
}

}  // namespace

std::vector<Bounds> regions_of(const PointCloud& sample, std::size_t count) {
  constexpr double everywhere = std::numeric_limits<double>::infinity();
  std::vector<dvec3> places(sample.size());
  for (std::size_t i = 0; i < places.size(); ++i) places[i] = sample.world(i);
  std::vector<Bounds> regions;
  const std::function<void(std::size_t, std::size_t, Bounds, std::size_t)> halve =
      [&](std::size_t first, std::size_t last, const Bounds& box, std::size_t parts) {
        if (parts < 2) return regions.push_back(box);
        dvec3 least(everywhere), most(-everywhere);
        for (std::size_t i = first; i < last; ++i)
          least = glm::min(least, places[i]), most = glm::max(most, places[i]);
        const dvec3 size = most - least;
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const std::size_t lower = parts / 2, middle = first + (last - first) * lower / parts;
        Bounds below = box, above = box;
        if (first < last) {
          std::nth_element(places.begin() + std::ptrdiff_t(first), places.begin() + std::ptrdiff_t(middle),
                           places.begin() + std::ptrdiff_t(last),
                           [&](const dvec3& a, const dvec3& b) { return a[axis] < b[axis]; });
          below.max[axis] = above.min[axis] = places[middle][axis];
        }
        halve(first, middle, below, lower);
        halve(middle, last, above, parts - lower);
      };
  halve(0, places.size(), {dvec3(-everywhere), dvec3(everywhere)}, count);
  return regions;
}

double reach_of(const WholeCloud& whole) { return 32.0 * whole.median_spacing; }

PointCloud points_near(const PointCloud& part, const Bounds& region, double reach) {
  std::vector<std::uint32_t> near;
  for (std::uint32_t i = 0; i < part.size(); ++i)
    if (holds(region, part.world(i), reach)) near.push_back(i);
  return select(part, near);
}

Share share_of(const std::vector<PointCloud>& parts, const Bounds& region) {
  PointCloud all;
  std::vector<std::uint32_t> numbers;
  for (const PointCloud& part : parts) {
    if (part.empty()) continue;
    append(all, part);
    numbers.insert(numbers.end(), part.source_index.begin(), part.source_index.end());
  }
  all.source_index = numbers;
  std::vector<std::uint32_t> own, around;
  for (std::uint32_t i = 0; i < all.size(); ++i) (holds(region, all.world(i), 0) ? own : around).push_back(i);
  for (auto* each : {&own, &around})
    std::sort(each->begin(), each->end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(numbers[a], a) < std::pair(numbers[b], b);
    });
  return {select(all, own), select(all, around)};
}

}  // namespace sfumato::analysis
