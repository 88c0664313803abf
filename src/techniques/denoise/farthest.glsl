// The farthest end of a chosen bin over 8 x 8 pixels: splats behind it have nothing to add.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D choice;

bool filter_pixel(ivec2 block) {
  float farthest = -1.0;
  ivec2 last = textureSize(choice, 0) - 1;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x)
      farthest = max(farthest, texelFetch(choice, min(8 * block + ivec2(x, y), last), 0).w);
  out_0 = vec4(farthest);
  return true;
}
