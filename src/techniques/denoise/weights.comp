#ifdef FAST
#extension GL_NV_shader_atomic_float : require
#endif
// First visit of small splats, one thread each: no set-up of primitives (see passes/splat_visit.comp).
#include "splat_cloud.glsl"
#include "work_groups.glsl"
#include "techniques/denoise/evidence.glsl"
#include "techniques/denoise/weights.glsl"

layout(local_size_x = 128) in;

void main() {
  Batch batch = visible_batch(group_row());
  int k = int(gl_GlobalInvocationID.x);
  if (k >= batch.count) return;
  Splat splat = cloud_splat(batch.first + k);
  ivec2 first, last;
  if (!splat_pixels(splat, first, last)) return;
  float worth = 1.0;
#ifdef SPLAT_FIELD
  if (covers > 0.0) worth = point_field(batch.first + k) * evidence(splat);
#endif
  for (ivec2 pixel = first; pixel.y <= last.y;) {
    SplatHit hit;
    if (hit_splat(splat, vec2(pixel) + 0.5, hit)) add_weight(pixel, hit.t, splat_weight(hit.rho) * worth);
    if (++pixel.x > last.x) pixel = ivec2(first.x, pixel.y + 1);
  }
}
