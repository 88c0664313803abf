// Ray distances, cut at an eye depth.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D distance_image;
layout(binding = UNIT_INPUT + 1) uniform sampler2D depth_image;

bool filter_pixel(ivec2 pixel) {
  float depth = texelFetch(depth_image, pixel, 0).x;
  float along = frame.orthographic != 0 ? 1.0 : length(eye_from_pixel(vec2(pixel) + 0.5, 1.0));
  out_0 = vec4(min(texelFetch(distance_image, pixel, 0).x, depth * along));
  return true;
}
