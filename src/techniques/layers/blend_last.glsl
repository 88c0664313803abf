// Blends a layer under those in front of it, opaque where no other layer follows: there is nothing to see
// through to. Edges within the picture go over from one to the other, and the outline of the first layer is
// that of the picture.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D depth_image;  // filled
layout(binding = UNIT_INPUT + 1) uniform sampler2D color_image;
layout(binding = UNIT_INPUT + 2) uniform sampler2D front_image;
layout(binding = UNIT_INPUT + 3) uniform sampler2D coverage_image;  // of the first layer
layout(binding = UNIT_INPUT + 4) uniform sampler2D next_coverage_image;
layout(binding = UNIT_INPUT + 5) uniform sampler2D shape_image;

uniform bool is_followed;  // somewhere: next_coverage_image says where
uniform bool ends;         // no other layer follows this one

#define COVERED
#include "techniques/layers/antialiased.glsl"

bool filter_pixel(ivec2 pixel) {
  float depth = texelFetch(depth_image, pixel, 0).x, covered;
  vec4 front = texelFetch(front_image, pixel, 0), color = antialiased(pixel, depth, covered);
  if (color.a > 0.0) {
    float next = is_followed ? texelFetch(next_coverage_image, pixel, 0).x : 0.0;
    front += (1.0 - front.a) * mix(1.0, color.a / covered, next) * (color / color.a);
    front.a = min(front.a, 1.0);
  }
  out_0 = ends ? front * texelFetch(coverage_image, pixel, 0).x : front;
  return true;
}
