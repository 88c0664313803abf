// The clusters within a ball around a point, from the level of their pyramid that suits its size.
#include "frame.glsl"
#include "techniques/surface/level_corner.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D clusters;  // all levels side by side; level k: squares of 2 << k px
layout(binding = UNIT_INPUT + 1) uniform sampler2D about;   // spacing, of the finest
uniform int levels;

struct Fit {
  mat3 scatter;   // covariance in units of the reach
  vec3 mean;
  float support;  // sum of weights
  int neighbors;
  int octants;    // of the screen, one bit each: those with a neighbour
  bool behind;    // something else is nearer there
};

int octant(vec2 away) { return int(away.x > 0.0) + 2 * int(away.y > 0.0) + 4 * int(abs(away.x) > abs(away.y)); }

// The clusters of one level within a ball.
struct Window {
  vec3 center;
  float reach;
  ivec2 corner, first, last;
  float side;  // of the squares, px
};

// `fineness`: squares across the radius of the ball.
Window window_around(vec3 center, float reach, float fineness) {
  float reach_px = reach * pixels_at(-center.z);
  int l = clamp(int(floor(log2(reach_px / fineness) + 0.5)) - 1, 0, levels - 1);
  float side = float(2 << l);
  ivec2 size = textureSize(about, 0);
  vec2 at = pixel_from_eye(center) / side;
  Window w;
  w.center = center;
  w.reach = reach;
  w.side = side;
  w.first = max(ivec2(floor(at - reach_px / side)), ivec2(0));
  w.last = min(min(ivec2(floor(at + reach_px / side)), w.first + 15), (size >> l) - 1);
  w.corner = level_corner(l, size);
  return w;
}

Fit gather(Window window) {
  vec3 diagonal = vec3(0.0), mixed = vec3(0.0);
  vec2 at = pixel_from_eye(window.center);
  Fit fit = Fit(mat3(0.0), vec3(0.0), 0.0, 0, 0, false);
  for (ivec2 t = window.first; t.y <= window.last.y;) {
    vec4 c = texelFetch(clusters, window.corner + t, 0);
    vec3 d = (c.xyz - window.center) / window.reach;
    float rest = max(1.0 - dot(d, d), 0.0), w = c.w > 0.0 ? c.w * rest * rest : 0.0;
    fit.support += w;
    fit.mean += w * d;
    diagonal += w * d * d;
    mixed += w * d.yzx * d.zxy;
    if (w > 0.0 && dot(d, d) > 1e-6) {
      ++fit.neighbors;
      fit.octants |= 1 << octant(pixel_from_eye(c.xyz) - at);
    }
    if (c.w > 0.0 && d.z > 1.0) fit.behind = true;
    if (++t.x > window.last.x) t = ivec2(window.first.x, t.y + 1);
  }
  float inverse = 1.0 / max(fit.support, 1e-6);
  fit.mean *= inverse;
  diagonal = diagonal * inverse - fit.mean * fit.mean;
  mixed = mixed * inverse - fit.mean.yzx * fit.mean.zxy;
  fit.scatter = mat3(diagonal.x, mixed.z, mixed.y, mixed.z, diagonal.y, mixed.x, mixed.y, mixed.x, diagonal.z);
  return fit;
}

// How the surface through the centre goes on around it.
struct Surroundings {
  float end;  // px on the screen, outwards
  float gap;  // scene units: the farthest among the nearest neighbours of the octants
};

// The surface goes on up to the outermost cluster on it, or in front of it, within `strip` px to both sides; up to as
// far again a cluster counts as twice as far in, so that none comes and goes at once. Order statistics of a straight
// border say that it is beyond that by half the distance from the first to the third, but it is the outermost of a strip
// that counts, discs add to it, and against the background outline.glsl has the last word.
Surroundings look_around(Window window, vec3 normal, vec2 outwards, float strip, float spacing) {
  vec2 center = pixel_from_eye(window.center);
  float reach_px = window.reach * pixels_at(-window.center.z);
  float outermost = -reach_px;
  vec4 low = vec4(window.reach), high = vec4(window.reach);
  for (ivec2 t = window.first; t.y <= window.last.y;) {
    vec4 c = texelFetch(clusters, window.corner + t, 0);
    vec3 d = c.xyz - window.center;
    float far = length(d), above = dot(d, normal);
    vec2 away_px = pixel_from_eye(c.xyz) - center;
    float away = dot(away_px, outwards);
    float slack = max(spacing, 0.6 * far);
    bool on_surface = far < window.reach && abs(above) < slack, in_front = above > spacing && dot(d, window.center) < 0.0;
    bool there = c.w > 0.0 && (on_surface || in_front);
    float beside = abs(dot(away_px, vec2(-outwards.y, outwards.x)));
    away -= 2.0 * max(beside - strip, 0.0);
    // Of a square that is full of points, the outer half is surface as well.
    away += 0.5 * window.side * clamp(2.0 * c.w / (window.side * window.side) - 1.0, 0.0, 1.0);
    if (there && beside < 2.0 * strip && away < reach_px) outermost = max(outermost, away);
    if (c.w > 0.0 && on_surface && far > 0.1 * spacing) {
      int o = octant(away_px);
      low = min(low, mix(vec4(window.reach), vec4(far), equal(ivec4(o), ivec4(0, 1, 2, 3))));
      high = min(high, mix(vec4(window.reach), vec4(far), equal(ivec4(o), ivec4(4, 5, 6, 7))));
    }
    if (++t.x > window.last.x) t = ivec2(window.first.x, t.y + 1);
  }
  low *= vec4(lessThan(low, vec4(window.reach)));
  high *= vec4(lessThan(high, vec4(window.reach)));
  vec4 largest = max(low, high);
  float gap = max(max(largest.x, largest.y), max(largest.z, largest.w));
  return Surroundings(outermost, gap);
}
