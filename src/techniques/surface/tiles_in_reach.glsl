// Tiles with a point within reach of the operator. In all others every pixel is open sky: mean occlusion 2.
#include "bindings.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D pyramid;
layout(binding = UNIT_INPUT + 1) uniform sampler2D removal_level;

uniform int tile_level;  // log2 of the side of a tile
uniform int coarse_level;
uniform int top_level;
uniform float gap_level;     // log2 of the reach of holes over that of points
uniform float window_level;  // of a window, which looks as far everywhere; else 0

bool filter_pixel(ivec2 tile) {
  // The levels between which those of the tile's pixels are interpolated.
  ivec2 last = textureSize(removal_level, 0) - 1;
  ivec2 lo = max(((tile << tile_level) >> coarse_level) - 1, ivec2(0));
  ivec2 hi = min((((tile + 1) << tile_level) - 1 >> coarse_level) + 1, last);
  float level = window_level;
  for (int y = lo.y; y <= hi.y; ++y)
    for (int x = lo.x; x <= hi.x; ++x)
      level = max(level, texelFetch(removal_level, ivec2(x, y), 0).x + gap_level);

  // Pixels without a point look at rings of squares up to that level: all of them lie in these nine.
  int reach = clamp(int(ceil(level)), tile_level, top_level);
  // llvmpipe (Mesa 22.3) answers textureSize(pyramid, reach) for eight pixels at once with the size of one's level.
  ivec2 end = (textureSize(pyramid, 0) >> reach) - 1;
  bool any_point = false;
  for (int k = 0; k < 9; ++k) {
    ivec2 at = (tile >> (reach - tile_level)) + ivec2(k % 3, k / 3) - 1;
    if (texelFetch(pyramid, clamp(at, ivec2(0), end), reach).w > 0.0) any_point = true;
  }
  out_0 = vec4(any_point ? 1.0 : 0.0);
  return true;
}
