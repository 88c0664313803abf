// Ends a layer where something opaque lies in front of it.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D depth_image;
layout(binding = UNIT_INPUT + 1) uniform sampler2D behind_image;  // opaque

bool filter_pixel(ivec2 pixel) {
  float depth = texelFetch(depth_image, pixel, 0).x, behind = texelFetch(behind_image, pixel, 0).x;
  out_0 = vec4(depth < behind ? depth : infinity);
  out_1 = vec4(min(depth, behind));
  return true;
}
