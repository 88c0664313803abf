// Fine to coarse: the 4x4 kernel (1 3 3 1) x (1 3 3 1) / 64 of premultiplied samples. The gain of 4 keeps one sample
// among 2x2 children from being taken for a quarter of one, which would let coarser levels leak through.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D fine_a;
layout(binding = UNIT_INPUT + 1) uniform sampler2D fine_b;

uniform float depth_edge;  // steeper than this, in depth over width, is an edge; 0: there are none
uniform int level;         // of the finer image

float kernel(int x, int y) { return (x == 0 || x == 1 ? 3.0 : 1.0) * (y == 0 || y == 1 ? 3.0 : 1.0) / 64.0; }

bool filter_pixel(ivec2 pixel) {
  ivec2 size = textureSize(fine_a, 0);
  ivec2 lo = max(2 * pixel - 1, ivec2(0)), hi = min(2 * pixel + 2, size - 1);  // weight 0 beyond the edge

  // Samples on both sides of a depth edge have no mean: the side with more weight stays.
  float from = -infinity, to = infinity;
  if (depth_edge > 0.0) {
    float nearest = infinity, farthest = 0.0;
    for (int y = lo.y; y <= hi.y; ++y)
      for (int x = lo.x; x <= hi.x; ++x) {
        vec4 a = texelFetch(fine_a, ivec2(x, y), 0);
        if (a.w <= 0.0) continue;
        nearest = min(nearest, a.x / a.w);
        farthest = max(farthest, a.x / a.w);
      }
    if (farthest - nearest > depth_edge * 4.0 * float(1 << level) / pixels_at(nearest)) {
      float middle = 0.5 * (nearest + farthest), front = 0.0, rear = 0.0;
      for (int y = lo.y; y <= hi.y; ++y)
        for (int x = lo.x; x <= hi.x; ++x) {
          vec4 a = texelFetch(fine_a, ivec2(x, y), 0);
          float weight = kernel(x - 2 * pixel.x, y - 2 * pixel.y) * a.w;
          if (a.x < middle * a.w) front += weight;
          else rear += weight;
        }
      if (front > rear) to = middle;
      else from = middle;
    }
  }

  vec4 a = vec4(0.0), b = vec4(0.0);
  for (int y = lo.y; y <= hi.y; ++y)
    for (int x = lo.x; x <= hi.x; ++x) {
      vec4 sample_a = texelFetch(fine_a, ivec2(x, y), 0);
      if (sample_a.x < from * sample_a.w || sample_a.x >= to * sample_a.w) continue;
      float weight = kernel(x - 2 * pixel.x, y - 2 * pixel.y);
      a += weight * sample_a;
      b += weight * texelFetch(fine_b, ivec2(x, y), 0);
    }
  float weight = min(1.0, 4.0 * a.w);
  float scale = a.w > 0.0 ? weight / a.w : 0.0;
  out_0 = vec4(a.xyz * scale, weight);
  out_1 = b * scale;
  return true;
}
