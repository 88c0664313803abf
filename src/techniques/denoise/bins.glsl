// Bins along the ray of a pixel, as every pass of denoise sees them.
//   DENSE         slot = bin; else a hash table of 2^hash_bits slots a pixel
//   OVERLAPPING   bin k covers [k/2, k/2 + 1) bin sizes: two bins hold every distance
//   FAST          weights are floats
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D nearest_t;

uniform float bin_size;      // scene units along the ray
uniform bool anchor_grid;    // bins begin at multiples of bin_size, else at the nearest hit
uniform int slots;           // a pixel
uniform int hash_bits;
uniform int image_width;

const uint no_bin = 0xffffffffu;
const float weight_unit = 65536.0;  // fixed point: sums up to 61440, errors of 1e-5 a hit

int first_slot(ivec2 pixel) { return (pixel.y * image_width + pixel.x) * slots; }

// Where the bins of a pixel begin: ray distance.
float bin_origin(ivec2 pixel) {
  float first = texelFetch(nearest_t, pixel, 0).x;
  return anchor_grid ? floor(first / bin_size) * bin_size : first;
}

// Distance behind the first bin's border, in bin sizes. The nearest hit itself may come out a rounding below 0.
float bin_distance(float t, float origin) { return clamp((t - origin) / bin_size, 0.0, 8388607.0); }

// (Eq. 3): b = floor((t - t_min) / Delta). With overlapping bins the later of two; the other one is b - 1.
uint bin_of(float distance) {
#ifdef OVERLAPPING
  uint b = uint(floor(2.0 * distance));
#else
  uint b = uint(floor(distance));
#endif
#ifdef DENSE
  b = min(b, uint(slots - 1));
#endif
  return b;
}

// Where bin b begins, in bin sizes behind the origin.
float bin_start(uint b) {
#ifdef OVERLAPPING
  return 0.5 * float(b);
#else
  return float(b);
#endif
}

#ifdef OVERLAPPING
// Whether a hit in bin b = bin_of(distance) lies in bin b - 1 too. Not what the last of the dense bins took in: it lies
// beyond both.
bool reaches_earlier(float distance, uint b) { return b > 0u && distance < bin_start(b - 1u) + 1.0; }
#endif

uniform float weight_threshold;

uint hashed_slot(uint b) { return (b * 2654435769u) >> (32 - hash_bits); }  // 2^32 / golden ratio
