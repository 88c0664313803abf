// What becomes of a picture, by the processor, where OpenGL is software: shading (shade.glsl), eye-dome
// lighting and the ambient occlusion between its squares (relief.glsl), smooth outlines (depth_edges.glsl and
// smooth_outlines.glsl), background and encoding (finish.glsl). Same arithmetic, but most pixels, which have
// neither relief nor outlines, are left at the first look.
#pragma once

#include "core/image.h"
#include "passes/light.h"
#include "passes/relief.h"
#include "passes/view.h"

namespace sfumato {

/// Relief on `color`; `normal` is read for radiance scaling.
void shade_relief(const View& view, const Relief::Options& options, const Image<float>& depth,
                  const Image<vec4>& normal, Image<vec4>& color);

/// Antialiases `color` at outlines and depth edges.
void smooth_outlines(const View& view, const Image<float>& depth, Image<vec4>& color);

/// shade.glsl; `light_eye`: as shaders/lighting.glsl has it.
void shade(const View& view, const RenderSettings& settings, const vec4& light_eye, const Image<vec4>& albedo,
           const Image<float>& depth, const Image<vec4>& normal, Image<vec4>& color);

/// finish.glsl
void encode(const RenderSettings& settings, const Image<vec4>& color, Image<Rgba8>& rgba8);

}  // namespace sfumato
