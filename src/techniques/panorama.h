// Everything around a place in one picture.
#pragma once

#include "techniques/renderer.h"

namespace sfumato {

/// An equirectangular panorama, `camera.width` x `camera.height` (twice as wide as high), from
/// `camera.position`; its middle looks along the camera's direction as seen from above, its rows are level
/// with `up`. Six square views with overlap are rendered and sampled, colours between pixels, the rest at the
/// nearest one. Depth is the distance from the place. The key light of shadows is that of the view along the
/// middle. What techniques find for themselves (opacities, thicknesses, the range of depths) they find once
/// for all six.
RenderOutput render_panorama(Renderer& renderer, std::span<const Item> items, const Camera& camera,
                             const dvec3& up, const RenderSettings& settings, const RenderWants& wants = {},
                             Progress& progress = no_progress());

}  // namespace sfumato
