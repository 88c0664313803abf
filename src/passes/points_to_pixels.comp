// One visit of all points: the depth visit keeps the nearest depth of every pixel, the index visit
// (WRITE_INDEX) the lowest source index among the points of that depth. Both compute the same depth bit for
// bit (`precise`).
//   CUT           the cloud has half spaces that are left out: asking costs a tenth of a visit
//   ORIENTED      points with a normal are discs in its plane, at the depths at which rays meet it
//   DOTS          the cloud's field holds spacing and share of a surface (analysis/dots.h)
//   SPACINGS      it holds the spacing of every point, scene units
//   CASTERS       only points that stop a share of the light within `caster_range`
//   LIST_LENGTH   the images are lists: as many depths of different bins a pixel, ascending, stacked
//                 downwards
//   ONE_VISIT     both visits in one by 64-bit atomics: the least pair of depth and source index of a pixel
#ifdef ONE_VISIT
#extension GL_ARB_gpu_shader_int64 : require
#extension GL_NV_shader_atomic_int64 : require
#endif
#include "frame.glsl"
#include "cloud.glsl"
#include "work_groups.glsl"
#ifdef ORIENTED
#include "splat.glsl"
#endif

layout(local_size_x = 128) in;
#ifdef ONE_VISIT
layout(std430, binding = 0) buffer Nearest { uint64_t nearest[]; };  // pairs_apart.glsl
#else
layout(r32ui, binding = 0) uniform uimage2D depth_image;
#endif
#ifdef WRITE_INDEX
layout(r32ui, binding = 1) uniform uimage2D index_image;
#endif
#ifdef DEPTH_REFERENCE
layout(binding = UNIT_INPUT) uniform sampler2D reference_depth;
#endif

uniform int size_mode;      // 0 adaptive, 1 pixels, 2 world
uniform float point_size;   // factor, px, scene units
uniform float largest_spacing;  // scene units; adaptive sizes where points are sparser stay at it
uniform float single_px;    // what is narrower is the one pixel that it falls into
uniform float wide_px;      // adaptive sizes above it grow with their fourth root; 0: no
#ifdef DOTS
uniform float spacing_unit;   // scene units
uniform float dot_share;      // of the size that closes a surface, where there is none
uniform vec2 dot_limits_px;
uniform float usual_spacing;  // scene units
uniform float sparse_px;      // what is farther apart, and than usual, recedes
const vec2 closing = vec2(2.5, 3.75);  // in wide_px: points 8 to 12 px apart are no surface to whoever looks
const float overlap = 1.41;   // usual spacings: twice as dense are strips that overlap
const float lone = 0.32, lone_most = 3.2;  // where all are far apart, of what closes a surface; limits
#endif
uniform float min_gap;      // scene units behind the reference

#ifdef ORIENTED
uniform float least_px;     // least radius, half the diagonal of a pixel: no disc falls between their centres
uniform float dense_px;     // discs of a smaller diameter are many in each pixel
#endif
#ifdef CASTERS
uniform vec2 caster_range;
#endif

#ifdef LIST_LENGTH
uniform float inverse_bin;  // of a power of two: exact

bool same_bin(uint a, uint b) {
  return floor(uintBitsToFloat(a) * inverse_bin) == floor(uintBitsToFloat(b) * inverse_bin);
}
#endif

uniform float max_footprint_px;

void cover(ivec2 pixel, float depth, int i) {
#ifdef DEPTH_REFERENCE
  float reference = texelFetch(reference_depth, pixel, 0).x;
  if (!(depth >= reference + min_gap)) return;  // beyond the previous layer; inf: that pixel is finished
#endif
  uint bits = floatBitsToUint(depth);
#if defined(ONE_VISIT)
  int at = pixel.y * int(frame.image_size.x) + pixel.x;
  if (uint64_t(bits) > nearest[at] >> 32) return;  // never wrong: depths only fall
  atomicMin(nearest[at], uint64_t(bits) << 32 | uint64_t(point_source_index(i)));
#elif defined(LIST_LENGTH)
  ivec2 next = ivec2(0, frame.image_size.y);
#ifdef WRITE_INDEX
  for (int k = 0; k < LIST_LENGTH; ++k, pixel += next) {
    uint entry = imageLoad(depth_image, pixel).x;
    if (entry == bits) imageAtomicMin(index_image, pixel, point_source_index(i));
    if (bits <= entry) return;
  }
#else
  if (bits >= imageLoad(depth_image, pixel + (LIST_LENGTH - 1) * next).x) return;
  // Every entry keeps the least that it is given and hands on the rest, unless both are of one bin: whatever
  // the order of the points, the nearest bins remain, each with its least depth.
  for (int k = 0; k < LIST_LENGTH; ++k, pixel += next) {
    uint entry = imageAtomicMin(depth_image, pixel, bits);
    if (entry == 0xffffffffu || same_bin(entry, bits)) return;
    bits = max(bits, entry);
  }
#endif
#elif defined(WRITE_INDEX)
  if (imageLoad(depth_image, pixel).x == bits) imageAtomicMin(index_image, pixel, point_source_index(i));
#else
  if (bits < imageLoad(depth_image, pixel).x) imageAtomicMin(depth_image, pixel, bits);
#endif
}

