// Colour, opacity and normal of the point that each pixel of a layer took.
#include "frame.glsl"
#include "cloud.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D depth_image;
layout(binding = UNIT_INPUT + 1) uniform usampler2D index_image;
layout(binding = UNIT_PLACES) uniform usamplerBuffer places;

uniform uint chunk_first;
uniform uint chunk_count;
uniform bool write_background;
#ifndef HAS_OPACITY
uniform float opacity;
#endif

bool filter_pixel(ivec2 pixel) {
  uint source = texelFetch(index_image, pixel, 0).x;
  out_0 = vec4(0.0);
  out_1 = vec4(0.0, 0.0, 0.0, 1.0);
  if (source == 0xffffffffu) return write_background;
  uint place = texelFetch(places, int(source)).x - chunk_first;
  if (place >= chunk_count) return false;
  int i = int(place);
#ifdef HAS_OPACITY
  float opacity = point_field(i);
#endif
  out_0 = vec4(point_color(i) * opacity, opacity);
#ifdef HAS_NORMALS
  vec3 normal = point_normal(i);
  vec3 eye = eye_from_pixel(vec2(pixel) + 0.5, texelFetch(depth_image, pixel, 0).x);
  bool faces = dot(mat3(frame.eye_from_cloud) * normal, to_camera(eye)) >= 0.0;
  out_1.xyz = faces ? normal : -normal;  // unoriented: towards the camera
#endif
#ifdef HAS_SHADOW
  out_1.w = point_shadow(i);
#endif
  return true;
}
