// Eye-dome lighting (Boucheny 2009): each pixel is darkened by how far it lies behind its eight neighbours on a
// circle, in log2 of depth, so that the look does not depend on the scene's scale.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D color_image;
layout(binding = UNIT_INPUT + 1) uniform sampler2D depth_image;

uniform float radius_px;
uniform float strength;
uniform float orthographic_distance;

float log_depth(float depth) {
  return frame.orthographic != 0 ? (depth / orthographic_distance) / log(2.0) : log2(depth);
}

bool filter_pixel(ivec2 pixel) {
  out_0 = texelFetch(color_image, pixel, 0);
  float depth = texelFetch(depth_image, pixel, 0).x;
  if (isinf(depth) || out_0.a <= 0.0) return true;
  float here = log_depth(depth);
  ivec2 last = textureSize(depth_image, 0) - 1;
  float response = 0.0;
  for (int k = 0; k < 8; ++k) {
    float angle = float(k) * 0.785398163;
    ivec2 at = clamp(ivec2(floor(vec2(pixel) + 0.5 + radius_px * vec2(cos(angle), sin(angle)))), ivec2(0), last);
    float neighbor = texelFetch(depth_image, at, 0).x;
    if (!isinf(neighbor)) response += max(0.0, here - log_depth(neighbor));
  }
  // 300 is Potree's constant. The shade was meant for encoded colour; 2.2 keeps that look in linear light.
  float shade = exp(-response / 8.0 * 300.0 * strength * 2.2);
  out_0.rgb *= shade;
  return true;
}
