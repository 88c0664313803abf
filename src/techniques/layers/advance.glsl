// The end of a layer: BLEND it under the layers in front, its edges antialiased, and say from which depth on
// the next layer may begin.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D depth_image;   // filled
layout(binding = UNIT_INPUT + 1) uniform sampler2D limit_image;
layout(binding = UNIT_INPUT + 2) uniform sampler2D shape_image;  // light.glsl
#ifdef BLEND
layout(binding = UNIT_INPUT + 3) uniform sampler2D color_image;
layout(binding = UNIT_INPUT + 4) uniform sampler2D front_image;
#endif
#ifdef SCALE_BY_ANGLE
const float c_min = 0.1;
#endif
layout(r32ui, binding = 7) writeonly uniform uimage2D open_flag;

uniform float bin;  // power of two, at most half of what no layer is thinner than

#ifdef BLEND
#include "techniques/layers/antialiased.glsl"
#endif

// The next float: what a thickness is too small to be added to, 0 among it, still leaves this layer behind.
float beyond(float depth) { return isinf(depth) ? depth : uintBitsToFloat(floatBitsToUint(depth) + 1u); }

bool filter_pixel(ivec2 pixel) {
  float depth = texelFetch(depth_image, pixel, 0).x;
  vec2 shape = texelFetch(shape_image, pixel, 0).xy;
  float gap = shape.y;
#ifdef SCALE_BY_ANGLE
  gap /= max(shape.x, c_min);
#endif
  // Never back towards the eye: filling may have taken a depth from in front of this pixel's last layer.
  // Rounded up to a bin, so that a cascade that keeps one point of a bin finds the same layers as passes;
  // exact.
  float limit = max(texelFetch(limit_image, pixel, 0).x, max(ceil((depth + gap) / bin) * bin, beyond(depth)));
#ifdef BLEND
  // C += T a c, T *= 1 - a, front to back (Dobrev 2010, Sec. 3); T is 1 - alpha of the front.
  vec4 front = texelFetch(front_image, pixel, 0);
  float covered;
  front += (1.0 - front.a) * antialiased(pixel, depth, covered);
  front.a = min(front.a, 1.0);
  out_1 = front;
  // What shines through changes no 8-bit value any more.
  if (1.0 - front.a < 1e-3) limit = infinity;
#endif
  out_0 = vec4(limit);
  if (!isinf(limit)) imageStore(open_flag, ivec2(0), uvec4(1u));
  return true;
}
