// Deferred shading: albedo, depth and normal of a pixel to its colour.
#include "frame.glsl"
#include "color.glsl"
#include "lighting.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D albedo_image;
layout(binding = UNIT_INPUT + 1) uniform sampler2D depth_image;
layout(binding = UNIT_INPUT + 2) uniform sampler2D normal_image;

uniform int shading;  // 0 lit, 1 albedo, 2 normals, 3 depth; else as albedo

bool filter_pixel(ivec2 pixel) {
  vec4 albedo = texelFetch(albedo_image, pixel, 0);
  if (albedo.a <= 0.0) {
    out_0 = vec4(0.0);
    return true;
  }
  vec3 base = albedo.rgb / albedo.a;
  float depth = texelFetch(depth_image, pixel, 0).x;
  vec4 normal = texelFetch(normal_image, pixel, 0);
  vec3 color = base;
  if (shading == 0) {
    vec3 eye = eye_from_pixel(vec2(pixel) + 0.5, depth);
    vec3 normal_eye = mat3(frame.eye_from_cloud) * normal.xyz;
    color = lit_color(base, eye, normal_eye, to_camera(eye), normal.w);
  } else if (shading == 2) {
    color = linear_from_srgb(dot(normal.xyz, normal.xyz) > 0.25 ? normal.xyz * 0.5 + 0.5 : vec3(0.5));
  } else if (shading == 3) {
    // Near is light, far is dark, evenly spaced for the eye.
    float near_to_far = (depth - frame.near_plane) / (frame.far_plane - frame.near_plane);
    color = linear_from_srgb(vec3(clamp(1.0 - near_to_far, 0.0, 1.0)));
  }
  out_0 = vec4(color * albedo.a, albedo.a);
  return true;
}
