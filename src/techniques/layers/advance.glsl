// The end of a layer: BLEND it under the layers in front, its edges antialiased, and say from which depth on the
// next layer may begin.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D depth_image;   // filled
layout(binding = UNIT_INPUT + 1) uniform sampler2D limit_image;
#ifdef BLEND
layout(binding = UNIT_INPUT + 2) uniform sampler2D color_image;
layout(binding = UNIT_INPUT + 3) uniform sampler2D front_image;
uniform bool antialias;
#endif
#ifdef SCALE_BY_ANGLE
layout(binding = UNIT_INPUT + 4) uniform sampler2D cosine_image;  // |n.v|
const float c_min = 0.1;
#endif
layout(r32ui, binding = 7) writeonly uniform uimage2D open_flag;

uniform float d_min;
uniform float bin;  // power of two, at most d_min / 2

#ifdef BLEND
float depth_at(ivec2 at) {
  bool is_inside = all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, textureSize(depth_image, 0)));
  return is_inside ? texelFetch(depth_image, at, 0).x : infinity;
}

// A pixel is marked when one of its four neighbours lies more than d_min nearer or farther (background: infinitely
// far), and then replaced by the Gaussian of its 3 x 3 pixels, background included.
vec4 antialiased(ivec2 pixel, float depth) {
  vec4 color = texelFetch(color_image, pixel, 0);
  if (!antialias) return color;
  bool is_marked = false;
  const ivec2 cross_of_four[4] = ivec2[4](ivec2(1, 0), ivec2(-1, 0), ivec2(0, 1), ivec2(0, -1));
  for (int k = 0; k < 4; ++k) {
    float neighbor = depth_at(pixel + cross_of_four[k]);
    // Not the absolute difference: infinity minus infinity is no jump.
    is_marked = is_marked || max(depth, neighbor) > min(depth, neighbor) + d_min;
  }
  if (!is_marked) return color;
  vec4 sum = vec4(0.0);
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) {
      ivec2 at = pixel + ivec2(x, y);
      float weight = (x == 0 ? 2.0 : 1.0) * (y == 0 ? 2.0 : 1.0) / 16.0;
      if (!isinf(depth_at(at))) sum += weight * texelFetch(color_image, at, 0);
    }
  return sum;
}
#endif

bool filter_pixel(ivec2 pixel) {
  float depth = texelFetch(depth_image, pixel, 0).x;
  float gap = d_min;
#ifdef SCALE_BY_ANGLE
  gap /= max(texelFetch(cosine_image, pixel, 0).x, c_min);
#endif
  // Never back towards the eye: filling may have taken a depth from in front of this pixel's last layer.
  // Rounded up to a bin, so that a cascade that keeps one point of a bin finds the same layers as passes; exact.
  float limit = max(texelFetch(limit_image, pixel, 0).x, ceil((depth + gap) / bin) * bin);
#ifdef BLEND
  // C += T a c, T *= 1 - a, front to back (Dobrev 2010, Sec. 3); T is 1 - alpha of the front.
  vec4 front = texelFetch(front_image, pixel, 0);
  front += (1.0 - front.a) * antialiased(pixel, depth);
  front.a = min(front.a, 1.0);
  out_1 = front;
  // What shines through changes no 8-bit value any more.
  if (1.0 - front.a < 1e-3) limit = infinity;
#endif
  out_0 = vec4(limit);
  if (!isinf(limit)) imageStore(open_flag, ivec2(0), uvec4(1u));
  return true;
}
