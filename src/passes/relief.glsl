// Relief from depth alone: the ambient occlusion of relief_occlusion.glsl between its squares, and eye-dome lighting
// (Boucheny 2009): each pixel is darkened by how far it lies behind its eight neighbours on a circle, more than on a
// plane, in shares of its depth, so that the look does not depend on the scene's scale. What one neighbour adds is
// bounded, and so is their sum: every step draws a line of one darkness, and what lies behind all that is around it
// stays a dot of its colour. An outline is that of something that goes on along it: of leaves and strays, which all lie
// at depths of their own, every dot would have a black ring.
//
// And from normals: radiance scaling (Vergne et al. 2010, "Radiance Scaling for Versatile Surface Enhancement", Eq. 5 of
// dark radiance, tanh of the curvature): ridges are lightened and valleys darkened, as normals open or close across the
// picture, over several distances.
#include "frame.glsl"
#include "passes/point_noise.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D color_image;
layout(binding = UNIT_INPUT + 1) uniform sampler2D depth_image;
layout(binding = UNIT_INPUT + 2) uniform sampler2D openness_image;  // openness and noise of squares
layout(binding = UNIT_INPUT + 3) uniform sampler2D normal_image;

uniform float square_px;
uniform float radius_px;
uniform float strength;   // of eye-dome lighting
uniform float occlusion;  // share of what ambient occlusion takes
uniform float orthographic_distance;
uniform float spacing;  // of the points between which a surface was closed, scene units; 0 where none was
uniform float scaling;  // strength of radiance scaling
uniform float scaling_px;  // the least distance, each next one half an octave farther
uniform int scaling_distances;
uniform float median_spacing;  // of the points, scene units

const float fine_px = 2.5,
            coarse_px = 6.0;      // between points: their relief is seen; that between them would be
const float most_near = 0.008;    // octaves of depth
const float darkest = 1.2;        // exponent
const float along_radii = 3.0;    // 4.2 px: beyond most dots
const float within_radii = 0.25;  // eight neighbours tell the way to some 10 degrees
const float own_way = 0.1;        // turns straight lines by 2 degrees at most
const float steepest = 4.0;       // depth over width: of a surface, as in relief_pyramid.glsl
const float well_opened = 0.35;   // radians
const float most_sudden = 1.5;    // times what one half of the distance promises
const float least_spacings = 1.0, enough_spacings = 2.0;

float depth_at(ivec2 pixel, vec2 away) {
  ivec2 at = ivec2(floor(vec2(pixel) + 0.5 + away));
  return texelFetch(depth_image, clamp(at, ivec2(0), textureSize(depth_image, 0) - 1), 0).x;
}

// Between the centres of four squares, of those that are covered.
vec2 around(ivec2 pixel) {
  vec2 at = (vec2(pixel) + 0.5) / square_px - 0.5, t = fract(at);
  ivec2 low = ivec2(floor(at)), last = textureSize(openness_image, 0) - 1;
  vec2 sum = vec2(0.0);
  for (int k = 0; k < 4; ++k) {
    ivec2 corner = ivec2(k & 1, k >> 1);
    vec2 w = mix(1.0 - t, t, vec2(corner));
    sum += w.x * w.y * texelFetch(openness_image, clamp(low + corner, ivec2(0), last), 0).xy;
  }
  return sum;
}

// How far what lies in front of a pixel goes on, to both sides of the place where it was met or along a slope, from 0 to
// 1. What is nearer to the pixel's own depth is not of it.
float goes_on(ivec2 pixel, vec2 away, vec2 along, float depth, float behind) {
  vec2 off = depth - behind - vec2(depth_at(pixel, away + along), depth_at(pixel, away - along));
  off = min(abs(off), 0.5 * abs(off.x + off.y));
  return dot(vec2(0.5), max(1.0 - 2.0 / behind * off, 0.0));
}

// Normal in eye space, 0 where there is none, and depth.
vec4 surface_at(ivec2 pixel) {
  ivec2 at = clamp(pixel, ivec2(0), textureSize(depth_image, 0) - 1);
  return vec4(mat3(frame.eye_from_cloud) * texelFetch(normal_image, at, 0).xyz, texelFetch(depth_image, at, 0).x);
}

// By how much the normals to both sides open along an axis of the picture, radians where it is little; 0 where there is
// not one surface.
float opening(ivec2 pixel, float depth, int axis, int px, float reach) {
  ivec2 away = axis == 0 ? ivec2(px, 0) : ivec2(0, -px);
  vec4 a = surface_at(pixel + away), b = surface_at(pixel - away);
  bool is_one = min(dot(a.xyz, a.xyz), dot(b.xyz, b.xyz)) > 0.25 && max(abs(a.w - depth), abs(b.w - depth)) < reach;
  return is_one ? a[axis] - b[axis] : 0.0;
}

// No farther from 0 than `most`, and 0 where that has the other sign.
float bounded(float angle, float most) { return clamp(angle, min(most, 0.0), max(most, 0.0)); }

