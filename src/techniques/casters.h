// How much of the light the points of a cloud stop, for shadows.
#pragma once

#include <string>
#include <vector>

#include "passes/gpu_cloud.h"

namespace sfumato {

/// Gives every point of the prepared cloud its opacity towards the light, 0 (casts no shadow) to 1 (solid);
/// an empty list makes all of them solid. Measures the spacing of those in between. `key`: see
/// GpuCloud::set_casters.
void set_casters(GpuCloud& cloud, const std::vector<float>& opacity, std::string key);

}  // namespace sfumato
