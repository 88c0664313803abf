// Deferred shading: albedo, depth and normal of a pixel to its colour.
#include "shading.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D albedo_image;
layout(binding = UNIT_INPUT + 1) uniform sampler2D depth_image;
layout(binding = UNIT_INPUT + 2) uniform sampler2D normal_image;

bool filter_pixel(ivec2 pixel) {
  out_0 = shaded_color(texelFetch(albedo_image, pixel, 0), vec2(pixel) + 0.5, texelFetch(depth_image, pixel, 0).x,
                       texelFetch(normal_image, pixel, 0));
  return true;
}
