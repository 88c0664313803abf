// Post-processing by the depth of a picture, by the processor, where OpenGL is software: eye-dome lighting
// and the ambient occlusion between its squares (relief.glsl), smooth outlines (depth_edges.glsl and
// smooth_outlines.glsl). Same arithmetic, but most pixels, which have neither, are left at the first look.
#pragma once

#include "core/image.h"
#include "passes/relief.h"
#include "passes/view.h"

namespace sfumato {

/// relief.glsl on `color`. `openness`: of squares, with the noise of the depth in them; `normal` is read for
/// radiance scaling.
void shade_relief(const View& view, const Relief::Options& options, float square_px,
                  const Image<float>& depth, const Image<vec2>& openness, const Image<vec4>& normal,
                  Image<vec4>& color);

/// Antialiases `color` at outlines and depth edges.
void smooth_outlines(const View& view, const Image<float>& depth, Image<vec4>& color);

}  // namespace sfumato
