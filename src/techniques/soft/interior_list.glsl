// What the interior models share: the records of a pixel are visited in ascending order. Up to 256 are sorted in local
// memory; longer lists are left to passes of their own (interior_long.glsl). Mesa ends all loops of an invocation after
// 65,535 rounds altogether: a pass does no more than `most_rounds`.
#include "fragment_list.glsl"

layout(binding = UNIT_FRAGMENTS) uniform usamplerBuffer fragments;
layout(binding = UNIT_INPUT + 2) uniform sampler2D solid_color;
layout(std430, binding = 3) buffer Counts { uint unfinished_count; uint overflow_count; };

uniform int visit_rounds;  // of loops within a visit, at most

const int most_rounds = 60000, most_local = 256;

vec2 ray_pixel;
float last_t;         // where the ray was last
int open_count;       // points that it is inside of
vec4 weighted;        // sum of w (color, 1) over them, w = 1 - d/r (Eq. 11)
vec4 plain;           // the same with w = 1
vec3 color;           // of what was visited, premultiplied
float transmittance;

// Of the model.
void visit(uvec2 record);

void begin_ray(ivec2 pixel) {
  ray_pixel = vec2(pixel) + 0.5;
  last_t = 0.0;
  open_count = 0;
  weighted = plain = vec4(0.0);
  color = vec3(0.0);
  transmittance = 1.0;
}

void count_in(vec4 point, float weight, float side) {
  weighted += side * weight * point;
  plain += side * point;
}

void pass_through(float depth, vec3 of_color) {
  float rest = transmittance * exp(-depth);  // Eqs. 2 and 14
  color += (transmittance - rest) * of_color;
  transmittance = rest;
}
vec3 mean_color() { return weighted.a > 1e-6 ? weighted.rgb / weighted.a : plain.rgb / plain.a; }

bool transparent() { return transmittance > 1e-5; }
vec4 over_solid(ivec2 pixel) {
  vec4 solid = texelFetch(solid_color, pixel, 0);
  return vec4(max(color, vec3(0.0)) + transmittance * solid.rgb, 1.0 - transmittance * (1.0 - solid.a));
}

bool before(uvec2 a, uvec2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); }

// A record costs a round each for its copy and its visit, and in 8 merges two each.
bool is_short(int count) { return count <= most_local && count * (20 + visit_rounds) <= most_rounds; }

#ifdef LONG_LISTS
#include "techniques/soft/interior_long.glsl"
#else
uvec2 local_records[most_local];

void sort_local(int count) {
  uvec2 merged[most_local];
  for (int width = 1; width < count; width *= 2) {
    for (int low = 0; low < count; low += 2 * width) {
      int middle = min(low + width, count), high = min(low + 2 * width, count), a = low, b = middle;
      for (int k = low; k < high; ++k) {
        bool take_a = a < middle && (b >= high || !before(local_records[b], local_records[a]));
        merged[k] = take_a ? local_records[a++] : local_records[b++];
      }
    }
    for (int k = 0; k < count; ++k) local_records[k] = merged[k];
  }
}

bool filter_pixel(ivec2 pixel) {
  int count = int(imageLoad(fragment_cursor, pixel).x), first = first_fragment(pixel);
  if (!is_short(count)) {
    atomicAdd(unfinished_count, 1u);
    return false;
  }
  for (int k = 0; k < count; ++k) local_records[k] = texelFetch(fragments, first + k).xy;
  sort_local(count);
  begin_ray(pixel);
  for (int k = 0; k < count && transparent(); ++k) visit(local_records[k]);
  out_0 = over_solid(pixel);
  return true;
}
#endif
