// Concentric model: nested spheres of constant density; the densities of all open ones add up (Seemann 2018, Sec. 3.2;
// the sum is what the text says, Eq. 17 shows the inner one only).
#define SOFT_READ
#include "techniques/soft/shells.glsl"

const int most_kept = 8;  // records
#include "techniques/soft/interior_list.glsl"

uniform int shell_bits;

float density = 0.0;

void visit(uvec2 record) {
  float t = uintBitsToFloat(record.x >> 1), side = (record.x & 1u) != 0u ? -1.0 : 1.0;
  if (open_count > 0) pass_through(max(density, 0.0) * (t - last_t), mean_color());
  last_t = t;
  int shell = int(record.y & ((1u << shell_bits) - 1u));
  SoftPoint point = soft_point(int(record.y >> shell_bits));
  float delta = soft_ray(point.center, point.radius, ray_pixel).delta;
  float lambda = lambda_of(point.opacity);
  Shells shells = shells_of(point.shells);
  if (point.share < 1.0) {
    float depth = shells_depth(shells, delta);
    float outer = half_chord(delta) - chord_through(shells.first, delta);  // by which the outermost grew
    float drawn = depth + 2.0 * outer * shell_density(shells, 0, delta);
    lambda = drawn > 1e-9 ? modulated_depth(point.cone, point.share, delta, lambda * depth) / drawn : 0.0;
  }
  density += side * lambda * shell_density(shells, shell, delta) / point.radius;
  if (shell == 0) {
    count_in(vec4(point.color, 1.0), max(1.0 - delta, 0.0), side);
    open_count += int(side);
  }
  if (open_count == 0) {  // leave no rounding behind
    weighted = plain = vec4(0.0);
    density = 0.0;
  }
}

#ifdef LONG_LISTS
void keep_points() { keep(vec2(density, 0.0)); }
void resume_points() { density = kept().x; }
#endif
