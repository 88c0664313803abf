// Squares of 2x2 px: the centroid of the points that hidden point removal left, their number, spacing and colour.
// Points behind the nearest by more than an edge are of another side, and left out. Squares of hidden points have the
// same, for through_gaps.glsl; their number is less than 0.
#include "techniques/surface/cluster_edge.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D points;    // eye position and spacing of every pixel
layout(binding = UNIT_INPUT + 1) uniform sampler2D visible;   // of squares: depth, 0, spacing, visible
layout(binding = UNIT_INPUT + 2) uniform sampler2D shadowed;  // colour and shadow factor of every pixel

uniform float lit_depth;  // point spacings behind the nearest point within which shadow factors count

// Depth, 0 and spacing of the nearest of all points, as `visible` has it.
vec4 nearest_of(ivec2 square) {
  vec4 nearest = vec4(infinity, 0.0, 0.0, 0.0);
  for (int k = 0; k < 4; ++k) {
    vec4 point = texelFetch(points, 2 * square + ivec2(k & 1, k >> 1), 0);
    if (point.w > 0.0 && -point.z < nearest.x) nearest = vec4(-point.z, 0.0, point.w, 1.0);
  }
  return nearest;
}

bool filter_pixel(ivec2 square) {
  vec4 nearest = texelFetch(visible, square, 0), sum = vec4(0.0), color = vec4(0.0);
  bool is_hidden = nearest.w <= 0.0;
  if (is_hidden) nearest = nearest_of(square);
  vec2 factors = vec2(0.0);
  float behind = cluster_edge(-nearest.x, nearest.z, 2.0);
  float spacing = 0.0;
  for (int k = 0; k < 4; ++k) {
    ivec2 at = 2 * square + ivec2(k & 1, k >> 1);
    vec4 point = texelFetch(points, at, 0);
    if (nearest.w <= 0.0 || point.w <= 0.0 || point.z < behind) continue;
    sum += vec4(point.xyz, 1.0);
    spacing += point.w;
    vec4 own = texelFetch(shadowed, at, 0);
    color += own;
    if (point.z >= -nearest.x - lit_depth * nearest.z) factors += vec2(own.a, 1.0);
  }
  float scale = sum.w > 0.0 ? 1.0 / sum.w : 0.0;
  out_0 = vec4(sum.xyz * scale, is_hidden ? -sum.w : sum.w);
  out_1 = vec4(spacing * scale, float(is_hidden && sum.w > 0.0), 0.0, 0.0);
  out_2 = vec4(color.rgb * scale, factors.y > 0.0 ? factors.x / factors.y : 1.0);
  return true;
}
