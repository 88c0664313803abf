// One visit of all points: the depth visit keeps the nearest depth of every pixel, the index visit
// (WRITE_INDEX) the lowest source index among the points of that depth. Both compute the same depth bit for
// bit (`precise`).
//   CASTERS       only points that stop a share of the light within `caster_range`
//   LIST_LENGTH   the images are lists: as many depths of different bins a pixel, ascending, stacked
//                 downwards
#include "frame.glsl"
#include "cloud.glsl"

layout(local_size_x = 128) in;
layout(r32ui, binding = 0) uniform uimage2D depth_image;
#ifdef WRITE_INDEX
layout(r32ui, binding = 1) uniform uimage2D index_image;
#endif
#ifdef DEPTH_REFERENCE
layout(binding = UNIT_INPUT) uniform sampler2D reference_depth;
#endif

uniform int size_mode;      // 0 adaptive, 1 pixels, 2 world
uniform float point_size;   // factor, px, scene units
uniform float largest_spacing;  // scene units; adaptive sizes where points are sparser stay at it
uniform float wide_px;      // adaptive sizes above it grow with their root; 0: no
uniform float min_gap;      // scene units behind the reference

#ifdef CASTERS
uniform vec2 caster_range;
#endif

#ifdef LIST_LENGTH
uniform float inverse_bin;  // of a power of two: exact

bool same_bin(uint a, uint b) {
  return floor(uintBitsToFloat(a) * inverse_bin) == floor(uintBitsToFloat(b) * inverse_bin);
}
#endif

const float max_footprint_px = 64.0;

void cover(ivec2 pixel, float depth, int i) {
#ifdef DEPTH_REFERENCE
  float reference = texelFetch(reference_depth, pixel, 0).x;
  if (!(depth >= reference + min_gap)) return;  // beyond the previous layer; inf: that pixel is finished
#endif
  uint bits = floatBitsToUint(depth);
#if defined(LIST_LENGTH)
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

void main() {
  Batch batch = visible_batch(gl_WorkGroupID.y);
  int k = int(gl_GlobalInvocationID.x);
  if (k >= batch.count) return;
  int i = batch.first + k;
#ifdef CASTERS
  float stopped = caster_opacity(i);
  if (!(stopped >= caster_range.x && stopped < caster_range.y)) return;
#endif

  vec3 position = point_position(i);
  if (is_cut(position)) return;
  precise vec3 eye = (frame.eye_from_cloud * vec4(position, 1.0)).xyz;
  precise float depth = -eye.z;
  if (!(depth >= frame.near_plane)) return;
  precise vec2 center = pixel_from_eye(eye);
  ivec2 size = ivec2(frame.image_size);

#ifndef SINGLE_PIXEL
  float diameter = point_size;
  if (size_mode == 0)
    diameter *= min(spacing_in(gl_WorkGroupID.y, batch, position), largest_spacing) * pixels_at(depth);
  if (size_mode == 0 && wide_px > 0.0 && diameter > wide_px) diameter = sqrt(diameter * wide_px);
  if (size_mode == 2) diameter *= pixels_at(depth);
  if (diameter > 1.0) {
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
