// Adds a share of a picture to a sum.
#include "bindings.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D sum_image;
layout(binding = UNIT_INPUT + 1) uniform sampler2D picture;

uniform float share;

bool filter_pixel(ivec2 pixel) {
  out_0 = texelFetch(sum_image, pixel, 0) + share * texelFetch(picture, pixel, 0);
  return true;
}
