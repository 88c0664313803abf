// Base model: between two neighbouring places where the ray enters or leaves a sphere, the densities of all open
// spheres are integrated exactly and add up; the colour is the mean of the open spheres (Seemann 2018, Sec. 3.1).
#define SOFT_READ
#include "techniques/soft/sphere.glsl"
#include "techniques/soft/interior_sort.glsl"

layout(binding = UNIT_INPUT + 2) uniform sampler2D solid_color;
layout(binding = UNIT_INPUT + 3) uniform sampler2D solid_t_image;  // ray distance of the first solid hit, or infinity
layout(std430, binding = 3) buffer Overflow { uint overflow_count; };

const int most_open = 64;

struct Open {
  uint slot;
  float middle, radius, delta;
  float depth;   // optical depth of the whole chord over radial_depth
  float before;  // integral up to the last place
  float weight;  // Eq. 11
};
Open open_spheres[most_open];
int open_count;
vec4 weighted;  // sum of w (color, 1)
vec4 plain;     // the same with w = 1

float integral(Open sphere, float t) {
  float s = (t - sphere.middle) / sphere.radius, half_length = half_chord(sphere.delta);
  s = clamp(s, -half_length, half_length);
#ifdef DENSITY_UNIFORM
  return 0.5 * s;
#else
  return radial_integral(s, sphere.delta);
#endif
}

// Opens the sphere at t. Where no more fit, returns its optical depth up to the solid surface at `solid_t`: it is then
// applied at once.
float enter(uint slot, float t, float solid_t, vec2 pixel) {
  SoftPoint point = soft_point(int(slot));
  SoftRay ray = soft_ray(point.center, point.radius, pixel);
  float whole = radial_depth(ray.delta);
  float depth = modulated_depth(point.cone, point.share, ray.delta, lambda_of(point.opacity) * whole);
  Open sphere = Open(slot, ray.middle, point.radius, ray.delta, whole > 1e-9 ? depth / whole : 0.0, 0.0,
                     max(1.0 - ray.delta, 0.0));
  sphere.before = integral(sphere, t);
  vec4 color = vec4(point.color, 1.0);
  if (open_count == most_open) {
    atomicAdd(overflow_count, 1u);
    return sphere.depth * (integral(sphere, solid_t) - sphere.before);
  }
  weighted += sphere.weight * color;
  plain += color;
  open_spheres[open_count++] = sphere;
  return 0.0;
}

void leave(uint slot) {
  for (int k = 0; k < open_count; ++k) {
    if (open_spheres[k].slot != slot) continue;
    vec4 color = vec4(soft_point(int(slot)).color, 1.0);
    weighted -= open_spheres[k].weight * color;
    plain -= color;
    open_spheres[k] = open_spheres[--open_count];
    break;
  }
  if (open_count == 0) weighted = plain = vec4(0.0);  // leave no rounding behind
}

bool filter_pixel(ivec2 pixel) {
  vec4 solid = texelFetch(solid_color, pixel, 0);
  float solid_t = texelFetch(solid_t_image, pixel, 0).x;
  int count = sort_records(pixel);
  open_count = 0;
  weighted = plain = vec4(0.0);
  vec3 color = vec3(0.0);
  float transmittance = 1.0;
  for (int k = 0; k < count && transmittance > 1e-5; ++k) {
    uvec2 record = sorted_record(k);
    float t = uintBitsToFloat(record.x >> 1), depth = 0.0;
    for (int j = 0; j < open_count; ++j) {
      float now = integral(open_spheres[j], t);
      depth += open_spheres[j].depth * max(now - open_spheres[j].before, 0.0);
      open_spheres[j].before = now;
    }
    if (open_count > 0) {
      vec3 mean = weighted.a > 1e-6 ? weighted.rgb / weighted.a : plain.rgb / plain.a;
      float rest = transmittance * exp(-depth);  // Eq. 2
      color += (transmittance - rest) * mean;
      transmittance = rest;
    }
    if ((record.x & 1u) != 0u) {
      leave(record.y);
    } else {
      float at_once = enter(record.y, t, solid_t, vec2(pixel) + 0.5);
      float rest = transmittance * exp(-at_once);
      color += (transmittance - rest) * soft_point(int(record.y)).color;
      transmittance = rest;
    }
  }
  out_0 = vec4(max(color, vec3(0.0)) + transmittance * solid.rgb, 1.0 - transmittance * (1.0 - solid.a));
  return true;
}
