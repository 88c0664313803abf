// 3 x 3 Gaussian over the pixels of one layer (Dobrev 2010, Sec. 3). Include after `depth_image`, `color_image`, `d_min`.

// Weight of a pixel in the Gaussian around it, by offset.
float gaussian(int x, int y) { return (x == 0 ? 2.0 : 1.0) * (y == 0 ? 2.0 : 1.0) / 16.0; }

#ifndef WEIGHTS_ONLY
// Neighbours without a sample or farther than d_min in depth do not count.
vec4 smoothed(ivec2 pixel, float depth) {
  if (isinf(depth)) return vec4(0.0);
  ivec2 size = textureSize(depth_image, 0);
  vec4 sum = vec4(0.0);
  float weights = 0.0;
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) {
      ivec2 at = pixel + ivec2(x, y);
      if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, size))) continue;
      if (!(abs(texelFetch(depth_image, at, 0).x - depth) <= d_min)) continue;
      sum += gaussian(x, y) * texelFetch(color_image, at, 0);
      weights += gaussian(x, y);
    }
  return sum / weights;
}
#endif
