// How far a layer is seen through, of the share of every pixel that the next one covers: nothing at the edge of
// that and all from `reach` px inside it, so that no seam is where another layer begins. A half of a triangle
// filter, once along x and once along y; at a straight edge it is 1/2 on the edge, whose lower half is cut off.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D share_image;
#ifdef LAST
layout(binding = UNIT_INPUT + 1) uniform sampler2D covered_image;  // nothing is seen through to where it has none
#endif

uniform ivec2 along;  // px: an eighth of the reach

bool filter_pixel(ivec2 pixel) {
  const int taps = 8;
  ivec2 last = textureSize(share_image, 0) - 1;
  float sum = 0.0, weights = 0.0;
  for (int k = -taps; k <= taps; ++k) {
    float weight = float(taps + 1 - abs(k));
    sum += weight * texelFetch(share_image, clamp(pixel + k * along, ivec2(0), last), 0).x;
    weights += weight;
  }
  float share = sum / weights;
#ifdef LAST
  share = min(smoothstep(0.5, 1.0, share), texelFetch(covered_image, pixel, 0).x);
#endif
  out_0 = vec4(share);
  return true;
}
