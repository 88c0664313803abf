// The discs that planes.glsl left in a grid of squares of 2x2 px.
#include "splat.glsl"

// Px, of a disc that stands for so many pixels of its square: half the diagonal of one pixel, so that no disc falls
// between their centres, and of the whole square when it is full. Less, and outlines of fine points lose the outer half
// of their squares: they show the grid.
float least_radius(float pixels) { return mix(0.71, 1.41, (pixels - 1.0) / 3.0); }

// How far around a point with a plane the surface may be where no disc is, point spacings: the hull of points reaches
// beyond discs by less.
const float fill_scale = 0.8;

#ifndef DISC_FRAGMENT
layout(binding = UNIT_INPUT) uniform sampler2D centers;        // eye position; 0 in w where there is none
layout(binding = UNIT_INPUT + 1) uniform sampler2D orientations;  // eye normal facing the camera, radius
layout(binding = UNIT_INPUT + 2) uniform sampler2D disc_colors;

layout(binding = UNIT_INPUT + 4) uniform sampler2D clips;

Splat disc_at(ivec2 square) {
  vec4 orientation = texelFetch(orientations, square, 0), center = texelFetch(centers, square, 0);
  splat_prefilter_px = least_radius(center.w);
  return Splat(center.xyz, orientation.xyz, orientation.w, 0.0);
}
#endif

// A disc ends where the surface does: `clip` = direction and distance from the centre, px.
bool hit_disc(Splat splat, vec4 clip, vec2 pixel, out SplatHit hit) {
  return dot(pixel - pixel_from_eye(splat.center), clip.xy) <= clip.z && hit_splat(splat, pixel, hit);
}
