// From a premultiplied linear colour to the picture: the background under it, then straight 8-bit sRGB.
#include "color.glsl"

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
