// Empties a layer where no point vouches for it.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D evidence;

bool filter_pixel(ivec2 pixel) {
  if (texelFetch(evidence, pixel, 0).x > 0.0) return false;
  out_0 = vec4(infinity);
  out_1 = uvec4(0xffffffffu);
  return true;
}
