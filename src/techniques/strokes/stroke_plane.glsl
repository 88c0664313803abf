// Where the ray of a pixel position meets a stroke's plane: distance along the ray, scene units.
float plane_distance(vec2 pixel, vec3 center, vec3 normal) {
  vec3 slope = frame.orthographic != 0 ? vec3(0.0, 0.0, -1.0) : eye_from_pixel(pixel, 1.0);
  vec3 sideways = vec3(eye_from_pixel(pixel, -center.z).xy - center.xy, 0.0);
  float behind = -dot(normal, sideways) / dot(normal, slope);
  return (behind - center.z) * length(slope);
}
