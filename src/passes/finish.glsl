// Background under the premultiplied linear colour, then (ENCODE_SRGB) straight 8-bit sRGB.
#include "bindings.glsl"
#include "finished.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D color_image;

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
