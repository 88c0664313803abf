// Phong lighting with a shadow factor: c = k_a + m (k_d + k_s) (Dobrev 2010, Sec. 4), two-sided.
uniform vec4 light_eye;  // eye space; w = 1 position, w = 0 direction towards the light, w = -1 one that moves to
                         // the eye where a surface is seen edge-on: its sign there is noise, and would be seen
uniform vec4 phong;      // ambient, diffuse, specular, shininess

// `normal_eye` is unit, or 0 where unknown: then the light falls straight on. `to_eye` points to the camera.
vec3 lit_color(vec3 albedo, vec3 position_eye, vec3 normal_eye, vec3 to_eye, float shadow) {
  vec3 to_light = light_eye.w > 0.5 ? light_eye.xyz - position_eye : light_eye.xyz;
  to_light /= max(length(to_light), 1e-30);
  float diffuse = 1.0, specular = 0.0;
  if (dot(normal_eye, normal_eye) > 0.25) {
    float facing = dot(normal_eye, to_eye);
    vec3 n = facing < 0.0 ? -normal_eye : normal_eye;
    if (light_eye.w < 0.0) to_light = normalize(mix(to_eye, to_light, smoothstep(0.0, 0.5, abs(facing))));
    diffuse = max(dot(n, to_light), 0.0);
    if (diffuse > 0.0) specular = pow(max(dot(reflect(-to_light, n), to_eye), 0.0), phong.w);
  }
  return albedo * (phong.x + shadow * phong.y * diffuse) + shadow * phong.z * specular;
}
