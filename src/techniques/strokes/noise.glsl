// Noise of values on a grid, smooth in between, 0 to 1.
#include "hash.glsl"

float smooth_noise(vec2 at, uint seed) {
  ivec2 cell = ivec2(floor(at));
  vec2 f = at - vec2(cell);
  f = f * f * (3.0 - 2.0 * f);
  float v[4];
  for (int k = 0; k < 4; ++k) {
    ivec2 corner = cell + ivec2(k & 1, k >> 1);
    v[k] = unit_from_hash(hash_of(uvec3(uint(corner.x), uint(corner.y), seed)));
  }
  return mix(mix(v[0], v[1], f.x), mix(v[2], v[3], f.x), f.y);
}
