#include "analysis/isolation.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/quantiles.h"
#include "core/order.h"

namespace sfumato::analysis {
namespace {

constexpr std::size_t neighbors = 8, samples = 500;
static_assert(around_any_place == neighbors);

/// Radical inverse (Halton 1960): points in [0, 1) that fill it evenly.
double radical_inverse(std::size_t i, std::size_t base) {
  double value = 0, digit = 1;
  for (; i > 0; i /= base) value += (digit /= double(base)) * double(i % base);
  return value;
}

/// Places that fill the box of the points evenly. It holds 98 % of them along each axis, so that a few far
/// outliers do not decide it. `along(axis)`: their coordinates.
template <class Along>
std::vector<vec3> places_in_box(const Along& along) {
  vec3 low, high;
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<float> values = along(axis);
    low[axis] = quantile(values, 0.01), high[axis] = quantile(values, 0.99);
  }
  std::vector<vec3> places;
  for (std::size_t i = 1; i <= samples; ++i) {
    const vec3 at(radical_inverse(i, 2), radical_inverse(i, 3), radical_inverse(i, 5));
    places.push_back(low + at * (high - low));
  }
  return places;
}

/// Median distance from a place anywhere in the cloud's box to its 8th nearest point.
float empty_reach(const std::vector<vec3>& positions, const NeighborTree& tree) {
  const auto along = [&](int axis) {
    std::vector<float> values(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) values[i] = positions[i][axis];
    return values;
  };
  std::vector<float> reach;
  for (const vec3& place : places_in_box(along)) {
    KNearest nearest(neighbors);
    tree.search(place, nearest);
    reach.push_back(std::sqrt(distance2_of(nearest.heap().front())));
  }
  return quantile(reach, 0.5);
}

/// Median distance to the nearest but so many.
float reach_of(const Neighborhoods& around, std::size_t others) {
  std::vector<float> reach;
  for (std::size_t k = 0; k < around.places.size(); ++k)
    if (around.nearest[k].size() > others)
      reach.push_back(float(glm::length(around.nearest[k][others] - around.places[k])));
  return reach.empty() ? 0 : quantile(reach, 0.5);
}

}  // namespace

std::vector<dvec3> places_anywhere(const CloudFacts& whole) {
  if (whole.sample.empty()) return {};
  const auto along = [&](int axis) {
    std::vector<float> values;
    for (const CloudFacts::Point& point : whole.sample)
      values.push_back(float(point.place[axis] - whole.least[axis]));
    return values;
  };
  std::vector<dvec3> places;
  for (const vec3& place : places_in_box(along)) places.push_back(whole.least + dvec3(place));
  return places;
}

float empty_reach_of(const Neighborhoods& anywhere) { return reach_of(anywhere, neighbors - 1); }
/// The point itself is the nearest.
float usual_reach_of(const Neighborhoods& around_points) { return reach_of(around_points, neighbors); }

std::vector<float> support_of(const PreparedCloud& prepared, const NeighborTree& tree, Progress& progress) {
  const std::size_t n = prepared.cloud.size();
  if (n <= neighbors) return std::vector<float>(n, 1.0f);
  std::vector<float> reach(n);
  std::vector<std::array<std::uint32_t, neighbors>> neighbors_of(n);
  for_each_neighborhood(
      tree, int(neighbors),
      [&](std::uint32_t i, std::span<const std::uint32_t> ids, std::span<const float> distances2) {
        reach[i] = std::sqrt(distances2.back());
        std::copy(ids.begin(), ids.end(), neighbors_of[i].begin());
      },
      "splat support", progress);
  const WholeCloud* whole = prepared.whole.get();
  const float usual = whole ? whole->usual_reach : quantile(reach, 0.5),
              empty = whole ? whole->empty_reach : empty_reach(prepared.cloud.positions, tree),
              enough = std::max(2 * usual, 0.45f * empty);
  std::vector<float> support(n);
  for (std::size_t i = 0; i < n; ++i) {
    std::array<float, neighbors> around;
    for (std::size_t j = 0; j < neighbors; ++j) around[j] = reach[neighbors_of[i][j]];
    if (!(reach[i] > 0)) {  // nothing is less alone than points in one place
      support[i] = 1;
      continue;
    }
    const float own = reach[i];
    const float among_all = std::min(1.0f, enough / own),
                among_near = std::min(1.0f, 1.5f * median(around) / own);
    support[i] = std::max(isolated_support, std::pow(among_all * among_all * among_all * among_near, 4.0f));
  }
  return support;
}

}  // namespace sfumato::analysis
