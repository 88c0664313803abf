// Where a surface ends against the background: where its points do not stand around. The discs found in two frames are
// not the same, and their rims flicker; which points stand around a place is the same as long as they are seen.
//
// A place is inside when no half plane through it is free of points: when it lies in the convex hull of those within
// some spacings, as the hulls of alpha shapes (Edelsbrunner, Kirkpatrick, Seidel 1983) are put together of.
#include "techniques/surface/level_corner.glsl"

layout(binding = UNIT_INPUT + 7) uniform sampler2D clusters;  // all levels side by side, as in ball.glsl

uniform int levels;            // of clusters
uniform float spacing_px;      // at level 0 of Eq. 1, px of the picture
uniform float widest_gap;      // that a disc closes, point spacings

const float hull_scale = 1.5;   // point spacings: discs close the gaps between points out to 1.6
const float real_cover = 1e-5;  // weight above which there is a disc, and not only what disc.frag fills around points
const float disc_cover = 1e-3;  // more than the outermost rim of one

// Those of 32 sectors of the compass, one bit each, with a cluster within r px of `place`; from squares of 1 to 2
// times r / cells, and no finer than there are.
uint sectors_around(vec2 place, vec2 in_clusters, float r, float cells) {
  ivec2 size = textureSize(points, 0) / 2;
  int l = clamp(int(ceil(log2(r / cells))) - 1, 0, levels - 1);
  float side = float(2 << l);
  ivec2 corner = level_corner(l, size);
  ivec2 first = max(ivec2(floor((in_clusters - r) / side)), ivec2(0));
  ivec2 last = min(min(ivec2(floor((in_clusters + r) / side)), first + 15), (size >> l) - 1);
  uint sectors = 0u;
  for (ivec2 t = first; t.y <= last.y;) {
    vec4 c = texelFetch(clusters, corner + t, 0);
    vec2 d = pixel_from_eye(c.xyz) - place;
    if (c.w > 0.0 && dot(d, d) < r * r) {
      // Opposite directions are half of the sectors apart along a diamond as along a circle, and need no arc tangent.
      float turn = d.x / max(abs(d.x) + abs(d.y), 1e-6);
      sectors |= 1u << (uint(8.0 * (d.y >= 0.0 ? 1.0 - turn : 3.0 + turn)) & 31u);
    }
    if (++t.x > last.x) t = ivec2(first.x, t.y + 1);
  }
  return sectors;
}

// Where as many sectors in a row as `count`, a power of two, are free: the first of them.
uint free_runs(uint sectors, int count) {
  uint free = ~sectors;
  for (int k = 1; k < count; k *= 2) free &= (free >> k) | (free << (32 - k));
  return free;
}

// Whether half of the sectors, in a row, are free; under a disc, one more.
bool has_free_half(uint sectors, bool has_disc) {
  uint free = free_runs(sectors, 16);
  return (has_disc ? free & ((free >> 1) | (free << 31)) : free) != 0u;
}

// `spacing` of points, px. `cover`: the weight of the discs there, `is_alone` whether one of them is by itself or of a
// line of points, which nothing stands around: that is as large as its disc.
bool is_outside(ivec2 pixel, float spacing, float cover, bool is_alone) {
  spacing = max(spacing, 0.7);
  float r = hull_scale * spacing;
  vec2 place = vec2(pixel) + 0.5;
  bool has_disc = cover > disc_cover;
  // Mostly there are discs all around.
  bool is_inside = cover > real_cover;
  ivec2 last = textureSize(color_sum, 0) - 1;
  for (int k = 0; k < 8 && is_inside; ++k) {
    ivec2 at = clamp(ivec2(floor(place + r * compass[k])), ivec2(0), last);
    is_inside = texelFetch(color_sum, at, 0).w > real_cover;
  }
  if (is_inside || is_alone || !has_free_half(sectors_around(place, place + vec2(offset), r, 3.0), has_disc)) return false;
  if (cover <= real_cover) return true;
  // A disc over a gap in the surface, and not beyond its end.
  return has_free_half(sectors_around(place, place + vec2(offset), widest_gap * spacing, 4.0), has_disc);
}
