// What the colour of a pixel shows, shared by every pass that turns albedo, depth and normal into colour.
#include "frame.glsl"
#include "color.glsl"
#include "lighting.glsl"

// Software GL computes every branch: who can make a program for each shading defines SHADING.
#ifdef SHADING
const int shading = SHADING;
#else
uniform int shading;  // 0 lit, 1 albedo, 2 normals, 3 depth; else as albedo
#endif

// Colours that stand for categories, linear: a mean of two would be that of a third, or of none.
uniform int palette_size;  // 0: colours blend
uniform vec3 palette[64];  // RenderSettings::palette_limit

// Place in the palette; -1 when there is none.
int nearest_place(vec3 color) {
  float least = infinity;
  int nearest = -1;
  for (int k = 0; k < palette_size; ++k) {
    vec3 away = palette[k] - color;
    if (dot(away, away) < least) least = dot(away, away), nearest = k;
  }
  return nearest;
}

vec3 nearest_category(vec3 color) {
  int place = nearest_place(color);
  return place < 0 ? color : palette[place];
}

// `albedo` is premultiplied; `normal`: world normal or 0, shadow factor in w.
vec4 shaded_color(vec4 albedo, vec2 pixel, float depth, vec4 normal) {
  if (albedo.a <= 0.0) return vec4(0.0);
  vec3 color = albedo.rgb / albedo.a;
  if (shading == 0) {
    vec3 eye = eye_from_pixel(pixel, depth);
    vec3 normal_eye = mat3(frame.eye_from_cloud) * normal.xyz;
    color = lit_color(color, eye, normal_eye, to_camera(eye), normal.w);
  } else if (shading == 2) {
    color = linear_from_srgb(dot(normal.xyz, normal.xyz) > 0.25 ? normal.xyz * 0.5 + 0.5 : vec3(0.5));
  } else if (shading == 3) {
    // Near is light, far is dark, evenly spaced for the eye.
    float near_to_far = (depth - frame.near_plane) / (frame.far_plane - frame.near_plane);
    color = linear_from_srgb(vec3(clamp(1.0 - near_to_far, 0.0, 1.0)));
  }
  return vec4(color * albedo.a, albedo.a);
}
