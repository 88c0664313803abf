// Coarse to fine: y_l = x_l + (1 - w_l) B(y_{l+1}), B = bilinear, (9 3 3 1) / 16.
#include "bindings.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D pulled_a;
layout(binding = UNIT_INPUT + 1) uniform sampler2D pulled_b;
layout(binding = UNIT_INPUT + 2) uniform sampler2D coarse_a;
layout(binding = UNIT_INPUT + 3) uniform sampler2D coarse_b;

uniform bool top;

bool filter_pixel(ivec2 pixel) {
  vec4 a = texelFetch(pulled_a, pixel, 0), b = texelFetch(pulled_b, pixel, 0);
  float weight = a.a;
  if (top) {
    float scale = weight > 0.0 ? 1.0 / weight : 0.0;
    out_0 = a * scale;
    out_1 = b * scale;
    return true;
  }
  ivec2 last = textureSize(coarse_a, 0) - 1;
  ivec2 own = pixel / 2;
  ivec2 other = clamp(own + 2 * (pixel & 1) - 1, ivec2(0), last);
  ivec2 x_other = ivec2(other.x, own.y), y_other = ivec2(own.x, other.y);
  float rest = (1.0 - weight) / 16.0;
  out_0 = a + rest * (9.0 * texelFetch(coarse_a, own, 0) + 3.0 * texelFetch(coarse_a, x_other, 0) +
                      3.0 * texelFetch(coarse_a, y_other, 0) + texelFetch(coarse_a, other, 0));
  out_1 = b + rest * (9.0 * texelFetch(coarse_b, own, 0) + 3.0 * texelFetch(coarse_b, x_other, 0) +
                      3.0 * texelFetch(coarse_b, y_other, 0) + texelFetch(coarse_b, other, 0));
  return true;
}
