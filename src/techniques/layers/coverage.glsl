// The share of every pixel that a layer covers, its outlines antialiased.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D depth_image;  // filled

uniform bool antialias;

#include "techniques/layers/edge.glsl"
#include "techniques/layers/gaussian.glsl"

bool is_outline(ivec2 pixel, float depth) {
  bool is_marked = false;
  for (int k = 0; k < 4; ++k)
    is_marked = is_marked || isinf(depth_at(pixel + cross_of_four[k])) != isinf(depth);
  return is_marked;
}

bool filter_pixel(ivec2 pixel) {
  float depth = texelFetch(depth_image, pixel, 0).x;
  float covered = 0.0;
  int taps = antialias && is_outline(pixel, depth) ? 9 : 0;
  for (int tap = 0; tap < taps; ++tap)
    covered += isinf(depth_at(pixel + gaussian_offset(tap))) ? 0.0 : gaussian_weight(tap);
  out_0 = vec4(taps > 0 ? covered : isinf(depth) ? 0.0 : 1.0);
  return true;
}
