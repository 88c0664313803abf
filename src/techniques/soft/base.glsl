// Base model: between two neighbouring places where the ray enters or leaves a sphere, the densities of all open
// spheres are integrated exactly and add up; the colour is the mean of the open spheres (Seemann 2018, Sec. 3.1).
#define SOFT_READ
#include "techniques/soft/sphere.glsl"

const int most_open = 64;
const int most_kept = 7 + most_open / 2;  // records
#include "techniques/soft/interior_list.glsl"

layout(binding = UNIT_INPUT + 3) uniform sampler2D solid_t_image;  // ray distance of the first solid hit, or infinity

struct Open {
  uint slot;
  float middle, radius, delta;
  float depth;   // optical depth of the whole chord over radial_depth
  float before;  // integral up to last_t
};
Open open_spheres[most_open];

float weight_of(Open sphere) { return max(1.0 - sphere.delta, 0.0); }

float integral(Open sphere, float t) {
  float s = (t - sphere.middle) / sphere.radius, half_length = half_chord(sphere.delta);
  s = clamp(s, -half_length, half_length);
#ifdef DENSITY_UNIFORM
  return 0.5 * s;
#else
  return radial_integral(s, sphere.delta);
#endif
}

Open opened(uint slot, SoftPoint point) {
  SoftRay ray = soft_ray(point.center, point.radius, ray_pixel);
  float whole = radial_depth(ray.delta);
  float depth = modulated_depth(point.cone, point.share, ray.delta, lambda_of(point.opacity) * whole);
  Open sphere = Open(slot, ray.middle, point.radius, ray.delta, whole > 1e-9 ? depth / whole : 0.0, 0.0);
  sphere.before = integral(sphere, last_t);
  return sphere;
}

// Where no more spheres fit, the optical depth up to the solid surface is applied at once.
void enter(uint slot) {
  SoftPoint point = soft_point(int(slot));
  Open sphere = opened(slot, point);
  if (open_count == most_open) {
    atomicAdd(overflow_count, 1u);
    float solid_t = texelFetch(solid_t_image, ivec2(ray_pixel), 0).x;
    pass_through(sphere.depth * (integral(sphere, solid_t) - sphere.before), point.color);
    return;
  }
  count_in(vec4(point.color, 1.0), weight_of(sphere), 1.0);
  open_spheres[open_count++] = sphere;
}

void leave(int k) {
  count_in(vec4(soft_point(int(open_spheres[k].slot)).color, 1.0), weight_of(open_spheres[k]), -1.0);
  open_spheres[k] = open_spheres[--open_count];
  if (open_count == 0) weighted = plain = vec4(0.0);  // leave no rounding behind
}

void visit(uvec2 record) {
  float depth = 0.0;
  int leaving = -1;
  last_t = uintBitsToFloat(record.x >> 1);
  for (int j = 0; j < open_count; ++j) {
    float now = integral(open_spheres[j], last_t);
    depth += open_spheres[j].depth * max(now - open_spheres[j].before, 0.0);
    open_spheres[j].before = now;
    if (open_spheres[j].slot == record.y) leaving = j;
  }
  if (open_count > 0) pass_through(depth, mean_color());
  if ((record.x & 1u) == 0u)
    enter(record.y);
  else if (leaving >= 0)
    leave(leaving);
}

#ifdef LONG_LISTS
void keep_points() {
  for (int k = 0; k < open_count; k += 2)
    keep(uvec2(open_spheres[k].slot, k + 1 < open_count ? open_spheres[k + 1].slot : 0u));
}
void resume_points() {
  uvec2 slots;
  for (int k = 0; k < open_count; ++k) {
    if (k % 2 == 0) slots = kept_words();
    uint slot = k % 2 == 0 ? slots.x : slots.y;
    open_spheres[k] = opened(slot, soft_point(int(slot)));
  }
}
#endif
