// Background under the premultiplied linear colour, then (ENCODE_SRGB) straight 8-bit sRGB.
#include "bindings.glsl"
#include "color.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D color_image;

uniform vec3 background_srgb;
uniform bool is_transparent;

bool filter_pixel(ivec2 pixel) {
  vec4 color = texelFetch(color_image, pixel, 0);
#ifdef ENCODE_SRGB
  if (color.a <= 0.0) {  // most of many pictures: spare the powers
    out_0 = is_transparent ? vec4(0.0) : vec4(background_srgb, 1.0);
    return true;
  }
#endif
  color.a = clamp(color.a, 0.0, 1.0);
  if (!is_transparent) color = vec4(color.rgb + (1.0 - color.a) * linear_from_srgb(background_srgb), 1.0);
#ifdef ENCODE_SRGB
  vec3 straight = color.a > 0.0 ? color.rgb / color.a : vec3(0.0);
  color = vec4(srgb_from_linear(straight), color.a);
#endif
  out_0 = color;
  return true;
}
