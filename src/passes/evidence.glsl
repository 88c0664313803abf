// The steps of evidence.h that look along a line: the nearest pixel of those that are set is the nearest in
// its column of the nearest in their rows.
//   ROWS           px to the side, to the nearest point in the row; to the left where two are as near
//   NEAREST        the nearest point, from that; the topmost of those as near; -1 where none is in reach
//   ROWS_OF_SHAPE  px to the side, to the nearest pixel of triangles, and to that of what is in none
//   WIDENED        1 within the reach of either, from that, where a point is near enough
#include "frame.glsl"

#if defined(ROWS) || defined(ROWS_OF_SHAPE)
layout(binding = UNIT_INPUT) uniform usampler2D pixels;  // ROWS: 0xffffffff where there is no point
#else
layout(binding = UNIT_INPUT) uniform sampler2D along;
layout(binding = UNIT_INPUT + 1) uniform sampler2D nearest;
uniform int band;
uniform float between;
#endif
uniform vec2 reach;

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
// To the side and down, px; beyond the reach where there is none.
vec2 nearest_in_rows(ivec2 pixel, uint part) {
  vec2 offset = vec2(nowhere, 0.0);
  float least = nowhere;
  for (int k = 0; k <= int(reach[part]) && float(k * k) <= least; ++k)
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
  out_0 = found.x == nowhere ? vec4(-1.0) : vec4(vec2(pixel) + found, 0.0, 0.0);
#elif defined(ROWS_OF_SHAPE)
  out_0 = vec4(nearest_in_row(pixel, 0u), nearest_in_row(pixel, 1u), 0.0, 0.0);
#else
  pixel += band;
  vec2 triangle = nearest_in_rows(pixel, 0u), lone = nearest_in_rows(pixel, 1u);
  vec2 point = texelFetch(nearest, pixel, 0).xy, to_point = point - vec2(pixel);
  bool vouched = point.x >= 0.0 && dot(to_point, to_point) <= between * between &&
                 (dot(triangle, triangle) <= reach.x * reach.x || dot(lone, lone) <= reach.y * reach.y);
  out_0 = vec4(vouched ? 1.0 : 0.0);
#endif
  return true;
}
