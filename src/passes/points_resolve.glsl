// Attributes of the point that each pixel kept.
#include "frame.glsl"
#include "cloud.glsl"
#include "places.glsl"

layout(binding = UNIT_INPUT) uniform usampler2D depth_bits;
layout(binding = UNIT_INPUT + 1) uniform usampler2D source_index;

#ifdef WRITE_EYE
uniform float same_spacing;  // of all points, scene units; 0: that of each one's batch
uniform int batch_count;

// Spacing of the point's batch, found among the visible ones, which ascend.
float spacing_at(int i) {
  int low = 0, high = batch_count - 1;
  while (low < high) {
    int middle = (low + high + 1) / 2;
    if (visible_batch(uint(middle)).first <= i) low = middle;
    else high = middle - 1;
  }
  return spacing_in(uint(low), visible_batch(uint(low)), point_position(i));
}
#endif

bool filter_pixel(ivec2 pixel) {
  uint source = texelFetch(source_index, pixel, 0).x;
#ifdef WRITE_EYE
  out_0 = vec4(0.0, 0.0, 0.0, 1.0);
  out_1 = vec4(0.0, 0.0, -3e38, 0.0);
  if (source == 0xffffffffu) return write_background;
  int place = place_in_chunk(source);
  if (place < 0) return false;
  out_0.rgb = point_color(place);
#ifdef HAS_SHADOW
  out_0.a = point_shadow(place);
#endif
  out_1 = vec4((frame.eye_from_cloud * vec4(point_position(place), 1.0)).xyz, same_spacing > 0.0 ? same_spacing : spacing_at(place));
  return true;
#else
  if (source == 0xffffffffu) {
    out_0 = vec4(0.0);
    out_1 = vec4(infinity);
#ifdef WRITE_NORMAL
    out_2 = vec4(0.0, 0.0, 0.0, 1.0);
#endif
    return write_background;
  }
  int i = place_in_chunk(source);
  if (i < 0) return false;
  float depth = uintBitsToFloat(texelFetch(depth_bits, pixel, 0).x);
  out_0 = vec4(point_color(i), 1.0);
  out_1 = vec4(depth);
#ifdef WRITE_NORMAL
  out_2 = vec4(0.0, 0.0, 0.0, 1.0);
#ifdef HAS_NORMALS
  vec3 normal = point_normal(i);
  vec3 eye_normal = mat3(frame.eye_from_cloud) * normal;
  vec3 eye = eye_from_pixel(vec2(pixel) + 0.5, depth);
  out_2.xyz = dot(eye_normal, to_camera(eye)) < 0.0 ? -normal : normal;  // unoriented: towards the camera
#endif
#ifdef HAS_SHADOW
  out_2.w = point_shadow(i);
#endif
#endif
  return true;
#endif
}
