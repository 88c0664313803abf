// The share of every pixel that a layer covers, its edges antialiased.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D depth_image;  // filled

uniform float d_min;
uniform bool antialias;

#include "techniques/layers/edge.glsl"
#define WEIGHTS_ONLY
#include "techniques/layers/gaussian.glsl"

bool filter_pixel(ivec2 pixel) {
  float depth = texelFetch(depth_image, pixel, 0).x;
  float covered = isinf(depth) ? 0.0 : 1.0;
  if (antialias && is_edge(pixel, depth)) {
    covered = 0.0;
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x) covered += isinf(depth_at(pixel + ivec2(x, y))) ? 0.0 : gaussian(x, y);
  }
  out_0 = vec4(covered);
  return true;
}
