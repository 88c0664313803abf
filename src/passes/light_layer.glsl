// The opacity of one layer of see-through casters, and from which depth on the next one may begin.
#include "frame.glsl"
#include "cloud.glsl"
#include "places.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D depth_image;  // filled
layout(binding = UNIT_INPUT + 1) uniform usampler2D index_image;
layout(binding = UNIT_INPUT + 2) uniform sampler2D state_image;  // limit, light that got as far as here
layout(r32ui, binding = 7) writeonly uniform uimage2D open_flag;

uniform bool has_normals;
uniform float d_min;

const float c_min = 0.1, unknown_cosine = 0.5;  // as in the lit test

bool filter_pixel(ivec2 pixel) {
  uint source = texelFetch(index_image, pixel, 0).x;
  vec2 state = texelFetch(state_image, pixel, 0).xy;
  out_0 = vec4(infinity, state.y, 0.0, 0.0);
  out_1 = vec4(0.0);
  if (source == 0xffffffffu) return write_background;
  int i = place_in_chunk(source);
  if (i < 0) return false;
  float depth = texelFetch(depth_image, pixel, 0).x, opacity = caster_opacity(i);
  vec3 normal = has_normals ? mat3(frame.eye_from_cloud) * point_normal(i) : vec3(0.0);
  vec3 to_light = to_camera(eye_from_pixel(vec2(pixel) + 0.5, depth));
  float cosine = dot(normal, normal) > 0.25 ? abs(dot(to_light, normal)) : unknown_cosine;
  float limit = max(state.x, depth + d_min / max(cosine, c_min)), passed = state.y * (1.0 - opacity);
  if (passed < 1.0 / 256.0) limit = infinity;  // darker makes no difference
  if (!isinf(limit)) imageStore(open_flag, ivec2(0), uvec4(1u));
  out_0 = vec4(limit, passed, 0.0, 0.0);
  out_1 = vec4(opacity);
  return true;
}
