// Hidden point removal: the mean over eight sectors of the least occlusion value in each. Below a threshold the
// pixel is a hole: a point seen through the surface in front of it, or a gap in that surface.
//   HOLES   for pixels without a point as well; else only for points
#include "frame.glsl"
#define REMOVAL_LEVEL_INPUT 1
#include "techniques/surface/level_between.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D pyramid;

uniform int top_level;       // the last one there is
uniform int window_radius;
uniform float threshold;     // mean occlusion below which a point is hidden
uniform float disc_radius;   // point spacings
uniform int disc_level;        // whose squares are as wide as the radius of any disc
uniform float gap_level;     // log2 of the reach of holes over that of points

const float outline_share = 0.7;
const float disc_gap = 6.0;  // point spacings: more than a disc on a surface of 80 degrees reaches in depth

vec3 own_ray;    // of the pixel, advancing one unit of eye depth
float own_disc;  // point spacings
bool under_disc = false;

#ifdef COUNT_FETCHES
float fetches = 0.0;
#endif

// The occlusion value o(x, y) = 1 - ((y - x) / |y - x|) . (-y / |y|), in 0..2; 0 = y straight between x and the camera
// (Bouchiba 2018, Sec. 3.1.2). Least values are found among (o - 1) |o - 1|, which grows with o and needs no root.
// Empty squares and what lies beyond the image are open sky: 1, which is o = 2.
float signed_square(vec3 x, ivec2 at, int level, bool with_discs) {
#ifdef COUNT_FETCHES
  fetches += 1.0;
#endif
  uvec2 size = uvec2(textureSize(pyramid, 0) >> level);
  if (uint(at.x) >= size.x || uint(at.y) >= size.y) return 1.0;
  vec4 y = texelFetch(pyramid, at, level);
  if (y.w <= 0.0) return 1.0;
  bool parallel = frame.orthographic != 0;
  if (with_discs) {
    vec2 away = y.xy - own_ray.xy * (parallel ? 1.0 : -y.z);
    float radius = own_disc * y.w;
    if (dot(away, away) < radius * radius && y.z - x.z > disc_gap * y.w) under_disc = true;
  }
  vec3 d = y.xyz - x, from_camera = parallel ? vec3(0.0, 0.0, -1.0) : y.xyz;
  float t = dot(d, from_camera);
  return t * abs(t) / max(dot(d, d) * dot(from_camera, from_camera), 1e-37);
}
vec4 occlusion(vec4 signed_square) { return 1.0 + sign(signed_square) * sqrt(abs(signed_square)); }

// The least values of the eight sectors: of all rings but the last, and of all.
vec4 sides = vec4(1.0), corners = vec4(1.0), sides_before, corners_before;

// The ring of eight squares around the pixel's own (Bouchiba 2018, Fig. 3).
void look_around(vec3 x, ivec2 pixel, int l, bool with_discs) {
  ivec2 own = pixel >> l;
  sides_before = sides;
  corners_before = corners;
#define TOWARDS(dx, dy) signed_square(x, own + ivec2(dx, dy), l, with_discs)
  sides = min(sides, vec4(TOWARDS(1, 0), TOWARDS(0, 1), TOWARDS(-1, 0), TOWARDS(0, -1)));
  corners = min(corners, vec4(TOWARDS(1, 1), TOWARDS(-1, 1), TOWARDS(-1, -1), TOWARDS(1, -1)));
#undef TOWARDS
}

// Every level up to l, the last one by the fraction of l, so that nothing pops when l grows.
float pyramid_mean(ivec2 pixel, vec3 x, bool covered) {
  float reach = level_at(pixel);
  if (!covered) reach = clamp(reach + gap_level, 0.0, float(top_level));
  int last = int(ceil(reach)), l = 0;
  // What a coarser ring than this finds within the radius of its disc, a finer one has found before.
  for (; l <= min(last, disc_level); ++l) look_around(x, pixel, l, true);
  for (; l <= last; ++l) look_around(x, pixel, l, false);
  float share = 1.0 - (float(last) - reach);
  return dot(mix(occlusion(sides_before) + occlusion(corners_before), occlusion(sides) + occlusion(corners), share),
             vec4(0.125));
}

// Every pixel of a fixed window (Pintus, Gobbetti, Agus 2011): what the pyramid replaces.
float window_mean(ivec2 pixel, vec3 x) {
  float least[8] = float[](1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0);
  for (int dy = -window_radius; dy <= window_radius; ++dy)
    for (int dx = -window_radius; dx <= window_radius; ++dx) {
      if (dx == 0 && dy == 0) continue;
      int sector = int(floor(atan(float(dy), float(dx)) / 0.785398163 + 0.5)) & 7;
      least[sector] = min(least[sector], signed_square(x, pixel + ivec2(dx, dy), 0, true));
    }
  vec4 sum = occlusion(vec4(least[0], least[1], least[2], least[3])) +
             occlusion(vec4(least[4], least[5], least[6], least[7]));
  return dot(sum, vec4(0.125));
}

bool filter_pixel(ivec2 pixel) {
#ifndef HOLES
  out_0 = vec4(2.0);
  out_1 = vec4(0.0);
#ifdef COUNT_FETCHES
  out_2 = vec4(0.0);
#endif
  if (texelFetch(pyramid, pixel, 0).w <= 0.0) return true;
#endif
  own_ray = eye_from_pixel(vec2(pixel) + 0.5, 1.0);
  vec4 own = texelFetch(pyramid, pixel, 0);
  // Against the background an outline is where it is on average; a leak of what is behind shows more than a little
  // too much of what is in front.
  own_disc = own.w > 0.0 ? disc_radius : outline_share * disc_radius;
  // The background is as good as infinitely far: on the far plane, just behind the last points, the gaps between
  // those would not be holes.
  vec3 x = own.w > 0.0 ? own.xyz : eye_from_pixel(vec2(pixel) + 0.5, 1e4 * frame.far_plane);
#ifdef WINDOW
  float mean = window_mean(pixel, x);
#else
  float mean = pyramid_mean(pixel, x, own.w > 0.0);
#endif
  // A point stands for a piece of the surface: what lies behind it is hidden, although a side or two are open. On
  // one surface, however steep, no side is closed.
  if (under_disc && (own.w <= 0.0 || mean < 0.8)) mean = 0.0;
  bool visible = own.w > 0.0 && mean >= threshold;
  out_0 = vec4(mean);
  out_1 = visible ? vec4(-own.z, 0.0, own.w, 1.0) : vec4(0.0);
#ifdef COUNT_FETCHES
  out_2 = vec4(fetches);
#endif
  return true;
}
