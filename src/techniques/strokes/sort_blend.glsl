// Sorts a pixel's fragments from the front, one selection a step, and mixes each into the running colour
// (dos Anjos 2017, Alg. 2, front to back): C += T a c, T *= 1 - a. The selected fragment is swapped to the end of the
// sorted part, so that the next step goes on from there.
#include "techniques/strokes/paint.glsl"

layout(binding = UNIT_INPUT + 1) uniform usampler2D offsets;
layout(binding = UNIT_INPUT + 2) uniform usampler2D cursors;
layout(binding = UNIT_INPUT + 3) uniform sampler2D before_0;
layout(binding = UNIT_INPUT + 4) uniform sampler2D before_1;
layout(binding = UNIT_INPUT + 5) uniform sampler2D before_2;
layout(rgba32ui, binding = 6) uniform uimageBuffer fragments;
layout(std430, binding = 0) buffer Unfinished { uint unfinished; };

uniform int first_step;
uniform int steps;
uniform ivec2 rows;
uniform uint fragment_room;

bool comes_before(uvec4 a, uvec4 b) {
  float za = uintBitsToFloat(a.x), zb = uintBitsToFloat(b.x);
  if (za != zb) return za < zb;
  uint sa = texelFetch(strokes, 6 * int(a.y) + 5).x, sb = texelFetch(strokes, 6 * int(b.y) + 5).x;
  return sa != sb ? sa < sb : a.y < b.y;
}

bool filter_pixel(ivec2 pixel) {
  if (pixel.y < rows.x || pixel.y >= rows.y) return false;
  vec4 color = vec4(0.0, 0.0, 0.0, 1.0);  // C, T
  vec4 normal = vec4(0.0);                // sums of weight times normal (eye) and shadow
  vec4 rest = vec4(0.0);                  // sum of weight times t
  if (first_step > 0) {
    color = texelFetch(before_0, pixel, 0);
    normal = texelFetch(before_1, pixel, 0);
    rest = texelFetch(before_2, pixel, 0);
  }
  int offset = int(texelFetch(offsets, pixel, 0).x);
  int count = min(int(texelFetch(cursors, pixel, 0).x), int(fragment_room) - offset);
  int step = first_step, end = min(count, first_step + steps);
  for (; step < end && color.a >= 0.005; ++step) {
    int nearest = step;
    uvec4 chosen = imageLoad(fragments, offset + step);
    uvec4 first = chosen;
    for (int j = step + 1; j < count; ++j) {
      uvec4 candidate = imageLoad(fragments, offset + j);
      if (comes_before(candidate, chosen)) {
        chosen = candidate;
        nearest = j;
      }
    }
    if (nearest != step) {
      imageStore(fragments, offset + nearest, first);
      imageStore(fragments, offset + step, chosen);
    }
    Paint p = paint_of(chosen, pixel);
    float weight = color.a * p.alpha;
    color.rgb += weight * p.color;
    color.a *= 1.0 - p.alpha;
    normal += weight * vec4(p.normal, p.shadow);
    rest.x += weight * p.t;
  }
  if (step < count && color.a >= 0.005) unfinished = 1u;
  out_0 = color;
  out_1 = normal;
  out_2 = rest;
  return true;
}
