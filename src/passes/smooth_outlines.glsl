// Outlines and edges in depth without stairs: morphological antialiasing (Reshetov 2009, "Morphological Antialiasing"),
// on the edges that depth shows (depth_edges.glsl), so that what is painted on a surface stays sharp.
//
// An edge between two rows of pixels runs straight until it steps into one of the rows. The outline it stands for passes
// through the middle of each step, and crosses the edge half way between two steps: as far as it reaches into a pixel,
// that pixel takes the colour, and the coverage, of the one across. An edge that steps to one side at one end and to the
// other at the other takes from both as much; one that steps to the same side twice rounds a corner off, which leaves
// little of what is one or two pixels thin: there it stays.
#include "bindings.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D color_image;
layout(binding = UNIT_INPUT + 1) uniform usampler2D edge_image;
layout(binding = UNIT_INPUT + 2) uniform sampler2D depth_image;

const int reach = 12;  // px along an edge; flatter ones keep some of their stairs

ivec2 last_pixel = textureSize(edge_image, 0) - 1;

// Whether there is an edge between a pixel and its neighbour `across`.
bool is_edge(ivec2 pixel, ivec2 across) {
  uint edges = texelFetch(edge_image, clamp(min(pixel, pixel + across), ivec2(0), last_pixel), 0).x;
  return (edges & (across.x != 0 ? 8u : 2u)) != 0u;
}

float depth_at(ivec2 pixel) { return texelFetch(depth_image, clamp(pixel, ivec2(0), last_pixel), 0).x; }

// Where two pixels that touch at a corner are nearer than the two beside them they belong together, as those of a wire
// do: the edge goes on along them. 1/2 where it so steps into the row of `at`, -1/2 into the other, 0 where nobody knows.
float step_at_corner(ivec2 at, ivec2 across, ivec2 way) {
  float ours = depth_at(at), other = depth_at(at + across), next = depth_at(at + way),
        beyond = depth_at(at + across + way);
  if (max(ours, beyond) < min(other, next)) return -0.5;
  return max(other, next) < min(ours, beyond) ? 0.5 : 0.0;
}

// Whether what is one or two pixels thin ends at `at`, instead of going on in the next row, as a wire does. Holes of a
// surface are no such things: they close.
bool is_thin_end(ivec2 at, ivec2 across, ivec2 way) {
  if (depth_at(at) > depth_at(at + across)) return false;
  ivec2 below = at - across;
  if (is_edge(at, -across)) return !is_edge(below, way);
  return is_edge(below, way) && is_edge(below, -across) && !is_edge(below - across, way);
}

// Follows the edge between `pixel` and `across` along `way`. x: how many pixels on it ends, y: 1/2 where it then steps
// into our row, -1/2 into the other, 0 where it does neither or leads beyond our reach.
vec2 end_of_edge(ivec2 pixel, ivec2 across, ivec2 way) {
  // What happens at the end is asked after the loop: inside, all pixels of a group would at every step.
  bool ours = false, other = false;
  int i = 0;
  for (; i < reach; ++i) {
    ivec2 at = pixel + i * way;
    ours = is_edge(at, way), other = is_edge(at + across, way);
    if (ours || other || !is_edge(at + way, across)) break;
  }
  ivec2 at = pixel + i * way;
  float turn = 0.0;
  if (ours != other) turn = !ours ? -0.5 : is_thin_end(at, across, way) ? 0.0 : 0.5;
  else if (ours) turn = step_at_corner(at, across, way);
  return vec2(float(i), turn);
}

// How much of the pixel belongs to the one across: the area between the edge and the outline, which falls from the height
// of each end to 0 half way.
float share_across(ivec2 pixel, ivec2 across) {
  ivec2 way = across.yx;
  vec2 left = end_of_edge(pixel, across, -way), right = end_of_edge(pixel, across, way);
  float middle = 0.5 * (left.x + right.x + 1.0);
  // The pixel reaches from `left.x` to one more, of which each end has the part on its side of the middle.
  float from = min(left.x, middle), to = min(left.x + 1.0, middle);
  float of_left = left.y * (to - from) * (1.0 - 0.5 * (from + to) / middle);
  from = max(left.x, middle), to = max(left.x + 1.0, middle);
  float of_right = right.y * (to - from) * (0.5 * (from + to) / middle - 1.0);
  return max(of_left, 0.0) + max(of_right, 0.0);
}

// In the order of the bits of depth_edges.glsl.
ivec2 side(int k) {
  int way = (k & 1) * 2 - 1;
  return (k >> 1) == 0 ? ivec2(0, way) : ivec2(way, 0);
}

bool filter_pixel(ivec2 pixel) {
  uint sides = texelFetch(edge_image, pixel, 0).x;
  if (sides == 0u) return false;
  out_0 = texelFetch(color_image, pixel, 0);
  vec4 sum = vec4(0.0);
  float shares = 0.0;
  // The sides that have an edge, one after the other: groups of pixels are done at once.
  for (; sides != 0u; sides &= sides - 1u) {
    ivec2 across = side(findLSB(sides));
    float share = share_across(pixel, across);
    sum += share * texelFetch(color_image, pixel + across, 0);
    shares += share;
  }
  if (shares > 1.0) sum /= shares, shares = 1.0;
  if (shares > 0.0) out_0 = (1.0 - shares) * out_0 + sum;
  return true;
}
