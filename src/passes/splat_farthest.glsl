// The farthest visible distance of each block of 8 x 8 pixels; pixels that no splat covers do not count.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D nearest_t;

bool filter_pixel(ivec2 block) {
  ivec2 end = min(block * 8 + 8, textureSize(nearest_t, 0));
  float farthest = 0.0;
  for (int y = block.y * 8; y < end.y; ++y)
    for (int x = block.x * 8; x < end.x; ++x) {
      float t = texelFetch(nearest_t, ivec2(x, y), 0).x;
      if (!isinf(t)) farthest = max(farthest, t);
    }
  out_0 = vec4(farthest);
  return true;
}