// How far the surface is a ridge, above 0, or a valley: the mean over distances from the third on. Each counts little
// more than in proportion to what counts of half the distance, and to what the other half adds, where the points are no
// farther apart than that: there would be a band beside every crease, along which normals turn at once, and a line on
// it, as on every edge of a coarse mesh. What an arc rises by, an eighth of its angle and length, counts above the noise
// of the points, softly (Donoho, Johnstone 1994, Eq. 4). Normals along a slanted surface turn so much faster in the
// picture: the angle is that along the surface.
float ridge_at(ivec2 pixel, float depth) {
  vec3 own = surface_at(pixel).xyz;
  if (dot(own, own) < 0.25) return 0.0;
  vec3 here = eye_from_pixel(vec2(pixel) + 0.5, depth);
  float px = pixels_at(depth), of_points = point_noise_at(here), sum = 0.0;
  // Of half the distance: itself, its angle, what of it counts over a pixel of distance, and how far.
  vec4 halves[2] = vec4[2](vec4(0.0), vec4(0.0));
  for (int k = 0; k < scaling_distances; ++k) {
    float away = floor(scaling_px * float(1 << k / 2) * (k % 2 == 0 ? 1.0 : 1.41421356) + 0.5);
    float reach = steepest * away / px, noise = 4.0 * of_points * px / away;
    float turned = 0.5 * (opening(pixel, depth, 0, int(away), reach) + opening(pixel, depth, 1, int(away), reach));
    vec4 near = halves[k % 2];
    float promised = most_sudden * away * near.z,
          added = most_sudden * away / (away - near.x) * (turned - near.y);
    float angle = mix(turned, bounded(bounded(turned, promised), added), near.w);
    float counts = smoothstep(least_spacings, enough_spacings, away / max(median_spacing * px, 1e-6));
    halves[k % 2] = vec4(away, turned, angle / away, counts);
    if (k >= 2) sum += sign(angle) * max(abs(angle) - noise, 0.0) * counts;
  }
  return sum / float(scaling_distances - 2) * abs(dot(own, to_camera(here)));
}

bool filter_pixel(ivec2 pixel) {
  out_0 = texelFetch(color_image, pixel, 0);
  float depth = texelFetch(depth_image, pixel, 0).x;
  if (isinf(depth) || out_0.a <= 0.0) return true;
  vec2 open = around(pixel);
  float shade = mix(1.0, open.x, occlusion);
  if (strength > 0.0) {
    // Where the points are far apart on the screen, steps lower than their spacing are how discs happen to
    // lie.
    float chance = spacing * smoothstep(fine_px, coarse_px, spacing * pixels_at(depth));
    // Octaves of depth a scene unit; an orthographic camera compares with a distance of its own.
    float scale = 1.0 / ((frame.orthographic != 0 ? orthographic_distance : depth) * log(2.0));
    float noise = max(chance, open.y), response = 0.0;
    vec2 aways[4], behind[4], bounded[4], toward = vec2(0.0);
    float lowest = -steepest * radius_px / pixels_at(depth);
    for (int k = 0; k < 4; ++k) {
      float angle = float(k) * 0.785398163;
      aways[k] = radius_px * vec2(cos(angle), sin(angle));
      behind[k] = depth - vec2(depth_at(pixel, aways[k]), depth_at(pixel, -aways[k]));
      // A plane lies before it on one side as far as behind on the other.
      vec2 slope = mix(max(behind[k], vec2(lowest)), vec2(0.0), isinf(behind[k])).yx;
      bounded[k] = clamp((behind[k] + min(slope, vec2(0.0)) - noise) * scale, 0.0, most_near);
      toward += (bounded[k].x - bounded[k].y) * aways[k];
    }
    // An outline runs across the way to what is in front, as all neighbours see it: those at 45 degrees to a straight one
    // look past it. In a slot, with as much on both sides, each has its own.
    for (int k = 0; k < 8; ++k) {
      float lighter = bounded[k / 2][k % 2];
      if (lighter <= 0.0) continue;
      vec2 away = k % 2 == 0 ? aways[k / 2] : -aways[k / 2], way = toward + own_way * lighter * away;
      way *= inversesqrt(max(dot(way, way), 1e-30));
      vec2 along = along_radii * radius_px * vec2(-way.y, way.x);
      response += lighter * goes_on(pixel, away + within_radii * radius_px * way, along, depth, behind[k / 2][k % 2]);
    }
    // 300 is Potree's constant. The shade was meant for encoded colour; 2.2 keeps that look in linear light.
    float exponent = response / 8.0 * 300.0 * strength * 2.2;
    shade *= exp(-darkest * (1.0 - exp(-exponent / darkest)));
  }
  out_0.rgb *= shade;
  if (scaling > 0.0) {
    // No ridge is lighter than white.
    float lightest = max(max(out_0.r, out_0.g), max(out_0.b, 1e-6));
    float gain = exp(scaling * tanh(ridge_at(pixel, depth) / well_opened));
    out_0.rgb *= min(gain, max(out_0.a / lightest, 1.0));
  }
  return true;
}
