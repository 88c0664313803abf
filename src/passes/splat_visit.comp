// Splats of a few pixels, one thread each: faster than the rasteriser's set-up of a primitive.
//   VISIT_NEAREST   the nearest ray distance of every pixel by atomicMin (bits of positive floats sort like them)
//   VISIT_MARK      flags the splats of which a pixel lies within epsilon of the visible surface; most hidden ones
//                   are sorted out by the farthest visible distance of the blocks they touch (splat_farthest.glsl)
#include "splat_cloud.glsl"
#include "work_groups.glsl"

layout(local_size_x = 128) in;

#ifdef VISIT_NEAREST
#include "splat_shift.glsl"
layout(r32ui, binding = 0) uniform uimage2D nearest_bits;
#else
layout(r8ui, binding = 0) writeonly uniform uimageBuffer flags;
layout(binding = UNIT_INPUT) uniform sampler2D farthest_t;
layout(binding = UNIT_INPUT + 1) uniform sampler2D nearest_t;
uniform float epsilon;
uniform uint slots_per_batch;
#endif

#ifdef VISIT_NEAREST
void main() {
  Batch batch = visible_batch(group_row());
  int k = int(gl_GlobalInvocationID.x);
  if (k >= batch.count) return;
  Splat splat = cloud_splat(batch.first + k);
  ivec2 first, last;
  if (!splat_pixels(splat, first, last)) return;
  // One loop, not two: neighbouring lanes then wait for the largest box and not for its longest row times rows.
  for (ivec2 pixel = first; pixel.y <= last.y;) {
    SplatHit hit;
    if (hit_splat(splat, vec2(pixel) + 0.5, hit)) {
      uint bits = floatBitsToUint(hit.t + splat_shift(splat.radius));
      if (bits < imageLoad(nearest_bits, pixel).x) imageAtomicMin(nearest_bits, pixel, bits);
    }
    if (++pixel.x > last.x) pixel = ivec2(first.x, pixel.y + 1);
  }
}
#else
void main() {
  Batch batch = visible_batch(group_row());
  int k = int(gl_GlobalInvocationID.x);
  bool visible = false;
  ivec2 first, last;
  if (k < batch.count) {
    Splat splat = cloud_splat(batch.first + k);
    if (splat_pixels(splat, first, last)) {
      float nearest = (frame.orthographic != 0 ? -splat.center.z : length(splat.center)) - splat.radius + splat.behind;
#ifdef SPLAT_PREFILTER
      nearest -= splat_prefilter_px / pixels_at(max(-splat.center.z, splat_near()));
#endif
      float farthest = 0.0;
      for (int y = first.y >> 3; y <= last.y >> 3; ++y)
        for (int x = first.x >> 3; x <= last.x >> 3; ++x)
          farthest = max(farthest, texelFetch(farthest_t, ivec2(x, y), 0).x);
      bool candidate = nearest < farthest + epsilon;
      for (ivec2 pixel = first; candidate && !visible && pixel.y <= last.y;) {
        SplatHit hit;
        // Room for a few roundings: the fragment stage, another program, has the last word.
        visible = hit_splat(splat, vec2(pixel) + 0.5, hit) &&
                  hit.t * 0.999998 < texelFetch(nearest_t, pixel, 0).x + epsilon;
        if (++pixel.x > last.x) pixel = ivec2(first.x, pixel.y + 1);
      }
    }
  }
  imageStore(flags, int(group_row() * slots_per_batch) + k, uvec4(visible));
}
#endif
