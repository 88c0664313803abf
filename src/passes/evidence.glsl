// Whether points vouch for a pixel (evidence.h), in four steps that each look along one line: squares of distances are sums
// of squares along rows and columns.
//   ROWS        to the nearest point in the row
//   COLUMNS     to the nearest point, from that
//   OPEN_ROWS   to the nearest pixel in the row that is farther than `between` from all points: centre of an empty disc
//   SURROUNDED  1 where no such centre is as near as `between` less `beside`
#include "frame.glsl"

#ifdef ROWS
layout(binding = UNIT_INPUT) uniform usampler2D points;
#else
layout(binding = UNIT_INPUT) uniform sampler2D distances;  // squared, or along rows (COLUMNS)
layout(binding = UNIT_INPUT + 1) uniform sampler2D open_rows;
uniform float beside;
uniform int band;
#endif
uniform float between;

const float nowhere = 1e9;

// Whether the pixel is one that distances are measured to.
bool is_goal(ivec2 at, ivec2 size) {
  if (at.x < 0 || at.x >= size.x) return false;
#ifdef ROWS
  return texelFetch(points, at, 0).x != 0xffffffffu;
#else
  return texelFetch(distances, at, 0).x > between * between;
#endif
}

float nearest_in_row(ivec2 pixel, ivec2 size) {
  for (int k = 0; k <= int(between); ++k)
    if (is_goal(pixel - ivec2(k, 0), size) || is_goal(pixel + ivec2(k, 0), size)) return float(k * k);
  return nowhere;
}

float nearest_in_rows(sampler2D along, ivec2 pixel, int height) {
  float nearest = nowhere;
  for (int k = 0; k <= int(between) && float(k * k) < nearest; ++k) {
    float above = pixel.y >= k ? texelFetch(along, pixel - ivec2(0, k), 0).x : nowhere;
    float below = pixel.y + k < height ? texelFetch(along, pixel + ivec2(0, k), 0).x : nowhere;
    nearest = min(nearest, min(above, below) + float(k * k));
  }
  return nearest;
}

bool filter_pixel(ivec2 pixel) {
#if defined(ROWS)
  out_0 = vec4(nearest_in_row(pixel, textureSize(points, 0)));
#elif defined(COLUMNS)
  out_0 = vec4(nearest_in_rows(distances, pixel, textureSize(distances, 0).y));
#elif defined(OPEN_ROWS)
  out_0 = vec4(nearest_in_row(pixel, textureSize(distances, 0)));
#else
  float distance2 = texelFetch(distances, pixel + band, 0).x;
  bool vouched = distance2 <= beside * beside;
  float nearest_open = between - beside;
  if (!vouched && distance2 <= between * between)
    vouched = nearest_in_rows(open_rows, pixel + band, textureSize(open_rows, 0).y) > nearest_open * nearest_open;
  out_0 = vec4(vouched ? 1.0 : 0.0);
#endif
  return true;
}
