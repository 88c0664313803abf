// The lit surface of a layer: colour, opacity and normal of the point that each pixel took.
//   HAS_NORMALS, HAS_SHADOW, HAS_OPACITY   what the cloud has for each point; else one value, or the image
//   WRITE_NORMAL                           somebody reads the normals
//   MERGED                                 points of all parts of a cloud: `index_image` has their pixels
//   CATEGORIES                             colours are those of the palette: which one, beside the shape
//   PLACED_THICKNESS                       layers are as thick as the points of each place ask for
#include "shading.glsl"
#include "cloud.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D depth_image;
layout(binding = UNIT_INPUT + 1) uniform usampler2D index_image;
#ifdef MERGED
layout(binding = UNIT_INPUT + 2) uniform sampler2D colors_of_pixels;
#ifdef HAS_NORMALS
layout(binding = UNIT_INPUT + 3) uniform sampler2D normals_of_pixels;
#endif
#ifdef PLACED_THICKNESS
layout(binding = UNIT_INPUT + 4) uniform sampler2D thickness_of_pixels;
#endif
const bool write_background = true;
#else
#include "places.glsl"
#endif

#ifndef HAS_OPACITY
uniform float opacity;
#endif
#ifndef PLACED_THICKNESS
uniform float thickness;  // scene units
#else
uniform float thickness_px;  // and a point's own
#ifndef MERGED
layout(binding = UNIT_THICKNESS) uniform samplerBuffer thickness_of_points;
#endif
#endif
#ifndef HAS_NORMALS
uniform float spacing;  // of the points, scene units; 0: they are single pixels
#include "techniques/layers/image_normal.glsl"
#endif

// out_1: the surface as operators on the layer see it: |n.v|, how thick the layer is here, and CATEGORIES.
bool filter_pixel(ivec2 pixel) {
  uint source = texelFetch(index_image, pixel, 0).x;
  out_0 = vec4(0.0);
  out_1 = vec4(1.0, 0.0, 1.0, 1.0);
#ifdef WRITE_NORMAL
  out_2 = vec4(0.0, 0.0, 0.0, 1.0);
#endif
  float depth = texelFetch(depth_image, pixel, 0).x;
  if (source == 0xffffffffu || isinf(depth)) return write_background;  // clip.glsl ends layers
#ifdef MERGED
  int width = textureSize(colors_of_pixels, 0).x;
  ivec2 from = ivec2(int(source) % width, int(source) / width);
  vec3 own_color = texelFetch(colors_of_pixels, from, 0).rgb;
#else
  int i = place_in_chunk(source);
  if (i < 0) return false;
  vec3 own_color = point_color(i);
#endif
#ifdef HAS_OPACITY
  float opacity = point_field(i);
#endif
#ifdef PLACED_THICKNESS
#ifdef MERGED
  float thickness = texelFetch(thickness_of_pixels, from, 0).x;
#else
  float thickness = texelFetch(thickness_of_points, i).x;
#endif
  thickness += thickness_px / pixels_at(depth);
#endif
#if defined(HAS_NORMALS) && defined(MERGED)
  vec3 normal = texelFetch(normals_of_pixels, from, 0).xyz;
#elif defined(HAS_NORMALS)
  vec3 normal = point_normal(i);
#else
  vec3 normal = image_normal(pixel, depth, thickness);
#endif
  vec3 to_eye = to_camera(eye_from_pixel(vec2(pixel) + 0.5, depth));
  float cosine = dot(mat3(frame.eye_from_cloud) * normal, to_eye);
  if (cosine < 0.0) normal = -normal;  // unoriented: towards the camera
  float shadow = 1.0;
#ifdef HAS_SHADOW
  shadow = point_shadow(i);
#endif
  vec4 color = vec4(own_color * opacity, opacity);
  out_0 = shaded_color(color, vec2(pixel) + 0.5, depth, vec4(normal, shadow));
  out_1.xy = vec2(dot(normal, normal) > 0.25 ? abs(cosine) : 1.0, thickness);
#ifdef CATEGORIES
  out_1.z = float(nearest_place(own_color));
#endif
#ifdef WRITE_NORMAL
  out_2 = vec4(normal, shadow);
#endif
  return true;
}
