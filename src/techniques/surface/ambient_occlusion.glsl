// How open the hemisphere above a surface is, in squares of 8x8 px: 1 minus the mean over eight compass directions of
// the sine of the horizon, the highest elevation above the tangent plane that a neighbour reaches (horizon mapping,
// Max 1988; the share of the solid angle that is free). It is the operator of hidden point removal with its rings of
// squares (Bouchiba 2018, Fig. 3), but measured against the surface's own normal instead of the direction to the
// camera, so that a plane of any tilt, and whatever is convex, has 1.
//
// Four squares of 4x4 px are asked, as coarse as their rings begin: points alone are noise.
//   PUSH_LEVELS  surface and normals from pull-push, neighbours from the pyramid of nearest points; else the clusters
//                that discs stand for, with their planes
#include "techniques/surface/least_spacing.glsl"
#ifdef PUSH_LEVELS
layout(binding = UNIT_INPUT) uniform sampler2D pyramid;
layout(binding = UNIT_INPUT + 1) uniform sampler2D filled_a;  // of squares of 4x4 px: depth in x
layout(binding = UNIT_INPUT + 2) uniform sampler2D normals;   // trilinear

uniform int levels;
uniform float normal_scale;
uniform vec2 normal_levels;  // first and last that exist
#else
#include "techniques/surface/ball.glsl"

layout(binding = UNIT_INPUT + 2) uniform sampler2D orientations;  // of squares of 2x2 px: normal, radius
layout(binding = UNIT_INPUT + 3) uniform sampler2D ends;          // in w above 0 where a plane was found
#endif

uniform float occlusion_scale;  // width of the farthest ring's squares, point spacings

const float ball = 2.0;              // what is farther than so many of those widths occludes nothing
const int finest = 1;                // level of the squares of 4x4 px

#ifdef PUSH_LEVELS
vec3 filled_at(ivec2 square) {
  return eye_from_pixel((vec2(square) + 0.5) * float(2 << finest), texelFetch(filled_a, square, 0).x);
}
#endif

// A place of the squares of 2 << l px; in w 0 where there is none.
vec4 neighbor(ivec2 at, int l) {
#ifdef PUSH_LEVELS
  if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, textureSize(pyramid, l + 1)))) return vec4(0.0);
  vec4 nearest = texelFetch(pyramid, at, l + 1);
  // Near by, single points are noise; farther away it makes no difference, and what was filled has no horizon.
  if (l == finest && nearest.w > 0.0) nearest.xyz = filled_at(at);
  return nearest;
#else
  ivec2 size = textureSize(about, 0);
  if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, size >> l))) return vec4(0.0);
  return texelFetch(clusters, level_corner(l, size) + at, 0);
#endif
}

struct Patch {
  vec4 at;  // eye position; in w its weight, 0 where there is no surface
  vec3 normal;
  float spacing;
};

// Of a square of 4x4 px.
Patch patch_of(ivec2 own) {
  vec4 at = neighbor(own, finest);
  vec3 normal = vec3(0.0);
  float spacing = 0.0;
#ifdef PUSH_LEVELS
  spacing = at.w;
  at = vec4(filled_at(own), float(at.w > 0.0));
  // Twice as smooth as those that are lit, whose noise would pass for crevices.
  float level = log2(2.0 * normal_scale * spacing * pixels_at(-at.z));
  vec2 uv = (vec2(own) + 0.5) / vec2(textureSize(pyramid, finest + 1));
  normal = textureLod(normals, uv, clamp(level, normal_levels.x, normal_levels.y)).xyz;
  if (dot(normal, to_camera(at.xyz)) < 0.0) normal = -normal;
#else
  float found = 0.0;
  for (int k = 0; k < 4; ++k) {
    ivec2 child = 2 * own + ivec2(k & 1, k >> 1);
    vec4 orientation = texelFetch(orientations, child, 0);
    if (orientation.w <= 0.0 || texelFetch(ends, child, 0).w <= 0.0) continue;
    normal += orientation.xyz;
    spacing += texelFetch(about, child, 0).x;
    found += 1.0;
  }
  spacing /= max(found, 1.0);
#endif
  float size = dot(normal, normal);
  return Patch(vec4(at.xyz, size > 1e-6 ? at.w : 0.0), normal * inversesqrt(max(size, 1e-6)),
               told_apart(spacing, -at.z));
}

// Sine of the elevation of y above the tangent plane, fading out over the last quarter of the ball's radius.
float elevation(Patch own, vec4 y, float reach) {
  vec3 d = y.xyz - own.at.xyz;
  float far = length(d);
  return y.w > 0.0 ? dot(d, own.normal) / max(far, 1e-12) * clamp(4.0 - 4.0 * far / reach, 0.0, 1.0) : 0.0;
}

float openness(Patch own, ivec2 place) {
  float scale = pixels_at(-own.at.z), width = max(occlusion_scale * own.spacing, float(2 << finest) / scale);
  float level = clamp(log2(0.5 * width * scale), float(finest), float(levels - 1));
  vec4 sides = vec4(0.0), corners = vec4(0.0), sides_before = sides, corners_before = corners;
  int last = int(ceil(level));
  for (int l = finest; l <= last; ++l) {
    ivec2 at = place >> (l - finest);
    sides_before = sides;
    corners_before = corners;
#define TOWARDS(dx, dy) elevation(own, neighbor(at + ivec2(dx, dy), l), ball * width)
    sides = max(sides, vec4(TOWARDS(1, 0), TOWARDS(0, 1), TOWARDS(-1, 0), TOWARDS(0, -1)));
    corners = max(corners, vec4(TOWARDS(1, 1), TOWARDS(-1, 1), TOWARDS(-1, -1), TOWARDS(1, -1)));
#undef TOWARDS
  }
  // The last ring counts by its fraction, so that nothing pops when the level grows.
  float share = 1.0 - (float(last) - level);
  return 1.0 - dot(mix(sides_before + corners_before, sides + corners, share), vec4(0.125));
}

bool filter_pixel(ivec2 square) {
  float sum = 0.0, weight = 0.0;
  for (int k = 0; k < 4; ++k) {
    ivec2 place = 2 * square + ivec2(k & 1, k >> 1);
    Patch own = patch_of(place);
    if (own.at.w <= 0.0) continue;
    sum += own.at.w * openness(own, place);
    weight += own.at.w;
  }
  out_0 = weight > 0.0 ? vec4(sum / weight, 1.0, 0.0, 0.0) : vec4(0.0);
  return true;
}
