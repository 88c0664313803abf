// Counts of the pixels as words in the order of rows, for the prefix sum.
#include "bindings.glsl"
#include "work_groups.glsl"

layout(local_size_x = 128) in;
layout(binding = UNIT_INPUT) uniform sampler2D counts;
layout(std430, binding = 0) writeonly buffer Words { uint words[]; };

uniform ivec2 size;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.x, group_row());
  if (pixel.x >= size.x) return;
  words[pixel.y * size.x + pixel.x] = uint(texelFetch(counts, pixel, 0).x);
}
