// 3 x 3 Gaussian over the pixels of the same layer (Dobrev 2010, Sec. 3): neighbours without a sample or
// farther than it is thick in depth do not count, nor do those of another category.
//   CATEGORIES   colours stand for categories; light.glsl wrote which
#include "bindings.glsl"
#include "techniques/layers/gaussian.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D color_image;
layout(binding = UNIT_INPUT + 1) uniform sampler2D depth_image;
layout(binding = UNIT_INPUT + 2) uniform sampler2D shape_image;  // light.glsl

bool filter_pixel(ivec2 pixel) {
  float depth = texelFetch(depth_image, pixel, 0).x;
  ivec2 size = textureSize(depth_image, 0);
  vec4 sum = vec4(0.0);
  float weights = 0.0;
  vec4 shape = texelFetch(shape_image, pixel, 0);
  int taps = isinf(depth) ? 0 : 9;
  for (int tap = 0; tap < taps; ++tap) {
    ivec2 at = clamp(pixel + gaussian_offset(tap), ivec2(0), size - 1);  // nobody sees the border (ScreenExtent)
    float weight = abs(texelFetch(depth_image, at, 0).x - depth) <= shape.y ? gaussian_weight(tap) : 0.0;
#ifdef CATEGORIES
    if (texelFetch(shape_image, at, 0).z != shape.z) weight = 0.0;
#endif
    sum += weight * texelFetch(color_image, at, 0);
    weights += weight;
  }
  out_0 = weights > 0.0 ? sum / weights : vec4(0.0);
  return true;
}
