// Stable compaction of flags into a list, without barriers or atomics, so that the list is the same every time:
//   STAGE 0   a thread counts the flags of its 128 slots
//   STAGE 1   a thread turns 128 counts into offsets and their sum
//   STAGE 2   one thread turns the sums into offsets and writes the draw command
//   STAGE 3   a thread lists the points of its 128 slots, as often as the flag says
#include "cloud.glsl"

layout(local_size_x = 32) in;
layout(binding = UNIT_INPUT) uniform usamplerBuffer flags;
layout(std430, binding = 0) buffer Offsets { uint offsets[]; };
layout(std430, binding = 1) buffer Sums { uint sums[]; };
layout(std430, binding = 2) writeonly buffer List { uint list[]; };
layout(std430, binding = 3) writeonly buffer Command { uint command[]; };

uniform uint group_count;      // of 128 slots
uniform uint groups_per_batch;

void main() {
  uint g = gl_GlobalInvocationID.x;
#if STAGE == 0
  if (g >= group_count) return;
  uint count = 0u;
  for (uint s = 0u; s < 128u; ++s) count += texelFetch(flags, int(g * 128u + s)).x;
  offsets[g] = count;
#elif STAGE == 1
  if (g * 128u >= group_count) return;
  uint sum = 0u;
  for (uint o = g * 128u; o < min(g * 128u + 128u, group_count); ++o) {
    uint count = offsets[o];
    offsets[o] = sum;
    sum += count;
  }
  sums[g] = sum;
#elif STAGE == 2
  if (g > 0u) return;
  uint sum = 0u;
  for (uint b = 0u; b * 128u < group_count; ++b) {
    uint count = sums[b];
    sums[b] = sum;
    sum += count;
  }
  command[0] = sum;  // vertices, instances, first, base
  command[1] = 1u;
  command[2] = 0u;
  command[3] = 0u;
#else
  if (g >= group_count) return;
  uint at = offsets[g] + sums[g / 128u];
  Batch batch = visible_batch(g / groups_per_batch);
  uint first = uint(batch.first) + (g % groups_per_batch) * 128u;
  for (uint s = 0u; s < 128u; ++s)
    for (uint times = texelFetch(flags, int(g * 128u + s)).x; times > 0u; --times) list[at++] = first + s;
#endif
}
