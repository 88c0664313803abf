// What pull-push starts from: the visible points, weight 1; hidden points and background, weight 0.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D albedo_image;
layout(binding = UNIT_INPUT + 1) uniform sampler2D spacing_image;  // and the shadow factor
layout(binding = UNIT_INPUT + 2) uniform sampler2D pyramid;
layout(binding = UNIT_INPUT + 3) uniform sampler2D mean_image;

uniform float threshold;

bool filter_pixel(ivec2 pixel) {
  vec4 albedo = texelFetch(albedo_image, pixel, 0);
  float mean = texelFetch(mean_image, pixel, 0).x;
  if (albedo.a <= 0.0 || mean < threshold) {
    out_0 = vec4(0.0);
    out_1 = vec4(0.0);
    return true;
  }
  vec4 point = texelFetch(pyramid, pixel, 0);
  float shadow = texelFetch(spacing_image, pixel, 0).y;
  out_0 = vec4(-point.z, shadow, point.w, 1.0);
  out_1 = vec4(albedo.rgb, min(mean, 1.0));
  return true;
}
