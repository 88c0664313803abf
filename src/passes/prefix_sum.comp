// Reduce, then scan: no group waits for another, which OpenGL does not promise to make progress.
//   SUM_BLOCKS    one sum for each block of 2048 words
//   SCAN_SUMS     one group: sums become sums of the blocks before, the total behind the last
//   (neither)     words become sums of the words before
#include "work_groups.glsl"

layout(local_size_x = 256) in;
layout(std430, binding = 0) buffer Words { uint words[]; };
layout(std430, binding = 1) buffer Sums { uint sums[]; };

uniform uint word_count;
uniform uint block_count;

const uint words_a_thread = 8u;
const uint words_a_block = 256u * words_a_thread;

shared uint partial[256];

// Saturates, so that a sum beyond 32 bits is seen as such.
uint add(uint a, uint b) { return a + b < a ? 0xffffffffu : a + b; }

// Exclusive sum over the threads of the group (Hillis and Steele 1986); `all` is the sum of everything.
uint sum_before(uint value, out uint all) {
  uint thread = gl_LocalInvocationID.x;
  partial[thread] = value;
  barrier();
  for (uint reach = 1u; reach < 256u; reach *= 2u) {
    uint before = thread >= reach ? partial[thread - reach] : 0u;
    barrier();
    partial[thread] = add(partial[thread], before);
    barrier();
  }
  uint mine = partial[thread];
  all = partial[255];
  barrier();
  return mine - value;
}

#ifdef SCAN_SUMS
void main() {
  uint carry = 0u;
  for (uint first = 0u; first < block_count; first += 256u) {
    uint k = first + gl_LocalInvocationID.x, all;
    uint value = k < block_count ? sums[k] : 0u;
    uint before = sum_before(value, all);
    if (k < block_count) sums[k] = add(carry, before);
    carry = add(carry, all);
  }
  if (gl_LocalInvocationID.x == 0u) sums[block_count] = carry;
}
#else
void main() {
  uint block = gl_WorkGroupID.x + group_row() * gl_NumWorkGroups.x;
  if (block >= block_count) return;
  uint first = block * words_a_block + gl_LocalInvocationID.x * words_a_thread, all;
  uint last = min(first + words_a_thread, word_count);
  uint sum = 0u;
  for (uint k = first; k < last; ++k) sum = add(sum, words[k]);
  uint before = sum_before(sum, all);
#ifdef SUM_BLOCKS
  if (gl_LocalInvocationID.x == 0u) sums[block] = all;
#else
  before += sums[block];
  for (uint k = first; k < last; ++k) {
    uint value = words[k];
    words[k] = before;
    before += value;
  }
#endif
}
#endif