#ifdef ORIENTED
// A disc in the plane of its normal, where the rays through the centres of pixels meet it.
// `only_own`: no pixel but the one its centre falls into, and that only where the disc covers its centre.
void cover_oriented(int i, vec3 eye, vec3 normal, float radius, bool only_own) {
  float depth = -eye.z;
  ivec2 lo = ivec2(floor(pixel_from_eye(eye))), hi = lo;
  if (only_own && (any(lessThan(lo, ivec2(0))) || any(greaterThanEqual(lo, ivec2(frame.image_size))))) return;
  if (!only_own && !splat_pixels(Splat(eye, normal, radius, 0.0), lo, hi)) return;
  for (int y = lo.y; y <= hi.y; ++y)
    for (int x = lo.x; x <= hi.x; ++x) {
      // Measured from the centre, where float is exact. Edge-on: infinite or not a number, hence a miss.
      vec2 pixel = vec2(x, y) + 0.5;
      precise vec3 slope = frame.orthographic != 0 ? vec3(0.0, 0.0, -1.0) : eye_from_pixel(pixel, 1.0);
      precise vec2 across = eye_from_pixel(pixel, depth).xy - eye.xy;
      precise float beyond = -dot(normal.xy, across) / dot(normal, slope);
      precise vec3 offset = vec3(across, 0.0) + beyond * slope;
      precise float hit = depth + beyond;
      if (dot(offset, offset) <= radius * radius && hit >= frame.near_plane) cover(ivec2(x, y), hit, i);
    }
}
#endif

void main() {
  Batch batch = visible_batch(group_row());
  int k = int(gl_GlobalInvocationID.x);
  if (k >= batch.count) return;
  int i = batch.first + k;
#ifdef CASTERS
  float stopped = caster_opacity(i);
  if (!(stopped >= caster_range.x && stopped < caster_range.y)) return;
#endif

  vec3 position = point_position(i);
#ifdef CUT
  if (is_cut(position)) return;
#endif
  precise vec3 eye = (frame.eye_from_cloud * vec4(position, 1.0)).xyz;
  precise float depth = -eye.z;
  if (!(depth >= frame.near_plane)) return;
  precise vec2 center = pixel_from_eye(eye);
  ivec2 size = ivec2(frame.image_size);

#ifndef SINGLE_PIXEL
  float diameter = point_size;
#ifdef DOTS
  vec2 own = point_fields(i);
  float spacing = own.x * spacing_unit;
#elif defined(SPACINGS)
  float spacing = min(point_field(i), largest_spacing);
#else
  float spacing = min(spacing_in(group_row(), batch, position), largest_spacing);
#endif
  if (size_mode == 0) diameter *= spacing * pixels_at(depth);
#ifdef DOTS
  float apart = point_size * min(spacing, usual_spacing) * pixels_at(depth);
  float most_px = dot_limits_px.y * clamp(lone * apart / dot_limits_px.y, 1.0, lone_most);
  float as_dot = clamp(dot_share * diameter, dot_limits_px.x, most_px);
  own.y *= 1.0 - smoothstep(closing.x, closing.y, diameter / wide_px);
#endif
  if (size_mode == 0 && wide_px > 0.0 && diameter > wide_px) diameter = wide_px * sqrt(sqrt(diameter / wide_px));
#ifdef DOTS
  diameter = mix(as_dot, diameter, own.y);
  float usual = max(sparse_px / pixels_at(depth), overlap * usual_spacing);
  if (spacing > usual) diameter = max(min(diameter, dot_limits_px.x), diameter * sqrt(usual / spacing));
#endif
  if (size_mode == 2) diameter *= pixels_at(depth);
  bool is_single = diameter < single_px;
#ifdef ORIENTED
  precise vec3 normal = mat3(frame.eye_from_cloud) * point_normal(i);
  if (dot(normal, normal) > 0.25 && !is_single) {
    precise float radius = max(0.5 * min(diameter, max_footprint_px), least_px) / pixels_at(depth);
    cover_oriented(i, eye, normal, radius, diameter < dense_px);
    return;
  }
#endif
  if (diameter > 1.0 && !is_single) {
    float radius = 0.5 * min(diameter, max_footprint_px);
    // A disc is a paraboloid as deep as its radius, so that neighbours meet halfway instead of one covering
    // the other (Schuetz 2016, Potree): no edges inside a surface for eye-dome lighting to find.
    precise float bulge = 1.0 / (radius * pixels_at(depth));
    ivec2 lo = max(ivec2(ceil(center - radius - 0.5)), ivec2(0));
    ivec2 hi = min(ivec2(floor(center + radius - 0.5)), size - 1);
    ivec2 own = ivec2(floor(center));
    for (int y = lo.y; y <= hi.y; ++y)
      for (int x = lo.x; x <= hi.x; ++x) {
        vec2 away = vec2(x, y) + 0.5 - center;
        // A disc always owns the pixel its centre falls into, however small it is.
        if (dot(away, away) <= radius * radius || ivec2(x, y) == own) {
          precise float bulged = depth + bulge * min(dot(away, away), radius * radius);
          cover(ivec2(x, y), bulged, i);
        }
      }
    return;
  }
#endif
  if (any(lessThan(center, vec2(0.0))) || any(greaterThanEqual(center, frame.image_size))) return;
  cover(ivec2(center), depth, i);
}
