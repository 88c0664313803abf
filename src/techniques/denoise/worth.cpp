#include "techniques/denoise/worth.h"

#include <algorithm>

namespace sfumato::denoise {
namespace {

constexpr float most_worth = 100;  // some forty of these fill a bin (bins.glsl)

}  // namespace

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
