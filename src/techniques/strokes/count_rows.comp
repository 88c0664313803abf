// How many fragments every row has.
#include "bindings.glsl"

layout(local_size_x = 16) in;
layout(binding = UNIT_INPUT) uniform sampler2D counts;
layout(std430, binding = 0) writeonly buffer Rows { uint row_counts[]; };

uniform ivec2 size;

void main() {
  int y = int(gl_GlobalInvocationID.x);
  if (y >= size.y) return;
  uint sum = 0u;
  for (int x = 0; x < size.x; ++x) sum += uint(texelFetch(counts, ivec2(x, y), 0).x);
  row_counts[y] = sum;
}
