// The steps of evidence.h that look along a line: the nearest pixel of those that are set is the nearest in
// its column of the nearest in their rows.
//   ROWS           px to the side, to the nearest point in the row; to the left where two are as near
//   NEAREST        its pixel x | y << 16, from that; the topmost of those as near; ~0 where none is in reach
//   ROWS_OF_SHAPE  px to the side, to the nearest pixel of triangles, and to that of what is in none
//   WIDENED        1 within the reach of either, from that, where a point is near enough
#include "frame.glsl"

#if defined(ROWS) || defined(ROWS_OF_SHAPE)
layout(binding = UNIT_INPUT) uniform usampler2D pixels;  // ROWS: 0xffffffff where there is no point
#else
layout(binding = UNIT_INPUT) uniform sampler2D along;
layout(binding = UNIT_INPUT + 1) uniform usampler2D nearest;
uniform int band;
uniform float between;
#endif
uniform vec2 reach;  // px; WIDENED and ROWS_OF_SHAPE: from triangles, and from what is in none

const float nowhere = 1e9;

#if defined(ROWS) || defined(ROWS_OF_SHAPE)
bool is_set(ivec2 at, uint part) {
  if (at.x < 0 || at.x >= textureSize(pixels, 0).x) return false;
  uint value = texelFetch(pixels, at, 0).x;
#ifdef ROWS
  return value != 0xffffffffu;
#else
  return part == 1u ? value == 1u : value >= 2u;
#endif
}

float nearest_in_row(ivec2 pixel, uint part) {
  for (int k = 0; k <= int(reach[part]); ++k) {
    if (is_set(pixel - ivec2(k, 0), part)) return float(-k);
    if (is_set(pixel + ivec2(k, 0), part)) return float(k);
  }
  return nowhere;
}
#else
// To the side and down, px; `nowhere` where none is in reach.
vec2 nearest_in_rows(ivec2 pixel, uint part) {
  vec2 offset = vec2(nowhere, 0.0);
  float least = floor(reach[part] * reach[part]) + 0.5;  // squares are whole numbers
  for (int k = 0; float(k * k) <= least; ++k)
    for (int side = -1; side <= 1; side += 2) {
      int row = pixel.y + side * k;
      if (row < 0 || row >= textureSize(along, 0).y) continue;
      vec2 found = vec2(texelFetch(along, ivec2(pixel.x, row), 0)[part], side * k);
      float distance2 = dot(found, found);
      if (distance2 > least || (distance2 == least && side > 0)) continue;
      least = distance2;
      offset = found;
    }
  return offset;
}
#endif

bool filter_pixel(ivec2 pixel) {
#if defined(ROWS)
  out_0 = vec4(nearest_in_row(pixel, 0u));
#elif defined(NEAREST)
  vec2 found = nearest_in_rows(pixel, 0u);
  uvec2 point = uvec2(pixel + ivec2(found));
  out_0 = uvec4(found.x == nowhere ? 0xffffffffu : point.x | point.y << 16);
#elif defined(ROWS_OF_SHAPE)
  out_0 = vec4(nearest_in_row(pixel, 0u), nearest_in_row(pixel, 1u), 0.0, 0.0);
#else
  pixel += band;
  uint point = texelFetch(nearest, pixel, 0).x;
  vec2 to_point = vec2(ivec2(point & 0xffffu, point >> 16) - pixel);
  bool is_near = point != 0xffffffffu && dot(to_point, to_point) <= between * between;
  bool vouched =
      is_near && min(nearest_in_rows(pixel, 0u).x, nearest_in_rows(pixel, 1u).x) < nowhere;
  out_0 = vec4(vouched ? 1.0 : 0.0);
#endif
  return true;
}
