// Empties the pixels that no point vouches for.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D evidence;

bool filter_pixel(ivec2 pixel) {
  if (texelFetch(evidence, pixel, 0).x > 0.0) return false;
  out_0 = vec4(0.0);
  out_1 = vec4(infinity);
  out_2 = vec4(0.0, 0.0, 0.0, 1.0);
  return true;
}
