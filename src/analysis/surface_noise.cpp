#include "analysis/surface_noise.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "analysis/normals.h"
#include "analysis/quantiles.h"

namespace sfumato::analysis {
namespace {

constexpr std::array<std::size_t, 4> scales{around_noise_place, 384, 96, 24};
/// Between the thickness of noise, once as large from twice as far, and that of edges, twice.
constexpr float as_thick = std::numbers::sqrt2_v<float>;
/// Of a plane over its width, as deviations: a ball has 1.
constexpr float flat = 0.25f;

/// `ids`: what is nearest to a point, itself first.
float noise_among(std::span<const vec3> positions, std::uint32_t at, std::span<const std::uint32_t> ids) {
  std::array<float, scales.size()> thickness{};
  for (std::size_t s = 0; s < scales.size(); ++s) {
    const auto frame = local_frame(positions, at, ids.first(std::min(scales[s], ids.size())));
    if (!frame) return 0;
    thickness[s] = std::sqrt(frame->variance.x);
    if (frame->variance.x > flat * flat * frame->variance.y) thickness[s] = INFINITY;
  }
  for (std::size_t s = 0; s + 1 < scales.size(); ++s)
    if (thickness[s] < as_thick * thickness[s + 1]) return std::isinf(thickness[s]) ? 0 : thickness[s];
  return 0;
}

float noise_at(const NeighborTree& tree, std::uint32_t at) {
  KNearest nearest(scales.front());
  tree.search(tree.positions()[at], nearest);
  std::vector<std::uint64_t> keys = nearest.heap();
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> ids(keys.size());
  std::transform(keys.begin(), keys.end(), ids.begin(), id_of);
  return noise_among(tree.positions(), at, ids);
}

}  // namespace

float surface_noise(const NeighborTree& tree) {
  const std::size_t n = tree.positions().size();
  if (n < scales.front()) return 0;
  std::vector<float> noise(std::min(n, noise_places));
  tbb::parallel_for(std::size_t(0), noise.size(),
                    [&](std::size_t k) { noise[k] = noise_at(tree, std::uint32_t(k * n / noise.size())); });
  return float(quantile(noise, 0.75));
}

float noise_of(const Neighborhoods& around) {
  std::vector<float> noise;
  for (std::size_t k = 0; k < around.places.size(); ++k) {
    std::vector<vec3> near;
    for (const dvec3& at : around.nearest[k]) near.emplace_back(at - around.places[k]);
    std::vector<std::uint32_t> ids(near.size());
    std::iota(ids.begin(), ids.end(), 0u);
    noise.push_back(noise_among(near, 0, ids));
  }
  return quantile(noise, 0.75);
}

}  // namespace sfumato::analysis
