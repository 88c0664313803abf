// One more smoothing of a layer than the one that blending does.
#include "bindings.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D color_image;
layout(binding = UNIT_INPUT + 1) uniform sampler2D depth_image;

uniform float d_min;

#include "techniques/layers/gaussian.glsl"

bool filter_pixel(ivec2 pixel) {
  out_0 = smoothed(pixel, texelFetch(depth_image, pixel, 0).x);
  return true;
}
