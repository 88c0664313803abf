// Records of two words for every pixel (src/passes/fragment_list.h).
#include "bindings.glsl"

layout(binding = UNIT_FRAGMENT_OFFSETS) uniform usamplerBuffer fragment_offsets;
layout(r32ui, binding = IMAGE_FRAGMENT_CURSOR) uniform uimage2D fragment_cursor;
layout(rg32ui, binding = IMAGE_FRAGMENTS) uniform uimageBuffer fragment_image;

int first_fragment(ivec2 pixel) {
  return int(texelFetch(fragment_offsets, pixel.y * imageSize(fragment_cursor).x + pixel.x).x);
}

// Reserves `count` places, as many as the counting pass announced; the first of them.
int reserve_fragments(ivec2 pixel, uint count) {
  return first_fragment(pixel) + int(imageAtomicAdd(fragment_cursor, pixel, count));
}
void store_fragment(int place, uvec2 record) { imageStore(fragment_image, place, uvec4(record, 0u, 0u)); }
