// How far to look for occluders, per square of the coarse depth map: l(z) = log2(s_hpr h / (2 tan(theta) z))
// (Bouchiba 2018, Eq. 1), s_hpr = removal_scale times the point spacing there.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D pyramid;

uniform int coarse_level;
uniform int levels;
uniform float removal_scale;

bool filter_pixel(ivec2 square) {
  // Where the square is empty the depth comes from ever larger ones: a gap between points may be wide.
  vec4 nearest = vec4(0.0);
  for (int l = coarse_level; l < levels && nearest.w <= 0.0; ++l)
    nearest = texelFetch(pyramid, square >> (l - coarse_level), l);
  float level = nearest.w > 0.0 ? log2(removal_scale * nearest.w * pixels_at(-nearest.z)) : 0.0;
  out_0 = vec4(clamp(level, 0.0, float(levels - 1)));
  return true;
}
