// The colour of a layer's pixel with its edges antialiased. Include after `depth_image`, `color_image` and `d_min`.
#include "techniques/layers/edge.glsl"

uniform bool antialias;

// A pixel on an edge is replaced by the Gaussian of its 3 x 3 pixels, background included. Premultiplied; `covered`: the
// share of the pixel that the layer covers.
vec4 antialiased(ivec2 pixel, float depth, out float covered) {
  vec4 color = texelFetch(color_image, pixel, 0);
  covered = isinf(depth) ? 0.0 : 1.0;
  if (!antialias || !is_edge(pixel, depth)) return color;
  vec4 sum = vec4(0.0);
  covered = 0.0;
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) {
      ivec2 at = pixel + ivec2(x, y);
      if (isinf(depth_at(at))) continue;
      sum += gaussian(x, y) * texelFetch(color_image, at, 0);
      covered += gaussian(x, y);
    }
  return sum;
}
