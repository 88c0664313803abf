#include "techniques/denoise/noise.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/neighbors.h"
#include "analysis/quantiles.h"
#include "core/order.h"

namespace sfumato::denoise {
namespace {

constexpr std::size_t samples = 500;
constexpr float most_worth = 100;  // some forty of these fill a bin (bins.glsl)

/// Radical inverse (Halton 1960): points in [0, 1) that fill it evenly.
double radical_inverse(std::size_t i, std::size_t base) {
  double value = 0, digit = 1;
  for (; i > 0; i /= base) value += (digit /= double(base)) * double(i % base);
  return value;
}

/// Median distance from a place anywhere in the cloud's box to its k-th nearest point. The box holds 98 % of
/// the points along each axis, so that a few far outliers do not decide it.
float empty_reach(const std::vector<vec3>& positions, const analysis::NeighborTree& tree, std::size_t k) {
  vec3 low, high;
  std::vector<float> along(positions.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < positions.size(); ++i) along[i] = positions[i][axis];
    low[axis] = analysis::quantile(along, 0.01), high[axis] = analysis::quantile(along, 0.99);
  }
  std::vector<float> reach;
  for (std::size_t i = 1; i <= samples; ++i) {
    const vec3 at(radical_inverse(i, 2), radical_inverse(i, 3), radical_inverse(i, 5));
    analysis::KNearest nearest(k);
    tree.search(low + at * (high - low), nearest);
    reach.push_back(std::sqrt(analysis::distance2_of(nearest.heap().front())));
  }
  return analysis::quantile(reach, 0.5);
}

}  // namespace

std::vector<float> splat_support(const PreparedCloud& prepared, Progress& progress) {
  constexpr std::size_t k = 8;
  const std::size_t n = prepared.cloud.size();
  if (n <= k) return std::vector<float>(n, 1.0f);
  std::vector<float> reach(n);
  std::vector<std::array<std::uint32_t, k>> neighbors_of(n);
  const analysis::NeighborTree tree(prepared.cloud.positions);
  analysis::for_each_neighborhood(
      tree, int(k),
      [&](std::uint32_t i, std::span<const std::uint32_t> ids, std::span<const float> distances2) {
        reach[i] = std::sqrt(distances2.back());
        std::copy(ids.begin(), ids.end(), neighbors_of[i].begin());
      },
      "splat support", progress);
  const float enough =
      std::max(2 * analysis::quantile(reach, 0.5), 0.45f * empty_reach(prepared.cloud.positions, tree, k));
  std::vector<float> support(n);
  for (std::size_t i = 0; i < n; ++i) {
    std::array<float, k> around;
    for (std::size_t j = 0; j < k; ++j) around[j] = reach[neighbors_of[i][j]];
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

std::vector<float> splat_worth(const PreparedCloud& prepared, const std::vector<float>& support, float least,
                               float radius_limit) {
  std::vector<float> worth = support;
  for (std::size_t i = 0; i < worth.size() && i < prepared.cloud.radii.size(); ++i) {
    const float radius = prepared.cloud.radii[i], drawn = std::min(radius, radius_limit);
    if (support[i] < least || !(radius > 0)) continue;
    const float lost = (prepared.shrunk.empty() ? radius : radius / prepared.shrunk[i]) / drawn;
    worth[i] *= std::min(lost * lost, most_worth);
  }
  return worth;
}

}  // namespace sfumato::denoise
