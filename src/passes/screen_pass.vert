// One triangle that covers the whole image, or a square point over every tile that is on (Tiles in screen_pass.h).
#include "bindings.glsl"

layout(binding = UNIT_TILES) uniform sampler2D screen_tiles;
uniform int screen_tile_size;  // px; 0: the whole image

void main() {
  gl_PointSize = max(float(screen_tile_size), 1.0);
  if (screen_tile_size == 0) {
    vec2 corner = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2);
    gl_Position = vec4(corner * 2.0 - 1.0, 0.0, 1.0);
    return;
  }
  // The viewport is the tiled area: a point whose centre is outside would be dropped as a whole.
  ivec2 count = textureSize(screen_tiles, 0);
  ivec2 tile = ivec2(gl_VertexID % count.x, gl_VertexID / count.x);
  bool on = texelFetch(screen_tiles, tile, 0).x > 0.0;
  gl_Position = on ? vec4((vec2(tile) + 0.5) / vec2(count) * 2.0 - 1.0, 0.0, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
}
