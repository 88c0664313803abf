// Hidden point removal: the mean over eight sectors of the least occlusion value in each. Below a threshold the
// pixel is a hole: a point seen through the surface in front of it, or a gap in that surface.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D pyramid;
layout(binding = UNIT_INPUT + 1) uniform sampler2D removal_level;

uniform int coarse_level;
uniform int window_radius;
uniform float disc_radius;   // point spacings
uniform float gap_level;     // log2 of the reach of holes over that of points

const float outline_share = 0.7;
const float disc_gap = 6.0;  // point spacings: more than a disc on a surface of 80 degrees reaches in depth

vec2 center;
float own_disc;  // point spacings
bool under_disc = false;

#ifdef COUNT_FETCHES
float fetches = 0.0;
#endif

// o(x, y) = 1 - ((y - x) / |y - x|) . (-y / |y|), in 0..2; 0 = y straight between x and the camera (Bouchiba 2018,
// Sec. 3.1.2). Empty squares and what lies beyond the image are open sky: 2.
float occlusion(vec3 x, ivec2 at, int level) {
#ifdef COUNT_FETCHES
  fetches += 1.0;
#endif
  uvec2 size = uvec2(textureSize(pyramid, level));
  if (uint(at.x) >= size.x || uint(at.y) >= size.y) return 2.0;
  vec4 y = texelFetch(pyramid, at, level);
  if (y.w <= 0.0) return 2.0;
  // In pixels times depth, which saves a division for every neighbour.
  vec2 away = vec2(frame.intrinsics.x, -frame.intrinsics.y) * y.xy +
              (frame.intrinsics.zw - center) * (frame.orthographic != 0 ? 1.0 : -y.z);
  float radius = own_disc * y.w * frame.pixels_per_unit;
  if (dot(away, away) <= radius * radius && y.z - x.z > disc_gap * y.w) under_disc = true;
  vec3 d = y.xyz - x;
  if (frame.orthographic != 0) return 1.0 - d.z * inversesqrt(max(dot(d, d), 1e-37));
  return 1.0 + dot(d, y.xyz) * inversesqrt(max(dot(d, d) * dot(y.xyz, y.xyz), 1e-37));
}

// The level between the squares of the coarse map, so that it does not jump at their borders.
float level_at(ivec2 pixel) {
  vec2 square = (vec2(pixel) + 0.5) / float(1 << coarse_level) - 0.5;
  ivec2 low = ivec2(floor(square)), last = textureSize(removal_level, 0) - 1;
  ivec2 lo = clamp(low, ivec2(0), last), hi = clamp(low + 1, ivec2(0), last);
  vec2 t = square - vec2(low);
  return mix(mix(texelFetch(removal_level, lo, 0).x, texelFetch(removal_level, ivec2(hi.x, lo.y), 0).x, t.x),
             mix(texelFetch(removal_level, ivec2(lo.x, hi.y), 0).x, texelFetch(removal_level, hi, 0).x, t.x), t.y);
}

// The ring of eight squares around the pixel's own on every level up to l (Bouchiba 2018, Fig. 3). The last ring
// counts by the fraction of l, so that nothing pops when l grows.
float pyramid_mean(ivec2 pixel, vec3 x, bool covered) {
  float level = level_at(pixel);
  if (!covered) level = max(level + gap_level, 0.0);
  vec4 sides = vec4(2.0), corners = vec4(2.0);
  for (int l = 0; l <= int(ceil(level)); ++l) {
    ivec2 own = pixel >> l;
    float share = clamp(level - float(l) + 1.0, 0.0, 1.0);
    vec4 side = vec4(occlusion(x, own + ivec2(1, 0), l), occlusion(x, own + ivec2(0, 1), l),
                     occlusion(x, own - ivec2(1, 0), l), occlusion(x, own - ivec2(0, 1), l));
    vec4 corner = vec4(occlusion(x, own + ivec2(1, 1), l), occlusion(x, own + ivec2(-1, 1), l),
                       occlusion(x, own - ivec2(1, 1), l), occlusion(x, own + ivec2(1, -1), l));
    sides = mix(sides, min(sides, side), share);
    corners = mix(corners, min(corners, corner), share);
  }
  return dot(sides + corners, vec4(0.125));
}

// Every pixel of a fixed window (Pintus, Gobbetti, Agus 2011): what the pyramid replaces.
float window_mean(ivec2 pixel, vec3 x) {
  float least[8] = float[](2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0);
  for (int dy = -window_radius; dy <= window_radius; ++dy)
    for (int dx = -window_radius; dx <= window_radius; ++dx) {
      if (dx == 0 && dy == 0) continue;
      int sector = int(floor(atan(float(dy), float(dx)) / 0.785398163 + 0.5)) & 7;
      least[sector] = min(least[sector], occlusion(x, pixel + ivec2(dx, dy), 0));
    }
  float sum = 0.0;
  for (int k = 0; k < 8; ++k) sum += least[k];
  return sum / 8.0;
}

bool filter_pixel(ivec2 pixel) {
  center = vec2(pixel) + 0.5;
  vec4 own = texelFetch(pyramid, pixel, 0);
  // Against the background an outline is where it is on average; a leak of what is behind shows more than a little
  // too much of what is in front.
  own_disc = own.w > 0.0 ? disc_radius : outline_share * disc_radius;
  // The background is as good as infinitely far: on the far plane, just behind the last points, the gaps between
  // those would not be holes.
  vec3 x = own.w > 0.0 ? own.xyz : eye_from_pixel(vec2(pixel) + 0.5, 1e4 * frame.far_plane);
#ifdef WINDOW
  out_0 = vec4(window_mean(pixel, x));
#else
  out_0 = vec4(pyramid_mean(pixel, x, own.w > 0.0));
#endif
  // A point stands for a piece of the surface: what lies behind it is hidden, although a side or two are open. On
  // one surface, however steep, no side is closed.
  if (under_disc && (own.w <= 0.0 || out_0.x < 0.8)) out_0 = vec4(0.0);
#ifdef COUNT_FETCHES
  out_1 = vec4(fetches);
#endif
  return true;
}
