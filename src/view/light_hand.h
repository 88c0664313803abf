// The light as a hand moves it: dragged as if it hung on a ball around the scene that one looks at.
#pragma once

#include <string>

#include "core/camera.h"
#include "core/point_cloud.h"
#include "core/vec.h"
#include "passes/light.h"

namespace sfumato::view {

/// Unit direction towards the light, world, as seen from the camera's target; of lights of the camera
/// where they stand now, as the renderer has it. Throws Error(usage) as Light::parse.
dvec3 towards_light(const RenderSettings& settings, const Camera& camera, UpAxis up);
/// The light after a drag of so many pixels: what is seen of the ball follows the cursor, half a turn over
/// the height of the picture. A light at a place keeps its distance from the target; others become
/// directions.
std::string drag_light(const RenderSettings& settings, const Camera& camera, UpAxis up, double dx_px,
                       double dy_px, int height_px);

}  // namespace sfumato::view
