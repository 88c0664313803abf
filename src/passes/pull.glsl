// Fine to coarse: the 4x4 kernel (1 3 3 1) x (1 3 3 1) / 64 of premultiplied samples. The gain of 4 keeps one sample
// among 2x2 children from being taken for a quarter of one, which would let coarser levels leak through.
#include "bindings.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D fine_a;
layout(binding = UNIT_INPUT + 1) uniform sampler2D fine_b;

bool filter_pixel(ivec2 pixel) {
  ivec2 size = textureSize(fine_a, 0);
  vec4 a = vec4(0.0), b = vec4(0.0);
  for (int y = -1; y <= 2; ++y)
    for (int x = -1; x <= 2; ++x) {
      ivec2 at = 2 * pixel + ivec2(x, y);
      if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, size))) continue;  // weight 0 beyond the edge
      float kernel = (x == 0 || x == 1 ? 3.0 : 1.0) * (y == 0 || y == 1 ? 3.0 : 1.0) / 64.0;
      a += kernel * texelFetch(fine_a, at, 0);
      b += kernel * texelFetch(fine_b, at, 0);
    }
  float weight = min(1.0, 4.0 * a.a);
  float scale = a.a > 0.0 ? weight / a.a : 0.0;
  out_0 = vec4(a.rgb * scale, weight);
  out_1 = b * scale;
  return true;
}
