#include "analysis/surface_noise.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "analysis/normals.h"
#include "analysis/quantiles.h"

namespace sfumato::analysis {
namespace {

constexpr std::size_t noise_places = 128;
constexpr std::array<std::size_t, 4> scales{1536, 384, 96, 24};
/// Between the thickness of noise, once as large from twice as far, and that of edges, twice.
constexpr float as_thick = std::numbers::sqrt2_v<float>;
/// Of a plane over its width, as deviations: a ball has 1.
constexpr float flat = 0.25f;

float noise_at(const NeighborTree& tree, std::uint32_t at) {
  const std::span<const vec3> positions = tree.positions();
  KNearest nearest(scales.front());
  tree.search(positions[at], nearest);
  std::vector<std::uint64_t> keys = nearest.heap();
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> ids(keys.size());
  std::transform(keys.begin(), keys.end(), ids.begin(), id_of);
  std::array<float, scales.size()> thickness{};
  for (std::size_t s = 0; s < scales.size(); ++s) {
    const auto frame = local_frame(positions, at, std::span(ids).first(std::min(scales[s], ids.size())));
    if (!frame) return 0;
    thickness[s] = std::sqrt(frame->variance.x);
    if (frame->variance.x > flat * flat * frame->variance.y) thickness[s] = INFINITY;
  }
  for (std::size_t s = 0; s + 1 < scales.size(); ++s)
    if (thickness[s] < as_thick * thickness[s + 1]) return std::isinf(thickness[s]) ? 0 : thickness[s];
  return 0;
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

}  // namespace sfumato::analysis
