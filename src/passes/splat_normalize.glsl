// Sums to attributes: divided by the sum of weights (Botsch 2005, pass 3; lighting follows in the shading pass).
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D color_sum;
layout(binding = UNIT_INPUT + 1) uniform sampler2D normal_sum;
layout(binding = UNIT_INPUT + 2) uniform sampler2D shadow_sum;

uniform bool has_shadow;

bool filter_pixel(ivec2 pixel) {
  vec4 color = texelFetch(color_sum, pixel, 0);
  if (!(color.a > 0.0)) {
    out_0 = vec4(0.0);
    out_1 = vec4(infinity);
    out_2 = vec4(0.0, 0.0, 0.0, 1.0);
    return true;
  }
  vec4 normal = texelFetch(normal_sum, pixel, 0) / color.a;
  vec3 slope = frame.orthographic != 0 ? vec3(0.0, 0.0, -1.0) : eye_from_pixel(vec2(pixel) + 0.5, 1.0);
  // On an outline, half of it beyond: then it is seen from the side.
  normal.xyz -= max(dot(normal.xyz, slope), 0.0) / dot(slope, slope) * slope;
  vec3 n = transpose(mat3(frame.eye_from_cloud)) * normal.xyz;
  float size = length(n);
  out_0 = vec4(color.rgb / color.a, 1.0);
  out_1 = vec4(normal.w / length(slope));  // ray distance to eye depth
  out_2 = vec4(size > 1e-3 ? n / size : vec3(0.0), has_shadow ? texelFetch(shadow_sum, pixel, 0).x / color.a : 1.0);
  return true;
}
