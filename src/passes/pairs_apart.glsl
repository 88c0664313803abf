// Depth bits and source index of each pixel, from the pairs that one visit of all points left. Makes room for the next.
layout(std430, binding = 0) buffer Nearest { uvec2 nearest[]; };  // source index, depth bits; row by row
uniform int columns;

bool filter_pixel(ivec2 pixel) {
  int at = pixel.y * columns + pixel.x;
  uvec2 pair = nearest[at];
  out_0 = uvec4(pair.y);
  out_1 = uvec4(pair.x);
  nearest[at] = uvec2(0xffffffffu);
  return true;
}
