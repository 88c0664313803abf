// What strokes leave open within a surface: paint around it on opposite sides, in a line that goes on in depth. Beyond an
// outline there is paint on one side only, so outlines stay where they are. So do bays between parts that stick out: of four
// lines at most one may lead to the background, and that only along a slit, which two others cross within a stroke's width.
//
// A second pass (`teeth`) closes what the first leaves between places that it closed: along the ragged end of a surface
// every other row has a slit too wide for it, and a comb shows worse than the slit. It looks for gaps of up to three pixels in
// paint that goes on in depth, on two lines.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D albedo;   // premultiplied
layout(binding = UNIT_INPUT + 1) uniform sampler2D depths;
layout(binding = UNIT_INPUT + 2) uniform sampler2D normals;
uniform bool teeth;
uniform int reach;            // px: half the width of a stroke
uniform float spacing;        // of the points, scene units: sparse ones leave larger gaps
const int most_reach = 24;

struct Side {
  vec4 color, normal;
  float depth;
  int away;   // px; 0: nothing near enough, -1: the picture ends before
  bool open;  // no paint as far as one looks
};

// The nearest pixel that is mostly paint.
Side look(ivec2 pixel, ivec2 direction, ivec2 size) {
  Side side = Side(vec4(0.0), vec4(0.0), 0.0, 0, true);
  for (int k = 1; k <= most_reach; k += k < 8 ? 1 : 2) {
    ivec2 at = pixel + k * direction;
    if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, size))) {
      side.away = -1;
      side.open = false;
      return side;
    }
    vec4 color = texelFetch(albedo, at, 0);
    if (color.a < 0.7) continue;
    side.open = false;
    float depth = texelFetch(depths, at, 0).x;
    if (k <= max(reach, int(2.5 * spacing * pixels_at(depth)))) side = Side(color / color.a, texelFetch(normals, at, 0), depth, k, false);
    return side;
  }
  return side;
}

bool filter_pixel(ivec2 pixel) {
  out_0 = texelFetch(albedo, pixel, 0);
  out_1 = texelFetch(depths, pixel, 0);
  out_2 = texelFetch(normals, pixel, 0);
  if (out_0.a >= 0.98) return true;
  ivec2 size = textureSize(albedo, 0);
  vec4 color = vec4(0.0), normal = vec4(0.0);
  float sum = 0.0, depth = 0.0;
  int closed = 0;  // of the four lines; one may lead outside
  int short_lines = 0;
  bool whole = false;
  int open = 0;
  for (int k = 0; k < 4; ++k) {
    ivec2 direction = ivec2[4](ivec2(1, 0), ivec2(0, 1), ivec2(1, 1), ivec2(1, -1))[k];
    Side a = look(pixel, direction, size), b = a;
    if (!a.open) b = look(pixel, -direction, size);
    open += int(a.open || b.open);
    if (open > int(!teeth)) return true;
    if (a.away == 0 || b.away == 0 || (a.away < 0 && b.away < 0)) continue;
    whole = whole || (a.away > 0 && b.away > 0);
    if (teeth && min(a.away, b.away) < 0) continue;
    if (a.away < 0) a = b;
    if (b.away < 0) b = a;
    // Steeper than 4 to 1 is another surface; a slit of less than 4 pixels is hardly ever a gap between two. One no wider than
    // a stroke, which two lines cross, is closed by the farther side: what is painted first goes on behind what stands
    // before it. In a corner only one line is short.
    float steepness = abs(a.depth - b.depth) * pixels_at(min(a.depth, b.depth)) / float(a.away + b.away);
    if (teeth && (a.away + b.away > 4 || steepness > 4.0)) continue;
    bool slit = a.away + b.away <= 4 && steepness < 16.0, narrow = a.away + b.away <= reach + 1;
    if (steepness > 4.0 && !slit && !narrow) continue;
    closed += slit ? 3 : 1;
    short_lines += int(narrow);
    float wa = 1.0 / float(a.away), wb = 1.0 / float(b.away);
    if (steepness > 4.0) wa *= float(a.depth > b.depth), wb *= float(b.depth > a.depth);
    color += wa * a.color + wb * b.color;
    normal += wa * a.normal + wb * b.normal;
    depth += wa * a.depth + wb * b.depth;
    sum += wa + wb;
  }
  if (open > 0 && short_lines < 2) return true;
  if (teeth ? closed < 6 : (closed < 3 && short_lines < 2) || !whole) return true;
  vec4 under = color / sum;
  if (out_0.a <= 0.0) {
    out_1 = vec4(depth / sum);
    float length_ = length(normal.xyz);
    out_2 = vec4(length_ > 1e-3 * sum ? normal.xyz / length_ : vec3(0.0), normal.w / sum);
  }
  out_0 += (1.0 - out_0.a) * under;
  return true;
}
