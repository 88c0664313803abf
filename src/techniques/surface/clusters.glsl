// Fine to coarse: the centroid of the points of 2x2 squares, their number and mean spacing. Points on both
// sides of a depth edge have no mean: the near side stays. Hidden points do not count, but it is said that there are.
#include "techniques/surface/cluster_edge.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D finer;        // eye position, number
layout(binding = UNIT_INPUT + 1) uniform sampler2D finer_about;  // spacing, 1 where points are hidden
uniform float width_px;  // of the coarser squares

bool filter_pixel(ivec2 square) {
  vec4 children[4];
  vec2 about[4];
  float nearest = -infinity, spacing = 0.0, has_hidden = 0.0;
  for (int k = 0; k < 4; ++k) {
    ivec2 at = 2 * square + ivec2(k & 1, k >> 1);
    children[k] = texelFetch(finer, at, 0);
    about[k] = texelFetch(finer_about, at, 0).xy;
    has_hidden = max(has_hidden, about[k].y);
    if (children[k].w > 0.0 && children[k].z > nearest) {
      nearest = children[k].z;
      spacing = about[k].x;
    }
  }
  float behind = cluster_edge(nearest, spacing, width_px);
  vec4 sum = vec4(0.0);
  float sum_about = 0.0;
  for (int k = 0; k < 4; ++k) {
    float weight = children[k].z >= behind ? max(children[k].w, 0.0) : 0.0;
    sum += vec4(weight * children[k].xyz, weight);
    sum_about += weight * about[k].x;
  }
  float scale = sum.w > 0.0 ? 1.0 / sum.w : 0.0;
  out_0 = vec4(sum.xyz * scale, sum.w);
  out_1 = vec4(sum_about * scale, has_hidden, 0.0, 0.0);
  return true;
}
