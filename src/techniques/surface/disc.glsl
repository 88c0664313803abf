// The discs that planes.glsl left in a grid of squares of 2x2 px.
#include "splat.glsl"

#ifndef DISC_FRAGMENT
layout(binding = UNIT_INPUT) uniform sampler2D centers;        // eye position; 0 in w where there is none
layout(binding = UNIT_INPUT + 1) uniform sampler2D orientations;  // eye normal facing the camera, radius
layout(binding = UNIT_INPUT + 2) uniform sampler2D disc_colors;

layout(binding = UNIT_INPUT + 4) uniform sampler2D clips;

Splat disc_at(ivec2 square) {
  vec4 orientation = texelFetch(orientations, square, 0);
  return Splat(texelFetch(centers, square, 0).xyz, orientation.xyz, orientation.w);
}
#endif

// A disc ends where the surface does: `clip` = direction and distance from the centre, px.
bool hit_disc(Splat splat, vec4 clip, vec2 pixel, out SplatHit hit) {
  return dot(pixel - pixel_from_eye(splat.center), clip.xy) <= clip.z && hit_splat(splat, pixel, hit);
}
