// A soft point as a sphere and the densities inside it. Everything is unit-free: lengths are divided by the radius,
// so that delta = d/r is 0 on a ray through the centre and 1 on a tangent, and Lambda = -ln(1 - opacity) is the optical
// depth of a lone sphere through its centre, whatever the model.
#include "splat.glsl"

struct SoftPoint {
  vec3 center;    // eye
  float radius;   // 0: not in this view
  vec3 color;     // lit, linear
  float opacity;  // of a lone sphere through its centre
  float share;    // W of Eq. 22: 0 at the field threshold, 1 at the modulation threshold and beyond
  float cone;     // opacity through the centre at the field threshold, where share is 0
  float shells;   // N of the Concentric model, a real number
};

#ifdef SOFT_READ
layout(binding = UNIT_INPUT) uniform samplerBuffer soft_shapes;
layout(binding = UNIT_INPUT + 1) uniform usamplerBuffer soft_looks;

SoftPoint soft_point(int slot) {
  vec4 shape = texelFetch(soft_shapes, slot);
  uvec4 look = texelFetch(soft_looks, slot);
  vec2 rg = unpackHalf2x16(look.x), b_share = unpackHalf2x16(look.y);
  return SoftPoint(shape.xyz, shape.w, vec3(rg, b_share.x), uintBitsToFloat(look.z), b_share.y,
                   float(look.w >> 16u) / 65535.0, unpackHalf2x16(look.w).x);
}
#endif

struct SoftRay {
  float middle;  // t of the place nearest to the centre; t is the Euclidean distance along the ray, not eye depth:
                 // the integrals are wrong by 1/cos otherwise
  float delta;   // distance of the ray from the centre, in radii
};

// Measured from the centre, where float is exact.
SoftRay soft_ray(vec3 center, float radius, vec2 pixel) {
  vec3 slope = ray_slope(pixel);
  precise float size = length(slope);
  vec3 direction = slope / size;
  precise vec3 across = vec3(eye_from_pixel(pixel, -center.z).xy - center.xy, 0.0);
  precise float beyond = -dot(across, direction);
  precise float middle = -center.z * size + beyond;
  precise float delta = length(across + beyond * direction) / radius;
  return SoftRay(middle, delta);
}

// The part [first, last] of the chord between the near plane and the solid surface; false when nothing is left.
bool soft_chord(SoftRay ray, float radius, float half_chord, float near_t, float solid_t, out float first,
                out float last) {
  precise float one = max(ray.middle - half_chord * radius, near_t);
  precise float two = min(ray.middle + half_chord * radius, solid_t);
  first = one;
  last = two;
  return two > one;
}

float near_t(vec2 pixel) { return splat_near() * length(ray_slope(pixel)); }

float half_chord(float delta) { return sqrt(max(1.0 - delta * delta, 0.0)); }

// Antiderivative of the density 1 - sqrt(s^2 + delta^2) (Seemann 2018, Eqs. 5 and 7), as an odd function: its
// difference is the integral over any part of the chord, which replaces the cases of Eqs. 4 and 8 to 10.
float radial_integral(float s, float delta) {
  float away = sqrt(s * s + delta * delta), size = abs(s);
  float log_term = delta < 1e-6 ? 0.0 : delta * delta * log((size + away) / delta);
  return 0.5 * (2.0 * s - s * away - sign(s) * log_term);
}

// Optical depth of the whole chord, 1 through the centre.
float radial_depth(float delta) {
#ifdef DENSITY_UNIFORM
  return half_chord(delta);  // Eq. 3
#else
  return 2.0 * radial_integral(half_chord(delta), delta);
#endif
}

float lambda_of(float opacity) { return -log(1.0 - min(opacity, 0.999)); }

// Eq. 22: between the thresholds the opacity goes over from a cone to the model's own.
float modulated(float cone, float share, float delta, float model_opacity) {
  return clamp(mix(cone * (1.0 - delta), model_opacity, share), 0.0, 1.0);
}
// The same for optical depths.
float modulated_depth(float cone, float share, float delta, float depth) {
  if (share >= 1.0) return depth;
  return -log(1.0 - min(modulated(cone, share, delta, 1.0 - exp(-depth)), 0.9999));
}
