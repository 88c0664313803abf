// The eight masks of Rosenthal and Linsen 2008, Fig. 4, in one rule: a candidate is left alone when at least
// five consecutive pixels of its ring of eight are white; any of the masks matches exactly then (all 256
// rings tested).
//   background: candidate = no sample,                    white = no sample
//   BITS:       the depths are what atomicMin left: float bits, 0xffffffff where nothing
//   OCCLUDED:   candidate = sample at depth d,            white = deeper than d - d_min
//   GAPS:       candidate = either,                       white = no sample, or deeper than d - d_min
// The minus sign is that of Rosenthal and Linsen; the plus printed in Dobrev 2010, Sec. 3 eats whole
// surfaces.
#include "bindings.glsl"

#ifdef BITS
layout(binding = UNIT_INPUT) uniform usampler2D depth_bits;
#else
layout(binding = UNIT_INPUT) uniform sampler2D depth_image;
#endif
#if EXTRAS > 0
layout(binding = UNIT_INPUT + 1) uniform sampler2D extra_image_0;
#endif
#if EXTRAS > 1
layout(binding = UNIT_INPUT + 2) uniform sampler2D extra_image_1;
#endif
#ifdef INDEX
layout(binding = UNIT_INPUT + 1) uniform usampler2D index_image;
#endif
#if defined(OCCLUDED) || defined(GAPS)
uniform float d_min;
#endif

#define infinity uintBitsToFloat(0x7f800000u)  // no constant to every compiler
const ivec2 ring[8] = ivec2[8](ivec2(-1, -1), ivec2(0, -1), ivec2(1, -1), ivec2(1, 0), ivec2(1, 1), ivec2(0, 1),
                               ivec2(-1, 1), ivec2(-1, 0));

#ifdef BITS
#define FIRST_INPUT depth_bits
float depth_of(ivec2 at) {
  uint bits = texelFetch(depth_bits, at, 0).x;
  return bits == 0xffffffffu ? infinity : uintBitsToFloat(bits);
}
#else
#define FIRST_INPUT depth_image
float depth_of(ivec2 at) { return texelFetch(depth_image, at, 0).x; }
#endif

bool filter_pixel(ivec2 pixel) {
  float depth = depth_of(pixel);
  ivec2 size = textureSize(FIRST_INPUT, 0), from = pixel;
#ifdef GAPS
  const bool is_candidate = true;
  float limit = depth - d_min;
#elif defined(OCCLUDED)
  bool is_candidate = !isinf(depth);
  float limit = depth - d_min;
#else
  bool is_candidate = isinf(depth);
#endif
  if (is_candidate) {
    uint white = 0u;
    float nearest = infinity;
    ivec2 nearest_at = pixel;
    for (int k = 0; k < 8; ++k) {
      ivec2 at = pixel + ring[k];
      bool is_inside = all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, size));
      float neighbor = is_inside ? depth_of(at) : infinity;
#ifdef GAPS
      if (neighbor > limit || isinf(neighbor)) white |= 1u << k;
#elif defined(OCCLUDED)
      if (neighbor > limit) white |= 1u << k;
#else
      if (isinf(neighbor)) white |= 1u << k;
#endif
      if (neighbor < nearest) {
        nearest = neighbor;
        nearest_at = at;
      }
    }
    uint twice = white | white << 8;
    bool is_outline = ((twice & twice >> 1 & twice >> 2 & twice >> 3 & twice >> 4) & 0xffu) != 0u;
    if (!is_outline) {
      depth = nearest;
      from = nearest_at;
    }
  }
  out_0 = vec4(depth);
#if EXTRAS > 0
  out_1 = texelFetch(extra_image_0, from, 0);
#endif
#if EXTRAS > 1
  out_2 = texelFetch(extra_image_1, from, 0);
#endif
#ifdef INDEX
  out_1 = texelFetch(index_image, from, 0);
#endif
  return true;
}
