// The splats of a chunk, read from the cloud's buffers; `i` counts within the chunk.
//   SPLAT_FIELD   only points whose field is above, or not above, the threshold (a NaN is not above)
#include "cloud.glsl"
#include "splat.glsl"

uniform float splat_radius_scale;
uniform float splat_radius_limit;  // scene units, before the scale
uniform float splat_widest_px;     // radius on the screen; of what would be wider nothing but a dot remains
uniform vec2 splat_behind;         // of the far side of a thin sheet, as Splat::behind: scene units, radii
uniform bool splat_dots;           // what no neighbours vouch for is a dot
const vec2 closing = vec2(2.0, 4.0);  // in those: discs of 1.7 spacings close a grid up to 1.2 spacings beyond
const float dot_share = 0.3125;        // 2.5 of 8 px
#ifdef SPLAT_FIELD
uniform float splat_field_threshold;
uniform bool splat_field_above;
#endif

// Radius 0 where the filter or a cut leaves the point out. A point without a normal faces the camera.
Splat cloud_splat(int i) {
  vec3 position = point_position(i);
  vec3 center = (frame.eye_from_cloud * vec4(position, 1.0)).xyz;
  precise vec3 normal = mat3(frame.eye_from_cloud) * point_normal(i);
  precise float facing = dot(normal, to_camera(center));  // the same in every pass, whoever compiles it
  bool is_far_side = point_is_on_side(i) && facing < 0.0;
  if (dot(normal, normal) < 0.25) normal = to_camera(center);
  precise float radius = min(point_radius(i), splat_radius_limit) * splat_radius_scale;
  // Gradually: no more than a dot is what nobody vouches for, and what is so far from all others that it makes no surface
  // to whoever looks; turned to the camera, for a dot has no direction.
  precise float wider = radius * pixels_at(max(-center.z, splat_near())) / splat_widest_px;
  precise float surface = (splat_dots ? point_surface(i) : 1.0) * (1.0 - smoothstep(closing.x, closing.y, wider));
  precise float most = surface < 1.0 ? min(1.0, dot_share / (1.0 - surface)) : 1.0;
  if (wider > most) radius *= most / wider;
  if (surface < 1.0) {
    vec3 toward = to_camera(center);
    normal = normalize(mix(toward, dot(normal, toward) < 0.0 ? -normal : normal, surface));
  }
#ifdef SPLAT_FIELD
  if ((point_field(i) > splat_field_threshold) != splat_field_above) radius = 0.0;
#endif
  if (is_cut(position)) radius = 0.0;
  return Splat(center, normal, radius, is_far_side ? max(splat_behind.x, splat_behind.y * radius) : 0.0);
}
