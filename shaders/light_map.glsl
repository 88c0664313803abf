// Whether a light map holds what the light sees in that direction, which is divided by `depth`. Products are compared, not
// quotients: what lies on an edge of the cube around a light is in one of its maps, however a driver divides.
bool is_in_map(vec3 eye, float depth, vec4 intrinsics, vec2 size) {
  precise vec2 at = intrinsics.xy * vec2(eye.x, -eye.y);
  precise vec2 first = -intrinsics.zw * depth;
  precise vec2 last = (size - intrinsics.zw) * depth;
  return all(greaterThanEqual(at, first)) && all(lessThan(at, last));
}
