// The bin of every pixel (Eq. 6), or -1; its weight in the table, the threshold in force, and where the bin ends (ray
// distance, or -1).
#include "techniques/denoise/table.glsl"

layout(binding = UNIT_INPUT + 1) uniform usampler2D first_bin;

uniform float peak_share;
uniform int peak_bins;
uniform bool heaviest_bin;  // where no bin is above the threshold the heaviest one is taken
uniform bool last_bin;

// Of a pixel without a bin above the threshold: the heaviest bin, or the last one with data.
uint second_choice(ivec2 pixel) {
  int base = first_slot(pixel);
  uint last = no_bin, heaviest = no_bin;
  float most = 0.0;
  for (int slot = 0; slot < slots; ++slot) {
    float weight = weight_in(base + slot);
    if (!(weight > 0.0)) continue;
    uint b = bin_in(base, slot);
    if (last == no_bin || b > last) last = b;
    if (weight > most || (weight == most && b < heaviest)) {
      heaviest = b;
      most = weight;
    }
  }
  return heaviest_bin ? heaviest : last;
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
