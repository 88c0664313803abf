// Normals of one push level: the cross product of neighbouring positions (Bouchiba 2018, Sec. 3.3), eye space.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D filled_a;

uniform int level;

vec3 position(ivec2 at) {
  return eye_from_pixel((vec2(at) + 0.5) * float(1 << level), texelFetch(filled_a, at, 0).x);
}

// The slope to both sides; next to a depth edge the flatter side counts more, so that edges do not turn into walls.
vec3 slope(ivec2 at, ivec2 along, vec3 here, ivec2 size) {
  vec3 forward = vec3(0.0), backward = vec3(0.0);
  bool has_forward = all(lessThan(at + along, size)), has_backward = all(greaterThanEqual(at - along, ivec2(0)));
  if (has_forward) forward = position(at + along) - here;
  if (has_backward) backward = here - position(at - along);
  float scale = 0.25 * max(dot(forward.xy, forward.xy), dot(backward.xy, backward.xy));
  float forward_weight = has_forward ? 1.0 / (forward.z * forward.z + scale) : 0.0;
  float backward_weight = has_backward ? 1.0 / (backward.z * backward.z + scale) : 0.0;
  return forward * forward_weight + backward * backward_weight;
}

bool filter_pixel(ivec2 pixel) {
  ivec2 size = textureSize(filled_a, 0);
  vec3 here = position(pixel);
  vec3 normal = cross(slope(pixel, ivec2(0, 1), here, size), slope(pixel, ivec2(1, 0), here, size));
  float len = length(normal);
  out_0 = vec4(len > 0.0 ? normal / len : vec3(0.0), 0.0);
  return true;
}
