// The picture's own pixels, cut out of the guard band: background where the operator says so, else the filled
// colour and depth, and the normal of the level that suits the depth.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D filled_a;
layout(binding = UNIT_INPUT + 1) uniform sampler2D filled_b;
layout(binding = UNIT_INPUT + 2) uniform sampler2D pyramid;
layout(binding = UNIT_INPUT + 3) uniform sampler2D mean_image;
layout(binding = UNIT_INPUT + 4) uniform sampler2D normals;  // trilinear
layout(binding = UNIT_INPUT + 5) uniform sampler2D coarse_b;  // a coarse push level, linear

uniform ivec2 offset;
uniform float point_threshold;
uniform float hole_threshold;
uniform float normal_scale;
uniform vec2 normal_levels;  // first and last that exist
uniform float ambient_occlusion;
uniform int shading;         // 4 occlusion, 5 hidden: the operator at work

bool filter_pixel(ivec2 target) {
  ivec2 pixel = target + offset;
  vec4 a = texelFetch(filled_a, pixel, 0), b = texelFetch(filled_b, pixel, 0);
  bool covered = texelFetch(pyramid, pixel, 0).w > 0.0;
  float mean = texelFetch(mean_image, pixel, 0).x;
  out_0 = vec4(0.0);
  out_1 = vec4(infinity);
  out_2 = vec4(0.0, 0.0, 0.0, 1.0);
  if (shading == 5 && !covered) return true;
  if ((!covered && mean >= hole_threshold) || a.w <= 0.0) return true;

  // l_n(z) = log2(s_n h / (2 tan(theta) z)), s_n = normal_scale times the point spacing there.
  float level = log2(normal_scale * a.z * pixels_at(a.x));
  vec2 uv = (vec2(pixel) + 0.5) / vec2(textureSize(normals, 0));
  vec3 normal = textureLod(normals, uv, clamp(level, normal_levels.x, normal_levels.y)).xyz;
  normal = dot(normal, normal) > 1e-12 ? normalize(normal) : vec3(0.0);
  if (dot(normal, to_camera(eye_from_pixel(vec2(pixel) + 0.5, a.x))) < 0.0) normal = -normal;

  // Occlusion of single points is noise; what a crevice looks like is in a coarser level.
  vec3 color = b.rgb * mix(1.0, textureLod(coarse_b, uv, 0.0).w, ambient_occlusion);
  if (shading == 4) color = vec3(clamp(mean, 0.0, 1.0));
  if (shading == 5) color = mean < point_threshold ? vec3(0.0, 0.6, 0.0) : vec3(0.8, 0.0, 0.0);
  out_0 = vec4(color, 1.0);
  out_1 = vec4(a.x);
  out_2 = vec4(mat3(frame.cloud_from_eye) * normal, a.y);
  return true;
}
