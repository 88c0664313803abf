// Second visit: hits inside the chosen bin (Eq. 5).
#include "techniques/denoise/bins.glsl"

layout(binding = UNIT_INPUT + 1) uniform sampler2D choice;  // bin or -1, weight, threshold

// A hit far out on the rim must not vanish in fixed point, or a pixel that only rims cover has no colour. Where only
// rims meet the unit of the sums is 2^-40, and this is 2^11 of them.
const float least_weight = 1.0 / 536870912.0;

// Distance behind the bin's border in bin sizes, or -1 outside of the bin.
float place_in_bin(ivec2 pixel, float t, float chosen) {
  if (chosen < 0.0) return -1.0;
  float distance = bin_distance(t, bin_origin(pixel));
  uint b = bin_of(distance), wanted = uint(chosen);
#ifdef OVERLAPPING
  if (b != wanted && !(b == wanted + 1u && reaches_earlier(distance, b))) return -1.0;
#else
  if (b != wanted) return -1.0;
#endif
  return min(distance - bin_start(wanted), 1.0);  // beyond 1 in the last of the dense bins only
}

// w, w rgb, w n (eye, facing the camera), w place, w shadow; two's complement unless FAST.
#ifdef FAST
layout(r32f, binding = 0) coherent uniform imageBuffer sums;
#else
layout(r32ui, binding = 0) uniform uimageBuffer sums;
#endif
uniform int sum_stride;

void add_sum(int at, float value) {
#ifdef FAST
  imageAtomicAdd(sums, at, value);
#else
  imageAtomicAdd(sums, at, uint(int(round(value))));
#endif
}

void add_attributes(ivec2 pixel, float table_weight, Splat splat, bool has_normal, float rho, vec4 color, float place) {
  float w = splat_weight(rho);
  if (covers > 0.0) w *= evidence(splat);
  w = max(w, least_weight);
#ifndef FAST
  // The weight in the table sets the unit: the sum is 2^24, or less than 2^30 where splats with a support of 1/64 at
  // least count less in the table than here.
  w = round(w * (16777216.0 / max(table_weight, 1.0 / weight_unit)));
#endif
  int at = (pixel.y * image_width + pixel.x) * sum_stride;
  add_sum(at, w);
  add_sum(at + 1, w * color.r);
  add_sum(at + 2, w * color.g);
  add_sum(at + 3, w * color.b);
  if (has_normal) {
    vec3 normal = dot(splat.normal, ray_slope(vec2(pixel) + 0.5)) > 0.0 ? -splat.normal : splat.normal;
    add_sum(at + 4, w * normal.x);
    add_sum(at + 5, w * normal.y);
    add_sum(at + 6, w * normal.z);
  }
  add_sum(at + 7, w * place);
#ifdef SPLAT_SHADOW
  add_sum(at + 8, w * color.a);
#endif
}
