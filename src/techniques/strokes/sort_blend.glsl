// Sorts a pixel's fragments from the front, one selection a step, and mixes each into the running colour
// (dos Anjos 2017, Alg. 2, front to back): C += T a c, T *= 1 - a. The selected fragment changes places with the first of
// the list, which then begins with the second: the next step goes on from there.
#include "techniques/strokes/paint.glsl"

layout(binding = UNIT_INPUT + 3) uniform sampler2D before_0;
layout(binding = UNIT_INPUT + 4) uniform sampler2D before_1;
layout(binding = UNIT_INPUT + 5) uniform sampler2D before_2;
layout(r32ui, binding = IMAGE_FRAGMENT_CURSOR) uniform uimage2D heads;
layout(rgba32ui, binding = IMAGE_FRAGMENTS) uniform uimageBuffer fragments;
layout(std430, binding = 0) buffer Unfinished { uint unfinished; };

uniform int first_step;
uniform int steps;
uniform ivec2 rows;

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
  uint head = imageLoad(heads, pixel).x;
  for (int step = 0; step < steps && head != no_fragment && color.a >= 0.005; ++step) {
    uvec4 first = imageLoad(fragments, int(head)), chosen = first;
    uint nearest = head;
    for (uint k = first.w; k != no_fragment;) {
      uvec4 candidate = imageLoad(fragments, int(k));
      if (comes_before(candidate, chosen)) {
        chosen = candidate;
        nearest = k;
      }
      k = candidate.w;
    }
    // What was mixed is not needed any more.
    if (nearest != head) imageStore(fragments, int(nearest), uvec4(first.xyz, chosen.w));
    head = first.w;
    Paint p = paint_of(chosen, pixel);
    float weight = color.a * p.alpha;
    color.rgb += weight * p.color;
    color.a *= 1.0 - p.alpha;
    normal += weight * vec4(p.normal, p.shadow);
    rest.x += weight * p.t;
  }
  if (head != no_fragment && color.a >= 0.005) unfinished = 1u;
  imageStore(heads, pixel, uvec4(head));
  out_0 = color;
  out_1 = normal;
  out_2 = rest;
  return true;
}
