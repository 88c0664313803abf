// How open the hemisphere above each square of the finest level is, in several octaves (Hoang, Low 2012, "Efficient
// Screen-Space Approach to High-Quality Multiscale Ambient Occlusion"): along eight directions the steepest rise towards
// the camera of the squares around, each octave in squares as wide as half its distance. Two opposite horizons make a
// slice, open by the angle between them (Yokoyama, Shirasawa, Pike 2002, "Visualizing Topography by Openness"), of which
// light from everywhere reaches the bisector's share: cos^2 of half the angle that both rise together (Jimenez et al.
// 2016, "Practical Realtime Strategies for Accurate Indirect Occlusion", Eq. 10, horizons alike). No normals are asked,
// and on a plane, however steep, one horizon rises as far as the other falls.
//
// A rise counts above the noise of its octave (relief_pyramid.glsl), softly (Donoho, Johnstone 1994, Eq. 4).
//   x openness; y noise between neighbouring pixels, scene units
#include "frame.glsl"
#include "passes/point_noise.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D pyramid;  // levels of 2, 4, 8 .. px

uniform int levels, finest;  // of the pyramid; of those this pass writes
uniform int first_octave, octaves;
uniform float first_px;   // distance of the nearest octave, each next one twice as far
uniform float spacing;    // of the points between which a surface was closed, scene units; 0 where none was

const float threshold = 2.0;              // mean details; in one of twenty of normal noise is more
const float deviations = 3.5;             // of points: sqrt(12) are a step of depth that was rounded
const float in_reach = 1.0, beyond = 2.0;  // of the farthest octave: squares in front fade, those beyond count as background
const float nothing = -1e3;               // the rise of the background

const vec2 compass[8] = vec2[8](vec2(1.0, 0.0), vec2(0.70710678, 0.70710678), vec2(0.0, 1.0),
                                vec2(-0.70710678, 0.70710678), vec2(-1.0, 0.0), vec2(-0.70710678, -0.70710678),
                                vec2(0.0, -1.0), vec2(0.70710678, -0.70710678));

// Detail of the squares of level l around a place, between the centres of those in which it is known.
float noise_of(vec2 pixel, int l) {
  int up = min(l + 2, levels - 1);
  vec2 at = pixel / float(2 << up) - 0.5, t = fract(at);
  ivec2 low = ivec2(floor(at)), last = (ivec2(frame.image_size) - 1) >> (up + 1);
  vec2 sum = vec2(0.0);
  for (int k = 0; k < 4; ++k) {
    ivec2 corner = ivec2(k & 1, k >> 1);
    vec2 w = mix(1.0 - t, t, vec2(corner));
    float detail = texelFetch(pyramid, clamp(low + corner, ivec2(0), last), up).w;
    if (detail >= 0.0) sum += w.x * w.y * vec2(detail, 1.0);
  }
  return sum.y > 0.0 ? sum.x / sum.y : 0.0;
}

// Depth around a place, between the centres of the squares that are covered: of a plane its own, so that opposite
// horizons of it cancel, and no step where a square ends. What lies out of reach in front is no part of it: between that
// and what is behind nothing was measured. Moves the place to the middle of what counts.
//   x depth; y how much of the weights counts
vec2 depth_around(inout vec2 pixel, int l, float own, float reach) {
  float side = float(2 << l);
  vec2 at = pixel / side - 0.5, t = fract(at);
  ivec2 low = max(ivec2(floor(at)), ivec2(0)), high = min(low + 1, (ivec2(frame.image_size) - 1) >> (l + 1));
  vec2 a = texelFetch(pyramid, low, l).xy, b = texelFetch(pyramid, ivec2(high.x, low.y), l).xy,
       c = texelFetch(pyramid, ivec2(low.x, high.y), l).xy, d = texelFetch(pyramid, high, l).xy;
  vec4 depth = vec4(a.x, b.x, c.x, d.x);
  vec4 weight = vec4(1.0 - t.x, t.x, 1.0 - t.x, t.x) * vec4(1.0 - t.yy, t.yy) * vec4(greaterThan(depth, vec4(0.0)));
  weight *= 1.0 - smoothstep(in_reach * reach, beyond * reach, own - depth);
  float covered = dot(weight, vec4(1.0)), inverse = 1.0 / max(covered, 1e-6);
  pixel = (floor(at) + 0.5 + inverse * vec2(weight.y + weight.w, weight.z + weight.w)) * side;
  return vec2(inverse * dot(weight, depth), covered);
}

bool filter_pixel(ivec2 square) {
  vec4 own = texelFetch(pyramid, square, finest);
  out_0 = vec4(1.0, 0.0, 0.0, 0.0);
  if (own.y <= 0.0) return true;
  float side = float(2 << finest), pixel = 1.0 / pixels_at(own.x);
  vec2 center = (vec2(square) + 0.5) * side;
  vec3 here = eye_from_pixel(center, own.x), towards = to_camera(here);
  float of_points = point_noise_at(here);
  float chance = spacing * smoothstep(2.5, 6.0, spacing / pixel);
  float reach = first_px * exp2(float(octaves - 1)) * pixel;
  vec4 rise = vec4(nothing), fall = vec4(nothing);  // towards four directions, and those opposite
  for (int o = first_octave; o < octaves; ++o) {
    float away = first_px * exp2(float(o));
    int l = clamp(int(floor(log2(away))) - 2, finest, levels - 1);
    // Of half the distance, in which what is not noise but as large as the octave has its own detail.
    float noise = max(max(threshold * noise_of(center, l + 1), deviations * of_points), 0.5 * chance);
    for (int k = 0; k < 8; ++k) {
      vec2 place = center + away * compass[k];
      bool is_outside = any(lessThan(place, vec2(0.0))) || any(greaterThan(place, vec2(frame.image_size)));
      vec2 there = depth_around(place, l, own.x, reach);
      vec3 d = eye_from_pixel(place, there.x) - here;
      float height = dot(d, towards), across = sqrt(max(dot(d, d) - height * height, 0.0));
      float slope = (height - noise) / max(across, 1e-30);
      if (slope > 0.0) slope *= clamp(2.0 * there.y - 1.0, 0.0, 1.0);  // a rim is no wall
      if (there.y <= 0.0 || is_outside) slope = nothing;
      if (k < 4) rise[k] = max(rise[k], slope);
      else fall[k - 4] = max(fall[k - 4], slope);
    }
  }
  vec4 cosine = (1.0 - rise * fall) * inversesqrt((1.0 + rise * rise) * (1.0 + fall * fall));
  vec4 blocked = mix(vec4(0.0), 0.5 - 0.5 * cosine, greaterThan(rise + fall, vec4(0.0)));
  out_0.x = 1.0 - dot(blocked, vec4(0.25));
  for (int l = 0; l < 2; ++l) out_0.y = max(out_0.y, threshold * noise_of(center, finest + l));
  out_0.y = max(out_0.y, deviations * of_points);
  return true;
}
