// The averages of discs as a lit picture.
//   SHADING    which one
#include "shading.glsl"
#define REMOVAL_LEVEL_INPUT 2  // of squares of squares
#include "techniques/surface/level_between.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D points;        // eye position and spacing of every pixel
layout(binding = UNIT_INPUT + 1) uniform sampler2D mean_image;    // of squares
layout(binding = UNIT_INPUT + 3) uniform sampler2D colors;        // of every pixel, and its shadow factor
layout(binding = UNIT_INPUT + 4) uniform sampler2D color_sum;
layout(binding = UNIT_INPUT + 5) uniform sampler2D normal_sum;
layout(binding = UNIT_INPUT + 6) uniform sampler2D shadow_sum;
layout(binding = UNIT_MORE_INPUTS + 2) uniform sampler2D evidence;  // of every pixel of the picture

uniform ivec2 offset;
uniform float point_threshold;
uniform bool has_shadow;
uniform bool has_evidence;
uniform float crack_scale;  // reach of the search over that of hidden point removal

const vec2 compass[8] = vec2[8](vec2(1.0, 0.0), vec2(-1.0, 0.0), vec2(0.0, 1.0), vec2(0.0, -1.0), vec2(0.7071, 0.7071),
                                vec2(-0.7071, -0.7071), vec2(0.7071, -0.7071), vec2(-0.7071, 0.7071));

#include "techniques/surface/outline.glsl"
#include "techniques/surface/through_gaps.glsl"

// A pixel between discs that sees them near by in six of eight directions is no opening: their mean. Near by on
// average, so that what is a little too wide closes from its rim and not all at once.
bool close_crack(ivec2 pixel, out vec4 sum, out vec4 normal_t) {
  float reach = max(crack_scale * exp2(texelFetch(removal_level, (pixel + offset) >> coarse_level, 0).x), 2.0);
  ivec2 last = textureSize(color_sum, 0) - 1;
  int misses = 0;
  sum = normal_t = vec4(0.0);
  float steps = 0.0;  // to the discs, of those that there are in all directions; a miss is one too many
  for (int k = 0; k < 8 && misses < 3; ++k) {
    bool found = false;
    for (int i = 1; i <= 3 && !found; ++i) {
      vec2 away = compass[k] * (reach * float(i) / 3.0);
      ivec2 at = clamp(ivec2(floor(vec2(pixel) + 0.5 + away)), ivec2(0), last);
      vec4 there = texelFetch(color_sum, at, 0);
      if (there.w > real_cover) {
        found = true;
        steps += float(i);
        sum += there / there.w;
        normal_t += texelFetch(normal_sum, at, 0) / there.w;
      }
    }
    misses += int(!found);
    steps += found ? 0.0 : 4.0;
  }
  return misses < 3 && steps < 18.0;  // three quarters of 8 directions of 3
}

bool filter_pixel(ivec2 pixel) {
  vec4 sum = texelFetch(color_sum, pixel, 0), normal_t = texelFetch(normal_sum, pixel, 0);
  float cover = sum.w;
  float spacing = spacing_px * exp2(level_at(pixel + offset));
  bool is_background = cover <= 0.0 || is_outside(pixel, spacing, cover, length(normal_t.xyz) > 1.02 * cover);
  if (is_background && cover <= real_cover) is_background = !close_crack(pixel, sum, normal_t);
  Behind behind = hidden_around(pixel, spacing, is_background);
  bool is_through = behind.support > 0.0;
  float inverse = is_background ? 0.0 : 1.0 / sum.w;
  normal_t *= inverse;
  vec2 center = vec2(pixel) + 0.5;
  vec3 slope = frame.orthographic != 0 ? vec3(0.0, 0.0, -1.0) : eye_from_pixel(center, 1.0);
  float depth = is_through ? behind.depth : normal_t.w / length(slope);
  vec3 albedo = is_through ? behind.color : sum.rgb * inverse;
  if (is_through) normal_t.xyz = vec3(behind.slope, 1.0 + dot(behind.slope, slope.xy));
  is_background = (is_background && !is_through) || (has_evidence && texelFetch(evidence, pixel, 0).x <= 0.0);
  float shadow = is_through ? behind.shadow : 1.0;
  if (has_shadow && !is_through) {
    vec2 factors = texelFetch(shadow_sum, pixel, 0).xy;
    if (factors.y > 0.0) shadow = factors.x / factors.y;
  }
  // Where points are as dense as pixels, each keeps its own colour.
  vec4 own = texelFetch(points, pixel + offset, 0);
  float share = clamp(2.0 - own.w * pixels_at(depth), 0.0, 1.0);
  if (own.w > 0.0 && share > 0.0 && abs(depth + own.z) < 2.0 * own.w) {
    vec3 color = texelFetch(colors, pixel + offset, 0).rgb;
    albedo = mix(albedo, color, share);
  }
  if (palette_size > 0) albedo = nearest_category(albedo);
  float mean = texelFetch(mean_image, (pixel + offset) / 2, 0).x;
  if (shading == 4) albedo = vec3(clamp(mean, 0.0, 1.0));
  if (shading == 5) {
    albedo = mean < point_threshold ? vec3(0.0, 0.6, 0.0) : vec3(0.8, 0.0, 0.0);
    is_background = own.w <= 0.0;
  }
  float size = length(normal_t.xyz);
  vec3 normal = mat3(frame.cloud_from_eye) * (size > 1e-3 ? normal_t.xyz / size : vec3(0.0));
  vec4 color = shaded_color(vec4(albedo, 1.0), center, depth, vec4(normal, shadow));
  out_0 = is_background ? vec4(0.0) : color;
  out_1 = vec4(is_background ? infinity : depth);
  out_2 = is_background ? vec4(0.0, 0.0, 0.0, 1.0) : vec4(normal, shadow);
  return true;
}
