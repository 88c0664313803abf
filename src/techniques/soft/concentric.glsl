// Concentric model: nested spheres of constant density; the densities of all open ones add up (Seemann 2018, Sec. 3.2;
// the sum is what the text says, Eq. 17 shows the inner one only).
#define SOFT_READ
#include "techniques/soft/shells.glsl"
#include "techniques/soft/interior_sort.glsl"

layout(binding = UNIT_INPUT + 2) uniform sampler2D solid_color;

uniform int shell_bits;

bool filter_pixel(ivec2 pixel) {
  vec4 solid = texelFetch(solid_color, pixel, 0);
  int count = sort_records(pixel), open_count = 0;
  vec4 weighted = vec4(0.0), plain = vec4(0.0);  // sums over the open points of w (color, 1), w = 1 - d/r or 1
  vec3 color = vec3(0.0);
  float transmittance = 1.0, density = 0.0, last_t = 0.0;
  for (int k = 0; k < count && transmittance > 1e-5; ++k) {
    uvec2 record = sorted_record(k);
    float t = uintBitsToFloat(record.x >> 1), side = (record.x & 1u) != 0u ? -1.0 : 1.0;
    if (open_count > 0) {
      vec3 mean = weighted.a > 1e-6 ? weighted.rgb / weighted.a : plain.rgb / plain.a;
      float rest = transmittance * exp(-max(density, 0.0) * (t - last_t));  // Eq. 14
      color += (transmittance - rest) * mean;
      transmittance = rest;
    }
    last_t = t;
    int shell = int(record.y & ((1u << shell_bits) - 1u));
    SoftPoint point = soft_point(int(record.y >> shell_bits));
    float delta = soft_ray(point.center, point.radius, vec2(pixel) + 0.5).delta;
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
      vec4 seen = side * vec4(point.color, 1.0);
      weighted += max(1.0 - delta, 0.0) * seen;
      plain += seen;
      open_count += int(side);
    }
    if (open_count == 0) {  // leave no rounding behind
      weighted = plain = vec4(0.0);
      density = 0.0;
    }
  }
  out_0 = vec4(max(color, vec3(0.0)) + transmittance * solid.rgb, 1.0 - transmittance * (1.0 - solid.a));
  return true;
}
