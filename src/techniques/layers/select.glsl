// The next layer out of the lists: the nearest entry at or behind the limit. A list that was filled to its
// end and holds no such entry ended too early: its pixel asks for another visit of the points.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform usampler2D depth_lists;
layout(binding = UNIT_INPUT + 1) uniform usampler2D index_lists;
layout(binding = UNIT_INPUT + 2) uniform sampler2D limit_image;
layout(r32ui, binding = 7) writeonly uniform uimage2D revisit_flag;

bool filter_pixel(ivec2 pixel) {
  float limit = texelFetch(limit_image, pixel, 0).x;
  out_0 = vec4(infinity);
  out_1 = uvec4(0xffffffffu);
  out_2 = vec4(infinity);
  if (isinf(limit)) return true;
  int height = int(frame.image_size.y);
  bool is_full = texelFetch(depth_lists, pixel + ivec2(0, (LIST_LENGTH - 1) * height), 0).x != 0xffffffffu;
  for (int k = 0; k < LIST_LENGTH; ++k) {
    ivec2 at = pixel + ivec2(0, k * height);
    uint bits = texelFetch(depth_lists, at, 0).x;
    if (bits == 0xffffffffu) return true;  // the list is complete
    float depth = uintBitsToFloat(bits);
    if (depth >= limit) {
      out_0 = vec4(depth);
      out_1 = texelFetch(index_lists, at, 0);
      // Whenever there is another visit, full lists start anew from here: it may spare the next one.
      if (is_full && k > 0) out_2 = vec4(limit);
      return true;
    }
  }
  out_2 = vec4(limit);
  imageStore(revisit_flag, ivec2(0), uvec4(1u));
  return true;
}
