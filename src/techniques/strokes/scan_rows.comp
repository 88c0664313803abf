// Counts of fragments to places: STAGE 0 sums every row, STAGE 1 gives the pixels of a band their places. The sums of
// rows are turned into bands and first places by the caller.
#include "bindings.glsl"

layout(local_size_x = 16) in;
layout(binding = UNIT_INPUT) uniform sampler2D counts;
layout(std430, binding = 0) buffer Rows { uint row_places[]; };
#if STAGE == 1
layout(r32ui, binding = 0) writeonly uniform uimage2D offsets;
#endif

uniform ivec2 size;

void main() {
  int y = int(gl_GlobalInvocationID.x);
  if (y >= size.y) return;
#if STAGE == 0
  uint sum = 0u;
  for (int x = 0; x < size.x; ++x) sum += uint(texelFetch(counts, ivec2(x, y), 0).x);
  row_places[y] = sum;
#else
  uint place = row_places[y];
  for (int x = 0; x < size.x; ++x) {
    imageStore(offsets, ivec2(x, y), uvec4(place));
    place += uint(texelFetch(counts, ivec2(x, y), 0).x);
  }
#endif
}
