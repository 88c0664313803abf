// Coarse to fine: y_l = x_l + (1 - w_l) B(y_{l+1}), B = bilinear, (9 3 3 1) / 16.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D pulled_a;
layout(binding = UNIT_INPUT + 1) uniform sampler2D pulled_b;
layout(binding = UNIT_INPUT + 2) uniform sampler2D coarse_a;
layout(binding = UNIT_INPUT + 3) uniform sampler2D coarse_b;

uniform bool top;
uniform float depth_edge;  // as in pull.glsl
uniform int level;         // of the finer image

bool filter_pixel(ivec2 pixel) {
  vec4 a = texelFetch(pulled_a, pixel, 0), b = texelFetch(pulled_b, pixel, 0);
  float weight = a.w;
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
  vec4 a0 = texelFetch(coarse_a, own, 0), a1 = texelFetch(coarse_a, x_other, 0),
       a2 = texelFetch(coarse_a, y_other, 0), a3 = texelFetch(coarse_a, other, 0);
  vec4 kernel = vec4(9.0, 3.0, 3.0, 1.0) / 16.0;
  if (depth_edge > 0.0) {
    // Only what lies on this side of a depth edge: the side of the sample, else of the coarse pixel it falls into.
    float depth = weight > 0.0 ? a.x / weight : a0.x;
    vec4 apart = abs(vec4(a0.x, a1.x, a2.x, a3.x) - depth);
    kernel *= vec4(lessThanEqual(apart, vec4(depth_edge * 4.0 * float(1 << level) / pixels_at(depth))));
    float sum = dot(kernel, vec4(1.0));
    if (sum <= 0.0) {
      out_0 = a / weight;
      out_1 = b / weight;
      return true;
    }
    kernel /= sum;
  }
  kernel *= 1.0 - weight;
  out_0 = a + kernel.x * a0 + kernel.y * a1 + kernel.z * a2 + kernel.w * a3;
  out_1 = b + kernel.x * texelFetch(coarse_b, own, 0) + kernel.y * texelFetch(coarse_b, x_other, 0) +
          kernel.z * texelFetch(coarse_b, y_other, 0) + kernel.w * texelFetch(coarse_b, other, 0);
  return true;
}
