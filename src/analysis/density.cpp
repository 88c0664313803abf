#include "analysis/density.h"

#include <limits>
#include <numbers>

namespace sfumato::analysis {

std::vector<float> surface_density(const NeighborTree& tree) {
  constexpr int most = 16;
  std::vector<float> density(tree.positions().size(), std::numeric_limits<float>::quiet_NaN());
  for_each_neighborhood(
      tree, most,
      [&](std::uint32_t point, std::span<const std::uint32_t> ids, std::span<const float> distances2) {
        const float area = std::numbers::pi_v<float> * (distances2.empty() ? 0 : distances2.back());
        if (area > 0 && ids.size() > 1) density[point] = float(ids.size() - 1) / area;
      });
  return density;
}

}  // namespace sfumato::analysis
