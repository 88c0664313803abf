// The splats of a chunk, read from the cloud's buffers; `i` counts within the chunk.
//   SPLAT_FIELD   only points whose field is above, or not above, the threshold (a NaN is not above)
#include "cloud.glsl"
#include "splat.glsl"

uniform float splat_radius_scale;
uniform float splat_radius_limit;  // scene units, before the scale
uniform float splat_widest_px;     // radius on the screen; of what would be wider nothing but a dot remains
#ifdef SPLAT_FIELD
uniform float splat_field_threshold;
uniform bool splat_field_above;
#endif

// Radius 0 where the filter or a cut leaves the point out. A point without a normal faces the camera.
Splat cloud_splat(int i) {
  vec3 position = point_position(i);
  vec3 center = (frame.eye_from_cloud * vec4(position, 1.0)).xyz;
  precise vec3 normal = mat3(frame.eye_from_cloud) * point_normal(i);
  if (dot(normal, normal) < 0.25) normal = to_camera(center);
  precise float radius = min(point_radius(i), splat_radius_limit) * splat_radius_scale;
  // Gradually, from twice as wide on, and turned to the camera: a dot has no direction.
  precise float wider = radius * pixels_at(max(-center.z, splat_near())) / splat_widest_px;
  if (wider > 1.0) {
    radius *= min(1.0, max(2.0 / wider, 0.5)) / wider;
    vec3 toward = to_camera(center);
    normal = normalize(mix(dot(normal, toward) < 0.0 ? -normal : normal, toward, clamp(wider - 2.0, 0.0, 1.0)));
  }
#ifdef SPLAT_FIELD
  if ((point_field(i) > splat_field_threshold) != splat_field_above) radius = 0.0;
#endif
  if (is_cut(position)) radius = 0.0;
  return Splat(center, normal, radius);
}
