// Base and Concentric models: counts or stores where the ray enters and leaves each sphere. Spheres that the near
// plane or a solid surface cuts are clamped, so that each entry has its exit.
//   STORE   stores; else counts
#include "techniques/soft/sphere_fragment.glsl"
#include "techniques/soft/shells.glsl"
#ifdef STORE
#include "fragment_list.glsl"
uniform int shell_bits;  // of the second word
#endif

layout(location = 0) out vec4 fragment_count;

#ifdef STORE
// Sorts by t, then entries before exits, then by point: t is positive, so its sign bit is free.
uvec2 record(float t, bool leaves, int shell) {
  return uvec2(floatBitsToUint(t) << 1 | uint(leaves), uint(soft_slot) << shell_bits | uint(shell));
}
#endif

void main() {
  SoftRay ray = soft_ray(soft_shape.xyz, soft_shape.w, gl_FragCoord.xy);
  if (!(ray.delta < 1.0)) discard;
  float from = near_t(gl_FragCoord.xy), to = solid_t(), first, last;
#ifdef MODEL_CONCENTRIC
  Shells shells = shells_of(soft_shells);
#else
  Shells shells = Shells(1, 1.0, 0.0, 0.0);
#endif
  int inside = 0;  // shells that the ray meets: an outer one whenever an inner one
  for (; inside < shells.number; ++inside) {
    float radius = drawn_radius(shells, inside, soft_share.x);
    if (radius <= ray.delta ||
        !soft_chord(ray, soft_shape.w, chord_through(radius, ray.delta), from, to, first, last))
      break;
  }
  if (inside == 0) discard;
#ifdef STORE
  int place = reserve_fragments(ivec2(gl_FragCoord.xy), uint(2 * inside));
  for (int i = 0; i < inside; ++i) {
    float half_length = chord_through(drawn_radius(shells, i, soft_share.x), ray.delta);
    soft_chord(ray, soft_shape.w, half_length, from, to, first, last);
    store_fragment(place + 2 * i, record(first, false, i));
    store_fragment(place + 2 * i + 1, record(last, true, i));
  }
#endif
  fragment_count = vec4(2 * inside);
}
