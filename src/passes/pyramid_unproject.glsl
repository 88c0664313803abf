// Level 0 of the nearest-point pyramid: depth to eye position on the ray of the pixel (Bouchiba 2018, Sec. 3.1.1).
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D depth_image;
layout(binding = UNIT_INPUT + 1) uniform sampler2D spacing_image;

uniform float same_spacing;

bool filter_pixel(ivec2 pixel) {
  float depth = texelFetch(depth_image, pixel, 0).x;
  float spacing = same_spacing > 0.0 ? same_spacing : texelFetch(spacing_image, pixel, 0).x;
  out_0 = isinf(depth) ? vec4(0.0, 0.0, -3e38, 0.0) : vec4(eye_from_pixel(vec2(pixel) + 0.5, depth), spacing);
  return true;
}
