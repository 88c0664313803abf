// Empties the lists of the pixels that are visited again.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D revisit_image;

bool filter_pixel(ivec2 entry) {
  out_0 = uvec4(0xffffffffu);
  out_1 = uvec4(0xffffffffu);
  return !isinf(texelFetch(revisit_image, ivec2(entry.x, entry.y % int(frame.image_size.y)), 0).x);
}
