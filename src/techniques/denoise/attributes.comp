#ifdef FAST
#extension GL_NV_shader_atomic_float : require
#endif
// Second visit of small splats, one thread each.
#include "splat_cloud.glsl"
#include "work_groups.glsl"
#include "techniques/denoise/evidence.glsl"
#include "techniques/denoise/attributes.glsl"

layout(local_size_x = 128) in;

layout(binding = UNIT_INPUT + 2) uniform sampler2D farthest_end;
uniform bool splat_has_shadow;

void main() {
  Batch batch = visible_batch(group_row());
  int k = int(gl_GlobalInvocationID.x);
  if (k >= batch.count) return;
  int i = batch.first + k;
  Splat splat = cloud_splat(i);
  ivec2 first, last;
  if (!splat_pixels(splat, first, last)) return;
  float nearest = (frame.orthographic != 0 ? -splat.center.z : length(splat.center)) - splat.radius + splat.behind;
#ifdef SPLAT_PREFILTER
  nearest -= splat_prefilter_px / pixels_at(max(-splat.center.z, splat_near()));
#endif
  float farthest = -1.0;
  for (int y = first.y >> 3; y <= last.y >> 3; ++y)
    for (int x = first.x >> 3; x <= last.x >> 3; ++x)
      farthest = max(farthest, texelFetch(farthest_end, ivec2(x, y), 0).x);
  if (nearest > farthest) return;
  for (ivec2 pixel = first; pixel.y <= last.y;) {
    vec4 chosen = texelFetch(choice, pixel, 0);
    SplatHit hit;
    if (chosen.x >= 0.0 && hit_splat(splat, vec2(pixel) + 0.5, hit)) {
      float place = place_in_bin(pixel, hit.t, chosen.x);
      if (place >= 0.0) {
        vec4 color = vec4(point_color(i), splat_has_shadow ? point_shadow(i) : 1.0);
        bool has_normal = point_normal(i) != vec3(0.0);
        add_attributes(pixel, chosen.y, splat, has_normal, hit.rho, color, place);
      }
    }
    if (++pixel.x > last.x) pixel = ivec2(first.x, pixel.y + 1);
  }
}
