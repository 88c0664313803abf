// One step of pull-push from coarse to fine: y_l = x_l + (1 - w_l) B(y_{l+1}), B = bilinear, (9 3 3 1) / 16.
#include "frame.glsl"

uniform float depth_edge;  // steeper than this, in depth over width, is an edge; 0: there are none

struct Filled {
  vec4 a, b;
};

// `pulled`: what pull left at this pixel of `level`, premultiplied; the samplers hold the filled level above.
Filled push(Filled pulled, ivec2 pixel, int level, sampler2D coarse_a, sampler2D coarse_b) {
  ivec2 last = textureSize(coarse_a, 0) - 1;
  ivec2 own = pixel / 2;
  ivec2 other = clamp(own + 2 * (pixel & 1) - 1, ivec2(0), last);
  ivec2 x_other = ivec2(other.x, own.y), y_other = ivec2(own.x, other.y);
  vec4 a0 = texelFetch(coarse_a, own, 0), a1 = texelFetch(coarse_a, x_other, 0),
       a2 = texelFetch(coarse_a, y_other, 0), a3 = texelFetch(coarse_a, other, 0);
  vec4 kernel = vec4(9.0, 3.0, 3.0, 1.0) / 16.0;
  float weight = pulled.a.w, rest = 1.0 - weight;
  if (depth_edge > 0.0) {
    // Only what lies on this side of a depth edge: the side of the sample, else of the coarse pixel it falls into.
    float depth = weight > 0.0 ? pulled.a.x / weight : a0.x;
    vec4 apart = abs(vec4(a0.x, a1.x, a2.x, a3.x) - depth);
    kernel *= vec4(lessThanEqual(apart, vec4(depth_edge * 4.0 * float(1 << level) / pixels_at(depth))));
    float sum = dot(kernel, vec4(1.0));
    if (sum > 0.0) {
      kernel /= sum;
    } else {  // nothing there on this side: the sample alone
      kernel = vec4(0.0);
      pulled.a /= weight;
      pulled.b /= weight;
    }
  }
  kernel *= rest;
  pulled.a += kernel.x * a0 + kernel.y * a1 + kernel.z * a2 + kernel.w * a3;
  pulled.b += kernel.x * texelFetch(coarse_b, own, 0) + kernel.y * texelFetch(coarse_b, x_other, 0) +
              kernel.z * texelFetch(coarse_b, y_other, 0) + kernel.w * texelFetch(coarse_b, other, 0);
  return pulled;
}
