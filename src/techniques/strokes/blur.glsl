// One direction of the weighted Gaussian blur that softens strokes while the picture moves (dos Anjos 2017,
// Sec. 3.3): neighbours count by their distance on the screen and, so that silhouettes stay, in depth.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D albedo;
layout(binding = UNIT_INPUT + 1) uniform sampler2D normals;
layout(binding = UNIT_INPUT + 2) uniform sampler2D depths;
uniform ivec2 direction;
uniform float sigma;   // px
uniform float reach;   // px at the depth of the pixel: how far behind or before a neighbour may be

bool filter_pixel(ivec2 pixel) {
  float depth = texelFetch(depths, pixel, 0).x;
  out_0 = texelFetch(albedo, pixel, 0);
  out_1 = texelFetch(normals, pixel, 0);
  if (out_0.a <= 0.0 || sigma <= 0.0) return true;
  vec4 color = vec4(0.0), normal = vec4(0.0);
  float sum = 0.0, scale = pixels_at(depth) / reach;
  ivec2 last = textureSize(albedo, 0) - 1;
  int radius = int(ceil(2.5 * sigma));
  for (int k = -radius; k <= radius; ++k) {
    ivec2 at = clamp(pixel + k * direction, ivec2(0), last);
    vec4 other = texelFetch(albedo, at, 0);
    if (other.a <= 0.0) continue;
    float apart = (texelFetch(depths, at, 0).x - depth) * scale;
    float weight = exp(-0.5 * (float(k * k) / (sigma * sigma) + apart * apart));
    color += weight * other;
    normal += weight * texelFetch(normals, at, 0);
    sum += weight;
  }
  out_0 = color / sum;
  float size = length(normal.xyz);
  out_1 = vec4(size > 1e-3 * sum ? normal.xyz / size : vec3(0.0), normal.w / sum);
  return true;
}
