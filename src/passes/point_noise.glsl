// How far points lie off their surfaces.
uniform float point_noise;  // standard deviation, scene units; 0 where not measured
uniform vec4 sensor;        // of points that one sensor saw, in place of it: where, and over its distance squared; else 0

float point_noise_at(vec3 eye) {
  vec3 away = eye - sensor.xyz;
  return sensor.w > 0.0 ? sensor.w * dot(away, away) : point_noise;
}
