// Coarse to fine, a whole level.
#include "push_level.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D pulled_a;
layout(binding = UNIT_INPUT + 1) uniform sampler2D pulled_b;
layout(binding = UNIT_INPUT + 2) uniform sampler2D coarse_a;
layout(binding = UNIT_INPUT + 3) uniform sampler2D coarse_b;

uniform bool top;
uniform int level;  // of the finer image

bool filter_pixel(ivec2 pixel) {
  Filled filled = Filled(texelFetch(pulled_a, pixel, 0), texelFetch(pulled_b, pixel, 0));
  if (level == 0) filled.b *= filled.a.w;  // the caller's b is not multiplied yet
  if (top) {
    float scale = filled.a.w > 0.0 ? 1.0 / filled.a.w : 0.0;
    filled.a *= scale;
    filled.b *= scale;
  } else {
    filled = push(filled, pixel, level, coarse_a, coarse_b);
  }
  out_0 = filled.a;
  out_1 = filled.b;
  return true;
}
