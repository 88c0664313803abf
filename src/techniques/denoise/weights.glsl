// Adds the weight of one hit to its bin and tracks the nearest bin above the threshold: weights are positive and
// additions to a bin have an order, so that the last one sees the final sum (Eq. 4, 6).
#include "techniques/denoise/bins.glsl"

#ifdef FAST
layout(r32f, binding = 0) coherent uniform imageBuffer bin_weights;
#else
layout(r32ui, binding = 0) coherent uniform uimageBuffer bin_weights;
#endif
#ifndef DENSE
layout(r32ui, binding = 1) coherent uniform uimageBuffer bin_keys;
#endif
layout(r32ui, binding = 2) coherent uniform uimage2D first_bin;
layout(r32ui, binding = 3) uniform uimageBuffer counters;  // overflow, saturated

uniform uint reach;  // bins behind the first one that still matter

const float most_weight = 4095.0;     // of one hit: what no sum may pass leaves room for it
const uint most_add = 0x10000000u;

// -1 when the table is full.
int claim_slot(ivec2 pixel, uint b) {
  int base = first_slot(pixel);
#ifdef DENSE
  return base + int(b);
#else
  uint slot = hashed_slot(b);
  for (int probe = 0; probe < slots; ++probe) {
    uint key = imageLoad(bin_keys, base + int(slot)).x;  // a key never changes once it is there
    if (key == 0u) key = imageAtomicCompSwap(bin_keys, base + int(slot), 0u, b + 1u);
    if (key == 0u || key == b + 1u) return base + int(slot);
    slot = (slot + 1u) & uint(slots - 1);
  }
  return -1;
#endif
}

void add_to_bin(ivec2 pixel, uint b, float weight) {
  // Bins behind the one that is already found cannot become the nearest.
  uint first = imageLoad(first_bin, pixel).x;
  if (first != no_bin && b > first + reach) return;
  int at = claim_slot(pixel, b);
  if (at < 0) {
    imageAtomicAdd(counters, 0, 1u);
    return;
  }
#ifdef FAST
  bool above = imageAtomicAdd(bin_weights, at, weight) + weight > weight_threshold;
#else
  uint add = max(uint(min(weight, most_weight) * weight_unit + 0.5), 1u);
  uint before = imageAtomicAdd(bin_weights, at, add);
  if (before >= 0u - most_add) {
    imageAtomicAdd(bin_weights, at, 0u - add);
    imageAtomicAdd(counters, 1, 1u);
  }
  bool above = before + add > uint(weight_threshold * weight_unit);
#endif
  if (above && b < first) imageAtomicMin(first_bin, pixel, b);
}

void add_weight(ivec2 pixel, float t, float weight) {
  float origin = bin_origin(pixel);
  uint b = bin_of(bin_distance(t, origin));
  add_to_bin(pixel, b, weight);
#ifdef OVERLAPPING
  if (reaches_earlier(bin_distance(t, origin), b)) add_to_bin(pixel, b - 1u, weight);
#endif
}
