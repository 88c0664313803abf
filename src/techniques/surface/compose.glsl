// The picture's own pixels, cut out of the guard band: background where the operator says so, else the filled
// colour and depth, lit with the normal of the level that suits the depth.
//   SHADING    which one
#include "push_level.glsl"
#include "shading.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D visible;    // depth, 0, spacing, weight
layout(binding = UNIT_INPUT + 1) uniform sampler2D colors;     // and the shadow factor
layout(binding = UNIT_INPUT + 2) uniform sampler2D filled_a;  // push level 1
layout(binding = UNIT_INPUT + 3) uniform sampler2D filled_b;
layout(binding = UNIT_INPUT + 4) uniform sampler2D pyramid;
layout(binding = UNIT_INPUT + 5) uniform sampler2D mean_image;
layout(binding = UNIT_INPUT + 6) uniform sampler2D normals;   // trilinear

uniform ivec2 offset;
uniform float point_threshold;
uniform float hole_threshold;
uniform float normal_scale;
uniform vec2 normal_levels;  // first and last that exist

// Eye-space normal from level l_n(z) = log2(s_n h / (2 tan(theta) z)), s_n = normal_scale spacings (Sec. 3.3).
vec3 normal_at(vec2 uv, vec3 eye, float spacing) {
  float level = log2(normal_scale * spacing * pixels_at(-eye.z));
  vec3 normal = textureLod(normals, uv, clamp(level, normal_levels.x, normal_levels.y)).xyz;
  normal = dot(normal, normal) > 1e-12 ? normalize(normal) : vec3(0.0);
  return dot(normal, to_camera(eye)) < 0.0 ? -normal : normal;
}

bool filter_pixel(ivec2 target) {
  ivec2 pixel = target + offset;
  bool covered = texelFetch(pyramid, pixel, 0).w > 0.0;
  float mean = texelFetch(mean_image, pixel, 0).x;
  Filled seed = Filled(texelFetch(visible, pixel, 0), texelFetch(colors, pixel, 0));
  seed.b *= seed.a.w;
  Filled filled = push(seed, pixel, 0, filled_a, filled_b);

  float depth = filled.a.x;
  vec2 center = vec2(pixel) + 0.5, uv = center / vec2(textureSize(visible, 0));
  vec3 normal = mat3(frame.cloud_from_eye) * normal_at(uv, eye_from_pixel(center, depth), filled.a.z);
  vec3 albedo = palette_size > 0 ? nearest_category(filled.b.rgb) : filled.b.rgb;
  if (shading == 4) albedo = vec3(clamp(mean, 0.0, 1.0));  // the operator at work
  if (shading == 5) albedo = mean < point_threshold ? vec3(0.0, 0.6, 0.0) : vec3(0.8, 0.0, 0.0);
  vec4 color = shaded_color(vec4(albedo, 1.0), center, depth, vec4(normal, filled.b.w));

  bool is_background = filled.a.w <= 0.0 || (!covered && (mean >= hole_threshold || shading == 5));
  out_0 = is_background ? vec4(0.0) : color;
  out_1 = vec4(is_background ? infinity : depth);
  out_2 = is_background ? vec4(0.0, 0.0, 0.0, 1.0) : vec4(normal, filled.b.w);
  return true;
}
