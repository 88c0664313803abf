// Ambient occlusion of squares, and the noise of the depth in them (relief_pyramid.glsl and
// relief_occlusion.glsl), by the processor, where OpenGL is software. Same arithmetic.
#pragma once

#include "core/image.h"
#include "passes/relief.h"
#include "passes/view.h"

namespace sfumato {

/// Openness, and noise, scene units, of squares of Relief::octaves. Open where nothing is covered.
Image<vec2> find_openness(const View& view, const Relief::Options& options, const Image<float>& depth);

}  // namespace sfumato
