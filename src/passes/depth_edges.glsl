// Where neighbouring pixels show different surfaces: bits of a pixel for its edges with the one above, below, on its
// left and on its right. Most have none and keep what they were cleared to.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D depth_image;

const float steepest = 4.0;  // px of depth a pixel: what is steeper may be an edge
const float sharpest = 2.0;  // times as steep as the surfaces on its two sides: what is sharper is one

ivec2 last_pixel = textureSize(depth_image, 0) - 1;

float depth_at(ivec2 pixel) { return texelFetch(depth_image, clamp(pixel, ivec2(0), last_pixel), 0).x; }

bool is_edge(float here, ivec2 pixel, ivec2 across) {
  float there = depth_at(pixel + across);
  if (isinf(here) || isinf(there)) return isinf(here) != isinf(there);
  float jump = abs(there - here);
  if (jump * pixels_at(min(here, there)) <= steepest) return false;
  float before = depth_at(pixel - across), beyond = depth_at(pixel + 2 * across);
  float slope = max(isinf(before) ? 0.0 : abs(here - before), isinf(beyond) ? 0.0 : abs(beyond - there));
  return jump > sharpest * slope;
}

bool filter_pixel(ivec2 pixel) {
  float here = depth_at(pixel);
  uint edges = 0u;
  if (is_edge(here, pixel, ivec2(0, -1))) edges |= 1u;
  if (is_edge(here, pixel, ivec2(0, 1))) edges |= 2u;
  if (is_edge(here, pixel, ivec2(-1, 0))) edges |= 4u;
  if (is_edge(here, pixel, ivec2(1, 0))) edges |= 8u;
  out_0 = uvec4(edges, 0, 0, 0);
  return edges != 0u;
}
