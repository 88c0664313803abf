// Of two pictures the nearer surface of each pixel, over the other one where its edge covers only a part.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D color_image;
layout(binding = UNIT_INPUT + 1) uniform sampler2D depth_image;
layout(binding = UNIT_INPUT + 2) uniform sampler2D other_color_image;
layout(binding = UNIT_INPUT + 3) uniform sampler2D other_depth_image;
#ifdef WITH_NORMALS
layout(binding = UNIT_INPUT + 4) uniform sampler2D normal_image;
layout(binding = UNIT_INPUT + 5) uniform sampler2D other_normal_image;
#endif

bool filter_pixel(ivec2 pixel) {
  float depth = texelFetch(depth_image, pixel, 0).x, other_depth = texelFetch(other_depth_image, pixel, 0).x;
  vec4 color = texelFetch(color_image, pixel, 0), other_color = texelFetch(other_color_image, pixel, 0);
  // At one depth the first item wins, whatever the order of the points.
  bool is_other = other_depth < depth;
  vec4 near = is_other ? other_color : color, far = is_other ? color : other_color;
  out_0 = near + (1.0 - min(near.a, 1.0)) * far;
  out_1 = vec4(min(depth, other_depth));
#ifdef WITH_NORMALS
  out_2 = is_other ? texelFetch(other_normal_image, pixel, 0) : texelFetch(normal_image, pixel, 0);
#endif
  return true;
}
