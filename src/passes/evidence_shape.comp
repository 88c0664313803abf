// The complex of evidence.h as pixels: of three pixels that touch each other the nearest points are a
// triangle of Delaunay, or coincide, because pixels are a triangulation of the plane; but where four points
// lie on nearly one circle, or cells of the Voronoi diagram are thinner than a pixel.
#include "bindings.glsl"
#include "work_groups.glsl"

layout(local_size_x = 16, local_size_y = 8) in;
layout(binding = UNIT_INPUT) uniform usampler2D nearest;  // pixel of the nearest point x | y << 16, or ~0
layout(r32ui, binding = 0) uniform uimage2D shape;  // of_edge | of_triangle
uniform float radius;  // px: of the largest circle around an edge or triangle

const uint of_edge = 1u, of_triangle = 2u, none = 0xffffffffu;

ivec2 place(uint point) { return ivec2(point & 0xffffu, point >> 16); }
int cross2(ivec2 a, ivec2 b) { return a.x * b.y - a.y * b.x; }
float squared(ivec2 a) { return float(a.x * a.x + a.y * a.y); }
int extent(ivec2 a) { return max(abs(a.x), abs(a.y)); }
void add(ivec2 at, uint part) { imageAtomicOr(shape, at, part); }

void add_line(ivec2 a, ivec2 b, uint part) {
  ivec2 along = b - a;
  int steps = extent(along);
  // Halves are rounded up, whichever end is first.
  for (int k = 1; k < steps; ++k)
    add(a - steps + (2 * (along * k + steps * steps) + steps) / (2 * steps), part);
}

// An edge whose smallest circle is around `middle`, doubled.
void add_edge(ivec2 a, ivec2 b, ivec2 middle) {
  if (extent(a + b - middle) <= 2 && squared(b - a) <= 4.0 * (radius * radius)) add_line(a, b, of_edge);
}

void add_triangle(ivec2 a, ivec2 b, ivec2 c) {
  int area = cross2(b - a, c - a);  // twice
  if (area == 0) return;
  precise float ab = squared(b - a), bc = squared(c - b), ca = squared(a - c), longest = max(ab, max(bc, ca));
  // Around an obtuse one that of its longest side, else that through all three, whose radius is the product
  // of the sides divided by four times the area.
  bool is_obtuse = 2.0 * longest > ab + bc + ca;
  precise float sides = ab * bc * ca, most = 4.0 * (radius * radius) * (float(area) * float(area));
  if (is_obtuse ? longest > 4.0 * (radius * radius) : sides > most) return;
  add_line(a, b, of_triangle);
  add_line(b, c, of_triangle);
  add_line(c, a, of_triangle);
  ivec2 low = min(a, min(b, c)), high = max(a, max(b, c));
  int turn = area < 0 ? -1 : 1;
  for (int y = low.y; y <= high.y; ++y)
    for (int x = low.x; x <= high.x; ++x) {
      ivec2 p = ivec2(x, y);
      if (turn * cross2(b - a, p - a) >= 0 && turn * cross2(c - b, p - b) >= 0 &&
          turn * cross2(a - c, p - c) >= 0)
        add(p, of_triangle);
    }
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.x, group_row() * 8u + gl_LocalInvocationID.y);
  if (any(greaterThanEqual(pixel + 1, textureSize(nearest, 0)))) return;
  uint here = texelFetch(nearest, pixel, 0).x, right = texelFetch(nearest, pixel + ivec2(1, 0), 0).x,
       below = texelFetch(nearest, pixel + ivec2(0, 1), 0).x, opposite = texelFetch(nearest, pixel + 1, 0).x;
  if (here == uint(pixel.x | pixel.y << 16)) add(pixel, of_edge);
  bool is_inside = here == right && here == below && here == opposite;
  if (is_inside || right == none || below == none) return;
  ivec2 a = place(right), b = place(below);
  if (here != none) {
    add_triangle(place(here), a, b);
    add_edge(place(here), a, 2 * pixel + ivec2(1, 0));
    add_edge(place(here), b, 2 * pixel + ivec2(0, 1));
  }
  if (opposite != none) add_triangle(place(opposite), a, b);
}
