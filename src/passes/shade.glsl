// Deferred shading: albedo, depth and normal of a pixel to its colour.
#include "shading.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D albedo_image;
layout(binding = UNIT_INPUT + 1) uniform sampler2D depth_image;
layout(binding = UNIT_INPUT + 2) uniform sampler2D normal_image;

bool filter_pixel(ivec2 pixel) {
  vec4 albedo = texelFetch(albedo_image, pixel, 0);
  if (palette_size > 0 && albedo.a > 0.0) albedo.rgb = nearest_category(albedo.rgb / albedo.a) * albedo.a;
  out_0 = shaded_color(albedo, vec2(pixel) + 0.5, texelFetch(depth_image, pixel, 0).x,
                       texelFetch(normal_image, pixel, 0));
  return true;
}
