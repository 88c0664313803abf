// The view: spaces and how to move between them.
//   cloud: world minus the cloud's origin        eye: camera at 0, +x right, +y up, looks down -z
//   pixel: x right, y down, centres at half integers, first row on top
// Eye depth z_e = -z is positive in front of the camera. t = Euclidean distance along the ray of a pixel.
#include "bindings.glsl"

layout(std140, binding = BLOCK_FRAME) uniform Frame {
  mat4 eye_from_cloud;
  mat4 cloud_from_eye;
  mat4 clip_from_eye;   // y down: row 0 of the image is on top
  vec4 intrinsics;      // fx fy cx cy, px of the whole picture
  vec2 image_size;      // px
  float near_plane;
  float far_plane;      // eye depth
  int orthographic;
  float pixels_per_unit;  // at eye depth 1 (perspective), anywhere (orthographic)
  // Of a tile of a larger picture. Whole numbers, taken off last and put on first: every float is that of the whole.
  vec2 tile_origin;     // px of the whole picture
  vec2 picture_size;    // of the whole
} frame;

// Scene units to pixels at this eye depth.
float pixels_at(float depth) { return frame.orthographic != 0 ? frame.pixels_per_unit : frame.pixels_per_unit / depth; }

vec2 pixel_from_eye(vec3 eye) {
  float w = frame.orthographic != 0 ? 1.0 : -eye.z;
  return vec2(frame.intrinsics.x * eye.x, -frame.intrinsics.y * eye.y) / w + frame.intrinsics.zw - frame.tile_origin;
}

// Eye position of a pixel position at an eye depth.
vec3 eye_from_pixel(vec2 pixel, float depth) {
  vec2 slope = (pixel + frame.tile_origin - frame.intrinsics.zw) / vec2(frame.intrinsics.x, -frame.intrinsics.y);
  return vec3(frame.orthographic != 0 ? slope : slope * depth, -depth);
}

// Origin and unit direction of the ray through a pixel position; t along it is a distance in scene units.
vec3 ray_origin(vec2 pixel) {
  return frame.orthographic != 0 ? eye_from_pixel(pixel, 0.0) : vec3(0.0);
}
vec3 ray_direction(vec2 pixel) {
  return frame.orthographic != 0 ? vec3(0.0, 0.0, -1.0) : normalize(eye_from_pixel(pixel, 1.0));
}

// Unit vector from an eye position towards the camera.
vec3 to_camera(vec3 eye) { return frame.orthographic != 0 ? vec3(0.0, 0.0, 1.0) : normalize(-eye); }

#define infinity uintBitsToFloat(0x7f800000u)  // no constant to every compiler
