// Shadow factors for pull-push. A point that shows through a gap in the surface in front of it is in that surface's
// shadow, and darkens what is filled around it, though the surface is lit: it takes over the mean factor of what is in
// front. Through a gap, and not beside an outline: something is in front on all four sides.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D visible;   // depth, 0, spacing, weight
layout(binding = UNIT_INPUT + 1) uniform sampler2D colors;  // and the shadow factor

layout(binding = UNIT_INPUT + 2) uniform sampler2D pyramid;  // of nearest points

uniform float gap_scale;  // how wide gaps are closed, point spacings

const int level = 4;         // of the squares that hold any window: the same for all, as software GL wants it
const float in_front = 4.0;  // point spacings: another side of a depth edge, as for clusters

bool filter_pixel(ivec2 pixel) {
  vec4 own = texelFetch(visible, pixel, 0), color = texelFetch(colors, pixel, 0);
  out_0 = color;
  if (own.w <= 0.0 || color.a >= 1.0) return true;
  int reach = clamp(int(gap_scale * own.z * pixels_at(own.x)), 1, 1 << level);
  // Nine squares hold the window: mostly nothing in them is in front.
  ivec2 square = pixel >> level, end = textureSize(pyramid, level) - 1;
  float nearest = infinity;
  for (int k = 0; k < 9; ++k) {
    vec4 point = texelFetch(pyramid, clamp(square + ivec2(k % 3, k / 3) - 1, ivec2(0), end), level);
    if (point.w > 0.0) nearest = min(nearest, -point.z);
  }
  if (own.x - nearest <= in_front * own.z) return true;
  ivec2 last = textureSize(visible, 0) - 1;
  vec2 factors = vec2(0.0);  // their sum, and how many they are
  int sides = 0;
  for (int y = -reach; y <= reach; ++y)
    for (int x = -reach; x <= reach; ++x) {
      ivec2 at = clamp(pixel + ivec2(x, y), ivec2(0), last);
      vec4 other = texelFetch(visible, at, 0);
      if (other.w <= 0.0 || own.x - other.x <= in_front * own.z) continue;
      factors += vec2(texelFetch(colors, at, 0).a, 1.0);
      sides |= 1 << (abs(x) > abs(y) ? (x > 0 ? 0 : 1) : (y > 0 ? 2 : 3));
    }
  if (sides == 15) out_0.a = max(color.a, factors.x / factors.y);
  return true;
}
