// One digit of a least-significant-digit radix sort; 4 bits, so that a count for each thread fits in shared memory
// and the order within a block stays stable without subgroup operations.
//   COUNT_DIGITS   counts[digit][block]; else (counts summed up): moves the places
layout(local_size_x = 256) in;
layout(std430, binding = 0) readonly buffer Keys { uint keys[]; };
layout(std430, binding = 1) readonly buffer From { uint from[]; };
layout(std430, binding = 2) writeonly buffer To { uint to[]; };
layout(std430, binding = 3) buffer Counts { uint counts[]; };

uniform uint place_count;
uniform uint block_count;
uniform int digit_shift;

const uint places_a_thread = 16u;

shared uint of_thread[16 * 256];  // [digit][thread]

void main() {
  uint block = gl_WorkGroupID.x, thread = gl_LocalInvocationID.x;
  uint first = (block * 256u + thread) * places_a_thread, last = min(first + places_a_thread, place_count);
  for (uint digit = 0u; digit < 16u; ++digit) of_thread[digit * 256u + thread] = 0u;
  for (uint k = first; k < last; ++k) ++of_thread[(keys[from[k]] >> digit_shift & 15u) * 256u + thread];
  barrier();
  if (thread < 16u) {
    uint sum = 0u;
#ifdef COUNT_DIGITS
    for (uint t = 0u; t < 256u; ++t) sum += of_thread[thread * 256u + t];
    counts[thread * block_count + block] = sum;
#else
    sum = counts[thread * block_count + block];
    for (uint t = 0u; t < 256u; ++t) {
      uint own = of_thread[thread * 256u + t];
      of_thread[thread * 256u + t] = sum;
      sum += own;
    }
#endif
  }
#ifndef COUNT_DIGITS
  barrier();
  for (uint k = first; k < last; ++k) {
    uint place = from[k];
    to[of_thread[(keys[place] >> digit_shift & 15u) * 256u + thread]++] = place;
  }
#endif
}
