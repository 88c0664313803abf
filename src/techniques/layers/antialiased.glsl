// The colour of a layer's pixel with its edges antialiased. Include after `depth_image`, `color_image` and
// `shape_image`.
#include "techniques/layers/edge.glsl"
#include "techniques/layers/gaussian.glsl"

uniform bool antialias;

// One of its four neighbours lies nearer or farther by more than the layer is thick; background: infinitely
// far.
bool is_edge(ivec2 pixel, float depth) {
  bool is_marked = false;
  float thickness = texelFetch(shape_image, pixel, 0).y;
  for (int k = 0; k < 4; ++k) {
    float neighbor = depth_at(pixel + cross_of_four[k]);
    // Not the absolute difference: infinity minus infinity is no jump.
    is_marked = is_marked || max(depth, neighbor) > min(depth, neighbor) + thickness;
  }
  return is_marked;
}

// A pixel on an edge is replaced by the Gaussian of its 3 x 3 pixels, background included. Premultiplied;
// `covered`: the share of the pixel that the layer covers (COVERED).
vec4 antialiased(ivec2 pixel, float depth, out float covered) {
  covered = 1.0;
  vec4 sum = vec4(0.0);
#ifdef COVERED
  float weights = 0.0;
#endif
  int taps = antialias && is_edge(pixel, depth) ? 9 : 0;
  for (int tap = 0; tap < taps; ++tap) {
    ivec2 at = pixel + gaussian_offset(tap);
    sum += gaussian_weight(tap) * texelFetch(color_image, clamped(at), 0);  // 0 where nothing is
#ifdef COVERED
    weights += isinf(depth_at(at)) ? 0.0 : gaussian_weight(tap);
#endif
  }
#ifdef COVERED
  covered = taps > 0 ? weights : isinf(depth) ? 0.0 : 1.0;
#endif
  return taps > 0 ? sum : texelFetch(color_image, pixel, 0);
}
