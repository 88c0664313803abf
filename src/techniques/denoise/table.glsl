// The finished table of weights, read.
#include "techniques/denoise/bins.glsl"

#ifdef FAST
layout(binding = UNIT_INPUT + 2) uniform samplerBuffer bin_weights;
#else
layout(binding = UNIT_INPUT + 2) uniform usamplerBuffer bin_weights;
#endif
layout(binding = UNIT_INPUT + 3) uniform usamplerBuffer bin_keys;

float weight_in(int slot) {
#ifdef FAST
  return texelFetch(bin_weights, slot).x;
#else
  return float(texelFetch(bin_weights, slot).x) / weight_unit;
#endif
}

float weight_of(ivec2 pixel, uint b) {
  int base = first_slot(pixel);
#ifdef DENSE
  return int(b) < slots ? weight_in(base + int(b)) : 0.0;
#else
  uint slot = hashed_slot(b);
  for (int probe = 0; probe < slots; ++probe) {
    uint key = texelFetch(bin_keys, base + int(slot)).x;
    if (key == b + 1u) return weight_in(base + int(slot));
    if (key == 0u) return 0.0;
    slot = (slot + 1u) & uint(slots - 1);
  }
  return 0.0;
#endif
}

// Of a slot within its pixel; no_bin where nothing is in it.
uint bin_in(int base, int slot) {
#ifdef DENSE
  return weight_in(base + slot) > 0.0 ? uint(slot) : no_bin;
#else
  return texelFetch(bin_keys, base + slot).x - 1u;
#endif
}

// Ray distance where bin b ends.
float end_of(ivec2 pixel, uint b) {
#ifdef DENSE
  if (int(b) == slots - 1) return infinity;
#endif
  return bin_origin(pixel) + (bin_start(b) + 1.0) * bin_size;
}
