// Eye-dome lighting (Boucheny 2009): each pixel is darkened by how far it lies behind its eight neighbours on a
// circle, in log2 of depth, so that the look does not depend on the scene's scale. What one neighbour adds is bounded:
// every step draws a line of one darkness, for in foliage each dot has one, and black ones would be all there is to see.
// A wider circle sets one object off another.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D color_image;
layout(binding = UNIT_INPUT + 1) uniform sampler2D depth_image;

uniform float radius_px;
uniform float strength;
uniform float orthographic_distance;
uniform float least_step;  // of surfaces, scene units: lower ones are noise
uniform float spacing;  // of the points between which a surface was closed, scene units; 0 where none was

const float fine_px = 2.5, coarse_px = 6.0;  // between points: their relief is seen; that between them would be
const float most_near = 0.008, most_wide = 0.005, wide = 6.0;

float log_depth(float depth) {
  return frame.orthographic != 0 ? (depth / orthographic_distance) / log(2.0) : log2(depth);
}

float log_depth_slope(float depth) {
  return 1.0 / ((frame.orthographic != 0 ? orthographic_distance : depth) * log(2.0));
}

float log_depth_at(ivec2 pixel, vec2 away) {
  ivec2 at = ivec2(floor(vec2(pixel) + 0.5 + away));
  return log_depth(texelFetch(depth_image, clamp(at, ivec2(0), textureSize(depth_image, 0) - 1), 0).x);
}

bool filter_pixel(ivec2 pixel) {
  out_0 = texelFetch(color_image, pixel, 0);
  float depth = texelFetch(depth_image, pixel, 0).x;
  if (isinf(depth) || out_0.a <= 0.0) return true;
  float here = log_depth(depth), response = 0.0;
  // Where the points are far apart on the screen, steps lower than their spacing are how discs happen to lie.
  float chance = spacing * smoothstep(fine_px, coarse_px, spacing * pixels_at(depth));
  float noise = max(chance, least_step) * log_depth_slope(depth);
  for (int k = 0; k < 4; ++k) {
    float angle = float(k) * 0.785398163;
    vec2 away = radius_px * vec2(cos(angle), sin(angle));
    // How far the two opposite neighbours lie before this pixel; the background is behind everything.
    vec2 near = here - vec2(log_depth_at(pixel, away), log_depth_at(pixel, -away));
    vec2 far = here - vec2(log_depth_at(pixel, wide * away), log_depth_at(pixel, -wide * away));
    vec2 bounded = clamp(near - noise, 0.0, most_near);
    response += bounded.x + bounded.y;
    // On a plane, however steep, one is as far before it as the other behind.
    response += 2.0 * clamp(far.x + far.y - 2.0 * noise, 0.0, most_wide);
  }
  // 300 is Potree's constant. The shade was meant for encoded colour; 2.2 keeps that look in linear light.
  float shade = exp(-response / 8.0 * 300.0 * strength * 2.2);
  out_0.rgb *= shade;
  return true;
}
