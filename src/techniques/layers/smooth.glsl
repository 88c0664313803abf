// 3 x 3 Gaussian over the pixels of the same layer (Dobrev 2010, Sec. 3): neighbours without a sample or farther
// than d_min in depth do not count.
#include "bindings.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D color_image;
layout(binding = UNIT_INPUT + 1) uniform sampler2D depth_image;

uniform float d_min;

bool filter_pixel(ivec2 pixel) {
  float depth = texelFetch(depth_image, pixel, 0).x;
  out_0 = vec4(0.0);
  if (isinf(depth)) return true;
  ivec2 size = textureSize(depth_image, 0);
  vec4 sum = vec4(0.0);
  float weights = 0.0;
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) {
      ivec2 at = pixel + ivec2(x, y);
      if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, size))) continue;
      if (!(abs(texelFetch(depth_image, at, 0).x - depth) <= d_min)) continue;
      float weight = (x == 0 ? 2.0 : 1.0) * (y == 0 ? 2.0 : 1.0);
      sum += weight * texelFetch(color_image, at, 0);
      weights += weight;
    }
  out_0 = sum / weights;
  return true;
}
