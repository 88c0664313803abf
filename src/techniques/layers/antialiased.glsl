// The colour of a layer's pixel, smoothed and with its edges antialiased. Include after `depth_image`, `color_image` and
// `d_min`.
#include "techniques/layers/edge.glsl"
#include "techniques/layers/gaussian.glsl"

uniform bool smooth_once;
uniform bool antialias;

vec4 layer_color(ivec2 pixel, float depth) {
  return smooth_once ? smoothed(pixel, depth) : texelFetch(color_image, pixel, 0);
}

// A pixel on an edge is replaced by the Gaussian of its 3 x 3 pixels, background included. Premultiplied; `covered`: the
// share of the pixel that the layer covers.
vec4 antialiased(ivec2 pixel, float depth, out float covered) {
  covered = isinf(depth) ? 0.0 : 1.0;
  if (!antialias || !is_edge(pixel, depth)) return layer_color(pixel, depth);
  vec4 sum = vec4(0.0);
  covered = 0.0;
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) {
      ivec2 at = pixel + ivec2(x, y);
      float depth_there = depth_at(at);
      if (isinf(depth_there)) continue;
      sum += gaussian(x, y) * layer_color(at, depth_there);
      covered += gaussian(x, y);
    }
  return sum;
}
