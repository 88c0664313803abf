// Eye depth from the bits that atomicMin left, +inf where nothing.
#include "bindings.glsl"

layout(binding = UNIT_INPUT) uniform usampler2D depth_bits;

bool filter_pixel(ivec2 pixel) {
  uint bits = texelFetch(depth_bits, pixel, 0).x;
  out_0 = vec4(bits == 0xffffffffu ? uintBitsToFloat(0x7f800000u) : uintBitsToFloat(bits));
  return true;
}
