// The first soft layer with constant opacity over what is behind it.
#include "bindings.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D layer_color;
layout(binding = UNIT_INPUT + 1) uniform sampler2D layer_depth;
layout(binding = UNIT_INPUT + 2) uniform sampler2D behind_color;
layout(binding = UNIT_INPUT + 3) uniform sampler2D behind_depth;

uniform float opacity;

bool filter_pixel(ivec2 pixel) {
  vec4 behind = texelFetch(behind_color, pixel, 0);
  bool in_front = texelFetch(layer_depth, pixel, 0).x < texelFetch(behind_depth, pixel, 0).x;
  vec4 layer = in_front ? opacity * texelFetch(layer_color, pixel, 0) : vec4(0.0);
  out_0 = layer + (1.0 - layer.a) * behind;
  return true;
}
