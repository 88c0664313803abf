// The shadow factor of the ground plane seen by each pixel; one light sample is added to the sum so far.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D light_map;
layout(binding = UNIT_INPUT + 1) uniform sampler2D sum_so_far;

uniform vec4 plane_eye;          // dot(n, p) + d = 0
uniform mat4 light_from_eye;     // this view's eye space to the light's
uniform vec4 light_intrinsics;
uniform bool light_orthographic;
uniform float d_min;
uniform float share;

bool filter_pixel(ivec2 pixel) {
  float sum = texelFetch(sum_so_far, pixel, 0).x;
  vec3 origin = ray_origin(vec2(pixel) + 0.5), direction = ray_direction(vec2(pixel) + 0.5);
  float t = -(dot(plane_eye.xyz, origin) + plane_eye.w) / dot(plane_eye.xyz, direction);
  vec3 at = (light_from_eye * vec4(origin + t * direction, 1.0)).xyz;
  float depth = -at.z;
  vec2 texel = vec2(light_intrinsics.x * at.x, -light_intrinsics.y * at.y) / (light_orthographic ? 1.0 : depth) +
               light_intrinsics.zw;
  ivec2 size = textureSize(light_map, 0);
  bool is_seen = t > 0.0 && (light_orthographic || depth > 0.0) && all(greaterThanEqual(texel, vec2(0.0))) &&
                 all(lessThan(texel, vec2(size)));
  float lit = 1.0;  // beyond the light map nothing casts a shadow
  if (is_seen) {
    // Four texels, weighted: the outline on a smooth plane would show every texel.
    vec2 corner = floor(texel - 0.5), f = texel - 0.5 - corner;
    lit = 0.0;
    for (int k = 0; k < 4; ++k) {
      ivec2 offset = ivec2(k & 1, k >> 1);
      float map = texelFetch(light_map, clamp(ivec2(corner) + offset, ivec2(0), size - 1), 0).x;
      float weight = (offset.x == 1 ? f.x : 1.0 - f.x) * (offset.y == 1 ? f.y : 1.0 - f.y);
      lit += depth < map + d_min ? weight : 0.0;
    }
  }
  out_0 = vec4(sum + share * lit);
  return true;
}
