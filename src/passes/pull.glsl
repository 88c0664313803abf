// Fine to coarse: the 4x4 kernel (1 3 3 1) x (1 3 3 1) / 64 of premultiplied samples. The gain of 4 keeps one sample
// among 2x2 children from being taken for a quarter of one, which would let coarser levels leak through.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D fine_a;
layout(binding = UNIT_INPUT + 1) uniform sampler2D fine_b;

uniform float depth_edge;  // steeper than this, in depth over width, is an edge; 0: there are none
uniform int level;         // of the finer image

// The 16 samples in rows. Loops of constant length: they unroll, and every texel is read once.
ivec2 place(int k) { return ivec2(k & 3, k >> 2); }
float kernel(int k) {
  ivec2 at = place(k);
  return (at.x == 1 || at.x == 2 ? 3.0 : 1.0) * (at.y == 1 || at.y == 2 ? 3.0 : 1.0) / 64.0;
}

bool filter_pixel(ivec2 pixel) {
  ivec2 first = 2 * pixel - 1, last = textureSize(fine_a, 0) - 1;
  vec4 samples[16];
  for (int k = 0; k < 16; ++k) {
    ivec2 at = first + place(k), inside = clamp(at, ivec2(0), last);
    samples[k] = at == inside ? texelFetch(fine_a, inside, 0) : vec4(0.0);  // weight 0 beyond the edge
  }

  // Samples on both sides of a depth edge have no mean: the side with more weight stays.
  float from = -infinity, to = infinity;
  if (depth_edge > 0.0) {
    float nearest = infinity, farthest = 0.0;
    for (int k = 0; k < 16; ++k) {
      bool there = samples[k].w > 0.0;
      float depth = samples[k].x / samples[k].w;
      nearest = min(nearest, there ? depth : infinity);
      farthest = max(farthest, there ? depth : 0.0);
    }
    float middle = 0.5 * (nearest + farthest), front = 0.0, rear = 0.0;
    for (int k = 0; k < 16; ++k) {
      float weight = kernel(k) * samples[k].w;
      if (samples[k].x < middle * samples[k].w) front += weight;
      else rear += weight;
    }
    if (farthest - nearest > depth_edge * 4.0 * float(1 << level) / pixels_at(nearest)) {
      if (front > rear) to = middle;
      else from = middle;
    }
  }

  vec4 a = vec4(0.0), b = vec4(0.0);
  for (int k = 0; k < 16; ++k) {
    bool mixes = samples[k].x >= from * samples[k].w && samples[k].x < to * samples[k].w;
    float weight = mixes ? kernel(k) : 0.0;
    a += weight * samples[k];
    if (level == 0) weight *= samples[k].w;  // the caller's b is not multiplied yet
    b += weight * texelFetch(fine_b, clamp(first + place(k), ivec2(0), last), 0);
  }
  float weight = min(1.0, 4.0 * a.w);
  float scale = a.w > 0.0 ? weight / a.w : 0.0;
  out_0 = vec4(a.xyz * scale, weight);
  out_1 = b * scale;
  return true;
}
