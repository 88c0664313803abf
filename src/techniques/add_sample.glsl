// Adds one sample of a picture to the sum of those before it, as a share of the whole (premultiplied linear colours).
#include "bindings.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D sum_image;
layout(binding = UNIT_INPUT + 1) uniform sampler2D sample_image;
uniform float share;
uniform bool is_first;  // what the sum holds is then undefined

bool filter_pixel(ivec2 pixel) {
  out_0 = share * texelFetch(sample_image, pixel, 0);
  if (!is_first) out_0 += texelFetch(sum_image, pixel, 0);
  return true;
}
