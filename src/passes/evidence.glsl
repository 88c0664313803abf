// The steps of evidence.h that look along a line: the nearest pixel of those that are set is the nearest in
// its column of the nearest in their rows.
//   ROWS     px to the side, to the nearest in the row; to the left where two are as near
//   NEAREST  the nearest pixel, from that; the topmost of those as near; -1 where none is within the reach
//   WIDENED  1 within the reach, from that, where a point is near enough
#include "frame.glsl"

#ifdef ROWS
layout(binding = UNIT_INPUT) uniform usampler2D pixels;  // 0xffffffff: not set
#else
layout(binding = UNIT_INPUT) uniform sampler2D along;
layout(binding = UNIT_INPUT + 1) uniform sampler2D nearest;  // of the points
uniform int band;
uniform float between;
#endif
uniform float reach;

const float nowhere = 1e9;

#ifdef ROWS
bool is_set(ivec2 at) {
  return at.x >= 0 && at.x < textureSize(pixels, 0).x && texelFetch(pixels, at, 0).x != 0xffffffffu;
}

float nearest_in_row(ivec2 pixel) {
  for (int k = 0; k <= int(reach); ++k) {
    if (is_set(pixel - ivec2(k, 0))) return float(-k);
    if (is_set(pixel + ivec2(k, 0))) return float(k);
  }
  return nowhere;
}
#else
/// To the side and down, px; beyond the reach where there is none.
vec2 nearest_in_rows(ivec2 pixel) {
  vec2 offset = vec2(nowhere, 0.0);
  float least = nowhere;
  for (int k = 0; k <= int(reach) && float(k * k) <= least; ++k)
    for (int side = -1; side <= 1; side += 2) {
      int row = pixel.y + side * k;
      if (row < 0 || row >= textureSize(along, 0).y) continue;
      vec2 found = vec2(texelFetch(along, ivec2(pixel.x, row), 0).x, side * k);
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
  out_0 = vec4(nearest_in_row(pixel));
#elif defined(NEAREST)
  vec2 found = nearest_in_rows(pixel);
  out_0 = found.x == nowhere ? vec4(-1.0) : vec4(vec2(pixel) + found, 0.0, 0.0);
#else
  pixel += band;
  vec2 found = nearest_in_rows(pixel), point = texelFetch(nearest, pixel, 0).xy;
  bool vouched = dot(found, found) <= reach * reach && point.x >= 0.0 &&
                 dot(point - vec2(pixel), point - vec2(pixel)) <= between * between;
  out_0 = vec4(vouched ? 1.0 : 0.0);
#endif
  return true;
}
