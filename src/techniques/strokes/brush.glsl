// The brush as a picture: `tiles` x `tiles` variants that differ in how their columns turn. STEP 0 writes alpha and
// the height of the paint, STEP 1 adds the slopes of the height.
#include "bindings.glsl"
#include "techniques/strokes/noise.glsl"

#if STEP == 0
uniform int brush_kind;         // 0 Gaussians, 1 ellipse
uniform ivec2 brush_grid;       // columns, rows
uniform float amplitude;        // A
uniform float center_separation;  // dev
uniform float shape_exponent;   // lambda
uniform vec2 sigma;
uniform float noise;            // radians
uniform float bristles;
uniform int tile_size;

bool filter_pixel(ivec2 pixel) {
  ivec2 tile = pixel / tile_size;
  uint variant = uint(tile.x + 8 * tile.y);
  vec2 uv = (vec2(pixel - tile * tile_size) + 0.5) / float(tile_size);
  float z = 0.0;
  if (brush_kind == 1) {
    vec2 at = (uv - 0.5) / (2.0 * sigma);
    z = dot(at, at) < 1.0 ? 1.0 : 0.0;
  } else {
    float theta = 0.0;
    for (int column = 0; column < brush_grid.x; ++column) {
      // Each column turns a little further than the one before it.
      theta += noise * (2.0 * unit_from_hash(hash_of(uvec3(variant, uint(column), 77u))) - 1.0) * (column == 0 ? 0.0 : 1.0);
      float s = sin(theta), c = cos(theta);
      for (int row = 0; row < brush_grid.y; ++row) {
        vec2 centre = 0.5 + (vec2(column, row) - 0.5 * vec2(brush_grid - 1)) * center_separation;
        vec2 d = uv - centre;
        vec2 turned = abs(vec2(c * d.x - s * d.y, s * d.x + c * d.y)) / sigma;
        // z = A exp(-1/2 |x/sigma_x|^lambda) exp(-1/2 |y/sigma_y|^lambda) (dos Anjos 2017, Sec. 3.2)
        vec2 power = pow(max(turned, 1e-6), vec2(shape_exponent));
        z += amplitude * exp(-0.5 * (power.x + power.y));
      }
    }
  }
  float streak = 0.0;
  if (bristles > 0.0) {
    float fine = smooth_noise(vec2(2.5 * uv.x, 26.0 * uv.y), variant), wide = smooth_noise(vec2(1.5 * uv.x, 9.0 * uv.y), variant + 64u);
    streak = 0.6 * fine + 0.4 * wide;
  }
  // A streak takes paint away where there is little of it: at the ends and the rims.
  float alpha = clamp(z * (1.0 - bristles * smoothstep(0.35, 0.75, streak)), 0.0, 1.0);
  out_0 = vec4(alpha, alpha * (1.0 - 0.6 * bristles * streak), 0.0, 0.0);
  return true;
}
#else
layout(binding = UNIT_INPUT) uniform sampler2D plain;
bool filter_pixel(ivec2 pixel) {
  ivec2 last = textureSize(plain, 0) - 1;
  vec4 here = texelFetch(plain, pixel, 0);
  float left = texelFetch(plain, max(pixel - ivec2(1, 0), ivec2(0)), 0).y, right = texelFetch(plain, min(pixel + ivec2(1, 0), last), 0).y;
  float above = texelFetch(plain, max(pixel - ivec2(0, 1), ivec2(0)), 0).y, below = texelFetch(plain, min(pixel + ivec2(0, 1), last), 0).y;
  out_0 = vec4(here.xy, 0.5 * (right - left), 0.5 * (below - above));
  return true;
}
#endif
