// The primitive over the pixels [first, last] of a splat: a point sprite, or two triangles (SPLAT_QUADS).
#include "frame.glsl"

void place_nothing() {
  gl_PointSize = 1.0;
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);  // outside
}

void place_primitive(ivec2 first, ivec2 last) {
  vec2 low = vec2(first), high = vec2(last + 1);
#ifdef SPLAT_QUADS
  int corner = gl_VertexID % 6;
  vec2 at = vec2(corner == 1 || corner == 2 || corner == 4 ? high.x : low.x,
                 corner == 2 || corner == 4 || corner == 5 ? high.y : low.y);
#else
  // A square around the box; its centre must stay on the image, or the point is clipped as a whole.
  vec2 extent = high - low;
  float size = max(extent.x, extent.y);
  vec2 corner = max(min(low, frame.image_size - size), 0.0);
  vec2 at = min(corner + 0.5 * size, frame.image_size);
  vec2 reach = max(at - low, high - at);
  gl_PointSize = 2.0 * max(reach.x, reach.y);
#endif
  gl_Position = vec4(at / frame.image_size * 2.0 - 1.0, 0.0, 1.0);
}
