// Sums to attributes (Eq. 1): divided by the sum of weights; lighting follows in the shading pass.
#include "techniques/denoise/bins.glsl"
#include "color.glsl"

layout(binding = UNIT_INPUT + 1) uniform sampler2D choice;
uniform int sum_stride;
#ifdef FAST
layout(binding = UNIT_INPUT + 2) uniform samplerBuffer sums;
float sum_at(int at) { return texelFetch(sums, at).x; }
#else
layout(binding = UNIT_INPUT + 2) uniform usamplerBuffer sums;
float sum_at(int at) { return float(int(texelFetch(sums, at).x)); }
#endif
uniform bool show_weight;

bool filter_pixel(ivec2 pixel) {
  vec4 chosen = texelFetch(choice, pixel, 0);
  out_0 = vec4(0.0);
  out_1 = vec4(infinity);
  out_2 = vec4(0.0, 0.0, 0.0, 1.0);
  if (chosen.x < 0.0) return true;
  int at = (pixel.y * image_width + pixel.x) * sum_stride;
  vec4 color = vec4(sum_at(at + 1), sum_at(at + 2), sum_at(at + 3), sum_at(at));
  vec4 normal = vec4(sum_at(at + 4), sum_at(at + 5), sum_at(at + 6), sum_at(at + 7));
  if (!(color.a > 0.0)) return true;
  vec3 slope = frame.orthographic != 0 ? vec3(0.0, 0.0, -1.0) : eye_from_pixel(vec2(pixel) + 0.5, 1.0);
  normal /= color.a;
  vec3 n = transpose(mat3(frame.eye_from_cloud)) * normal.xyz;
  float size = length(n);
  out_0 = vec4(max(color.rgb / color.a, 0.0), 1.0);
  // Even for the eye, black at 0 and nearly white at a weight of 4.
  if (show_weight) out_0.rgb = linear_from_srgb(vec3(1.0 - exp(-chosen.y)));
  float t = bin_origin(pixel) + (bin_start(uint(chosen.x)) + normal.w) * bin_size;
  out_1 = vec4(t / length(slope));  // ray distance to eye depth
  out_2 = vec4(size > 1e-3 ? n / size : vec3(0.0), 1.0);
#ifdef SPLAT_SHADOW
  out_2.w = sum_at(at + 8) / color.a;
#endif
  return true;
}
