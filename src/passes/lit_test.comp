// The lit test of every point (Dobrev 2010, Sec. 4): lit = depth_L < map(x,y) + d_min / max(|<v,n>|, c_min).
// The absolute value and the bound are ours: the printed <v,n> = -n_z is negative towards the light and
// unbounded at grazing angles.
//   LAYER    the map is one layer of see-through casters: what they let pass is multiplied into `passed`
//   PASSED   a lit point gets what see-through casters in front of it let pass
#include "frame.glsl"
#include "cloud.glsl"

layout(local_size_x = 128) in;
#ifndef LAYER
layout(r32f, binding = 0) uniform imageBuffer shadow_factor;
uniform float share;   // of this light sample in the average
#else
layout(binding = UNIT_INPUT + 1) uniform sampler2D opacity_map;
#endif
#if defined(LAYER) || defined(PASSED)
layout(r32f, binding = 1) uniform imageBuffer passed;
#endif
layout(binding = UNIT_INPUT) uniform sampler2D light_map;

uniform uint point_count;
uniform float d_min;   // scene units
uniform bool has_normals;

const float c_min = 0.1;

void main() {
  uint index = gl_GlobalInvocationID.x + gl_GlobalInvocationID.y * gl_NumWorkGroups.x * gl_WorkGroupSize.x;
  if (index >= point_count) return;
  int i = int(index);
  vec3 eye = (frame.eye_from_cloud * vec4(point_position(i), 1.0)).xyz;
  float depth = -eye.z;
  if (depth < frame.near_plane) return;  // another face of a light inside the cloud sees it
  vec2 pixel = pixel_from_eye(eye);
  if (any(lessThan(pixel, vec2(0.0))) || any(greaterThanEqual(pixel, frame.image_size))) return;

  vec3 normal = has_normals ? mat3(frame.eye_from_cloud) * point_normal(i) : vec3(0.0);
  // Without a normal, as for a surface tilted by 60 degrees to the light.
  float cosine = dot(normal, normal) > 0.25 ? abs(dot(to_camera(eye), normal)) : 0.5;
  float offset = d_min / max(cosine, c_min);
  bool is_lit = depth < texelFetch(light_map, ivec2(pixel), 0).x + offset;
#ifdef LAYER
  if (!is_lit) imageStore(passed, i, imageLoad(passed, i) * (1.0 - texelFetch(opacity_map, ivec2(pixel), 0).x));
#elif defined(PASSED)
  if (is_lit) imageStore(shadow_factor, i, imageLoad(shadow_factor, i) + share * imageLoad(passed, i));
#else
  if (is_lit) imageStore(shadow_factor, i, vec4(imageLoad(shadow_factor, i).x + share));
#endif
}
