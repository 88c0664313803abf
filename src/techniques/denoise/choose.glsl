// The bin of every pixel (Eq. 6), or -1; its weight in the table, the threshold in force, and where the bin ends (ray
// distance, or -1).
#include "techniques/denoise/bins.glsl"

layout(binding = UNIT_INPUT + 1) uniform usampler2D first_bin;
#ifdef FAST
layout(binding = UNIT_INPUT + 2) uniform samplerBuffer bin_weights;
#else
layout(binding = UNIT_INPUT + 2) uniform usamplerBuffer bin_weights;
#endif
layout(binding = UNIT_INPUT + 3) uniform usamplerBuffer bin_keys;

uniform float peak_share;
uniform int peak_bins;
uniform bool heaviest_bin;  // where no bin is above the threshold the heaviest one is taken
uniform bool last_bin;

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

// Of a pixel without a bin above the threshold: the heaviest bin, or the last one with data.
uint second_choice(ivec2 pixel) {
  int base = first_slot(pixel);
  uint last = no_bin, heaviest = no_bin;
  float most = 0.0;
  for (int slot = 0; slot < slots; ++slot) {
    float weight = weight_in(base + slot);
    if (!(weight > 0.0)) continue;
#ifdef DENSE
    uint b = uint(slot);
#else
    uint b = texelFetch(bin_keys, base + slot).x - 1u;
#endif
    if (last == no_bin || b > last) last = b;
    if (weight > most || (weight == most && b < heaviest)) {
      heaviest = b;
      most = weight;
    }
  }
  return heaviest_bin ? heaviest : last;
}

// Ray distance where bin b ends.
float end_of(ivec2 pixel, uint b) {
#ifdef DENSE
  if (int(b) == slots - 1) return infinity;
#endif
  return bin_origin(pixel) + (bin_start(b) + 1.0) * bin_size;
}

bool filter_pixel(ivec2 pixel) {
  uint b = texelFetch(first_bin, pixel, 0).x;
  float threshold = weight_threshold;
  out_0 = vec4(-1.0, 0.0, threshold, -1.0);
  if (b == no_bin && (heaviest_bin || last_bin) && !isinf(texelFetch(nearest_t, pixel, 0).x)) b = second_choice(pixel);
  if (b == no_bin) return true;
  float weight = weight_of(pixel, b);
  if (peak_bins > 0 && weight > threshold) {
    float peak = weight;
    for (int k = 1; k <= peak_bins; ++k) peak = max(peak, weight_of(pixel, b + uint(k)));
    threshold = max(threshold, peak_share * peak);
    while (!(weight > threshold)) weight = weight_of(pixel, ++b);  // ends at the peak: peak_share < 1
  }
  out_0 = vec4(float(b), weight, threshold, end_of(pixel, b));
  return true;
}
