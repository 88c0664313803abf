// The shadow factor of the ground plane seen by each pixel; one light sample is added to the sum so far.
//   LAYER    the map is one layer of see-through casters: what they let pass is multiplied into `passed`
//   PASSED   the ground gets what see-through casters let pass
#include "frame.glsl"
#include "light_map.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D light_map;
#ifdef LAYER
layout(binding = UNIT_INPUT + 1) uniform sampler2D opacity_map;
#else
layout(binding = UNIT_INPUT + 1) uniform sampler2D sum_so_far;
uniform float share;
uniform float elsewhere;         // light of what is not in the map: nothing casts there, or another face sees it
#endif
#if defined(LAYER) || defined(PASSED)
layout(binding = UNIT_INPUT + 2) uniform sampler2D passed;
#endif

uniform vec4 plane_eye;          // dot(n, p) + d = 0
uniform mat4 light_from_eye;     // this view's eye space to the light's
uniform vec4 light_intrinsics;
uniform bool light_orthographic;
uniform float d_min;

bool filter_pixel(ivec2 pixel) {
  vec3 origin = ray_origin(vec2(pixel) + 0.5), direction = ray_direction(vec2(pixel) + 0.5);
  float t = -(dot(plane_eye.xyz, origin) + plane_eye.w) / dot(plane_eye.xyz, direction);
  vec3 at = (light_from_eye * vec4(origin + t * direction, 1.0)).xyz;
  float depth = -at.z;
  vec2 texel = vec2(light_intrinsics.x * at.x, -light_intrinsics.y * at.y) / (light_orthographic ? 1.0 : depth) +
               light_intrinsics.zw;
  ivec2 size = textureSize(light_map, 0);
  bool is_seen = t > 0.0 && (light_orthographic || depth > 0.0) &&
                 is_in_map(at, light_orthographic ? 1.0 : depth, light_intrinsics, vec2(size));
#ifdef LAYER
  float lit = 1.0;
#else
  float lit = elsewhere;
#endif
  if (is_seen) {
    // Four texels, weighted: the outline on a smooth plane would show every texel.
    vec2 corner = floor(texel - 0.5), f = texel - 0.5 - corner;
    lit = 0.0;
    for (int k = 0; k < 4; ++k) {
      ivec2 offset = ivec2(k & 1, k >> 1);
      ivec2 at = clamp(ivec2(corner) + offset, ivec2(0), size - 1);
      float map = texelFetch(light_map, at, 0).x;
#ifdef LAYER
      float shaded = 1.0 - texelFetch(opacity_map, at, 0).x;
#else
      const float shaded = 0.0;
#endif
      float weight = (offset.x == 1 ? f.x : 1.0 - f.x) * (offset.y == 1 ? f.y : 1.0 - f.y);
      lit += weight * (depth < map + d_min ? 1.0 : shaded);
    }
  }
#ifdef LAYER
  out_0 = texelFetch(passed, pixel, 0) * lit;
#else
#ifdef PASSED
  lit *= texelFetch(passed, pixel, 0).x;
#endif
  out_0 = texelFetch(sum_so_far, pixel, 0) + share * lit;
#endif
  return true;
}
