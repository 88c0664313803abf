// Post-processing by the depth of a picture, by the processor, where OpenGL is software: eye-dome lighting
// and the ambient occlusion between its squares (relief.glsl), smooth outlines (depth_edges.glsl and
// smooth_outlines.glsl). Same arithmetic, but most pixels, which have neither, are left at the first look.
#pragma once

#include "core/image.h"
#include "passes/relief.h"
#include "passes/view.h"

namespace sfumato {

/// Of relief.glsl, as Relief::run sets it.
struct ReliefLook {
  float square_px = 2, radius_px = 0;
  float strength = 0, occlusion = 0;
  float orthographic_distance = 0, spacing = 0;
};
/// Darkens `color`. `openness`: of squares, with the noise of the depth in them.
void darken_relief(const View& view, const ReliefLook& look, const Image<float>& depth,
                   const Image<vec2>& openness, Image<vec4>& color);

/// Antialiases `color` at outlines and depth edges.
void smooth_outlines(const View& view, const Image<float>& depth, Image<vec4>& color);

}  // namespace sfumato
