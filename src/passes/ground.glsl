// The shadow on the ground plane: darkness under the cloud's own colour. Haze has no depth: where no surface is seen,
// whatever colour there is stands before the plane, as all but the lowest points do.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D color_image;
layout(binding = UNIT_INPUT + 1) uniform sampler2D depth_image;
layout(binding = UNIT_INPUT + 2) uniform sampler2D factor_image;

uniform vec4 plane_eye;

const float darkness = 0.75;  // of a full shadow: paper is never black

bool filter_pixel(ivec2 pixel) {
  vec4 color = texelFetch(color_image, pixel, 0);
  vec3 origin = ray_origin(vec2(pixel) + 0.5), direction = ray_direction(vec2(pixel) + 0.5);
  float facing = dot(plane_eye.xyz, direction);
  float t = -(dot(plane_eye.xyz, origin) + plane_eye.w) / facing;
  out_0 = color;
  if (facing >= 0.0 || t <= 0.0) return true;  // from below, or above the horizon
  float plane_depth = -(origin + t * direction).z;
  float shadow = darkness * (1.0 - texelFetch(factor_image, pixel, 0).x);
  float depth = texelFetch(depth_image, pixel, 0).x;
  if (plane_depth < depth && !isinf(depth)) out_0 = vec4(color.rgb * (1.0 - shadow), color.a + (1.0 - color.a) * shadow);
  else out_0 = vec4(color.rgb, color.a + (1.0 - color.a) * shadow);
  return true;
}
