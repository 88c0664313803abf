// Background under the premultiplied linear colour, then (ENCODE_SRGB) straight 8-bit sRGB.
#include "bindings.glsl"
#include "color.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D color_image;

uniform vec3 background_srgb;
uniform bool is_transparent;

vec4 over_background(vec4 color) {
  color.a = clamp(color.a, 0.0, 1.0);
  if (is_transparent) return color;
  return vec4(color.rgb + (1.0 - color.a) * linear_from_srgb(background_srgb), 1.0);
}

vec4 finished_background() { return is_transparent ? vec4(0.0) : vec4(background_srgb, 1.0); }

vec4 finished_color(vec4 color) {
  color = over_background(color);
  vec3 straight = color.a > 0.0 ? color.rgb / color.a : vec3(0.0);
  return vec4(srgb_from_linear(straight), color.a);
}

bool filter_pixel(ivec2 pixel) {
  vec4 color = texelFetch(color_image, pixel, 0);
#ifdef ENCODE_SRGB
  // Most of many pictures is background: spare the powers.
  if (color.a <= 0.0) out_0 = finished_background();
  else out_0 = finished_color(color);
#else
  out_0 = over_background(color);
#endif
  return true;
}
