// The nearest ray distance of every pixel by atomicMin: bits of positive floats sort like them.
#include "techniques/surface/disc.glsl"
#include "work_groups.glsl"

layout(local_size_x = 16, local_size_y = 8) in;
layout(r32ui, binding = 0) uniform uimage2D nearest_bits;

void main() {
  ivec2 square = ivec2(gl_GlobalInvocationID.x, group_row() * 8u + gl_LocalInvocationID.y);
  if (any(greaterThanEqual(square, textureSize(orientations, 0)))) return;
  Splat splat = disc_at(square);
  vec4 clip = texelFetch(clips, square, 0);
  ivec2 first, last;
  if (!splat_pixels(splat, first, last)) return;
  for (ivec2 pixel = first; pixel.y <= last.y;) {
    SplatHit hit;
    if (hit_disc(splat, clip, vec2(pixel) + 0.5, hit)) {
      uint bits = floatBitsToUint(hit.t);
      if (bits < imageLoad(nearest_bits, pixel).x) imageAtomicMin(nearest_bits, pixel, bits);
    }
    if (++pixel.x > last.x) pixel = ivec2(first.x, pixel.y + 1);
  }
}
