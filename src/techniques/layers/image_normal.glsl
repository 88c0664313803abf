// Normals of a layer from its depth image, for clouds without: a plane by least squares through 5 x 5 pixels that
// belong to the same layer. They are as far apart as the points, two spacings to each side and at least two pixels,
// so that a plane sees several points: each is a disc of that size, whose own depths say nothing of the surface.
// Include after `depth_image` and `spacing`.

// World normal towards the camera, or 0 where too few pixels belong together.
vec3 image_normal(ivec2 pixel, float depth, float thickness) {
  ivec2 size = textureSize(depth_image, 0);
  int stride = clamp(int(spacing * pixels_at(depth) + 0.5), 1, 64);
  // Depth = c + g . (x, y); moments of the neighbours relative to this pixel.
  float n = 0.0, z = 0.0;
  vec2 p = vec2(0.0), pz = vec2(0.0);
  vec3 pp = vec3(0.0);  // xx, xy, yy
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x) {
      ivec2 at = pixel + stride * ivec2(x, y);
      if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, size))) continue;
      float away = texelFetch(depth_image, at, 0).x - depth;
      if (!(abs(away) <= thickness)) continue;
      vec2 o = vec2(x, y);
      n += 1.0;
      z += away;
      p += o;
      pz += o * away;
      pp += vec3(o.x * o.x, o.x * o.y, o.y * o.y);
    }
  vec3 c = pp - vec3(p.x * p.x, p.x * p.y, p.y * p.y) / n;
  vec2 cz = pz - p * z / n;
  float determinant = c.x * c.z - c.y * c.y;
  if (!(determinant > 0.5)) return vec3(0.0);  // on one line, or alone
  vec2 g = vec2(c.z * cz.x - c.y * cz.y, c.x * cz.y - c.y * cz.x) / (determinant * float(stride));

  // Derivatives of the eye position along x and y of the image.
  vec3 position = eye_from_pixel(vec2(pixel) + 0.5, depth);
  vec2 focal = vec2(frame.intrinsics.x, -frame.intrinsics.y);
  vec3 dx, dy;
  if (frame.orthographic != 0) {
    dx = vec3(1.0 / focal.x, 0.0, -g.x);
    dy = vec3(0.0, 1.0 / focal.y, -g.y);
  } else {
    vec3 slope = vec3(position.xy / depth, -1.0);
    dx = slope * g.x + vec3(depth / focal.x, 0.0, 0.0);
    dy = slope * g.y + vec3(0.0, depth / focal.y, 0.0);
  }
  vec3 normal = normalize(cross(dx, dy));
  if (dot(normal, to_camera(position)) < 0.0) normal = -normal;
  return mat3(frame.cloud_from_eye) * normal;
}
