#include "techniques/casters.h"

#include <algorithm>
#include <span>

#include "analysis/spacing.h"
#include "passes/shadows.h"

namespace sfumato {

std::shared_ptr<const GpuCloud::Casters> make_casters(const GpuCloud& cloud,
                                                      const std::vector<float>& opacity) {
  if (std::all_of(opacity.begin(), opacity.end(),
                  [](float each) { return each >= ShadowMaps::solid_opacity; }))
    return nullptr;
  const std::vector<vec3>& positions = cloud.prepared().cloud.positions;
  std::vector<vec3> see_through;  // in Morton order, as their cloud
  for (std::size_t i = 0; i < opacity.size(); ++i)
    if (opacity[i] >= ShadowMaps::least_opacity && opacity[i] < ShadowMaps::solid_opacity)
      see_through.push_back(positions[i]);
  float spacing = 0;
  if (!see_through.empty()) {
    spacing = cloud.median_spacing();
    if (see_through.size() < positions.size()) {
      const analysis::NeighborTree tree(see_through);
      Batch all{0, std::uint32_t(see_through.size()), {}, {}, spacing};
      // Never finer than the cloud: d_min grows with it.
      spacing = std::max(spacing, analysis::measure_spacing({&all, 1}, tree));
    }
  }
  return std::make_shared<const GpuCloud::Casters>(
      GpuCloud::Casters{cloud.make_values("casters", opacity), spacing});
}

}  // namespace sfumato
