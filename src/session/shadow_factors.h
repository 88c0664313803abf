// Shadow factors as numbers of the points, to be kept with the cloud (Dobrev, Rosenthal, Linsen 2010, Sec. 4:
// "point cloud shadow textures").
#pragma once

#include <vector>

#include "core/point_cloud.h"
#include "core/progress.h"
#include "gl/context.h"
#include "passes/light.h"

namespace sfumato {

/// One value per point, in the order of `cloud`: 0 dark to 1 lit, the share of the light's positions that it
/// sees. They are those of a picture with `shadows` hard or soft and the same light in which every point is
/// solid and the surface has normals (as in `splats`): normals that the cloud lacks are computed for the
/// test. Throws Error(usage) for a light of the camera (`fix_light` makes it one that stands somewhere) and
/// for shadows that are not found: off and stored.
std::vector<float> shadow_factors(gl::Context& context, const PointCloud& cloud,
                                  const RenderSettings& settings, Progress& progress = no_progress());

}  // namespace sfumato
