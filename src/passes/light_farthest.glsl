// The farthest depth of each 4 x 4 texels of a light map; 0 where nothing is.
#include "bindings.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D light_map;

bool filter_pixel(ivec2 pixel) {
  ivec2 last = textureSize(light_map, 0) - 1;
  float farthest = 0.0;
  for (int k = 0; k < 16; ++k) {
    float depth = texelFetch(light_map, min(4 * pixel + ivec2(k & 3, k >> 2), last), 0).x;
    farthest = isinf(depth) ? farthest : max(farthest, depth);
  }
  out_0 = vec4(farthest);
  return true;
}
