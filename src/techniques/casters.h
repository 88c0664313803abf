// How much of the light the points of a cloud stop, for shadows.
#pragma once

#include <memory>
#include <vector>

#include "passes/gpu_cloud.h"

namespace sfumato {

/// Of the opacity of every point of the prepared cloud towards the light, 0 (casts no shadow) to 1 (solid):
/// measures the spacing of those in between. Null where all are solid.
std::shared_ptr<const GpuCloud::Casters> make_casters(const GpuCloud& cloud,
                                                      const std::vector<float>& opacity);

}  // namespace sfumato
