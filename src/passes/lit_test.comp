// The lit test of every point (Dobrev 2010, Sec. 4): lit = depth_L < map(x,y) + d_min / max(|<v,n>|, c_min).
// The absolute value and the bound are ours: the printed <v,n> = -n_z is negative towards the light and
// unbounded at grazing angles.
#include "frame.glsl"
#include "cloud.glsl"

layout(local_size_x = 128) in;
layout(r32f, binding = 0) uniform imageBuffer shadow_factor;
layout(binding = UNIT_INPUT) uniform sampler2D light_map;

uniform uint point_count;
uniform float d_min;   // scene units
uniform float share;   // of this light sample in the average
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
  if (depth < texelFetch(light_map, ivec2(pixel), 0).x + offset)
    imageStore(shadow_factor, i, vec4(imageLoad(shadow_factor, i).x + share));
}
