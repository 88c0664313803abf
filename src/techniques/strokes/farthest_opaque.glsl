// The farthest window depth of each block of 8 x 8 pixels: 1 where a pixel has no opaque stroke.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D opaque_depth;

bool filter_pixel(ivec2 block) {
  ivec2 end = min(block * 8 + 8, textureSize(opaque_depth, 0));
  float farthest = 0.0;
  for (int y = block.y * 8; y < end.y; ++y)
    for (int x = block.x * 8; x < end.x; ++x) farthest = max(farthest, texelFetch(opaque_depth, ivec2(x, y), 0).x);
  out_0 = vec4(farthest);
  return true;
}
