// Which pixels of a layer lie on an edge. Include after `depth_image` and `d_min`.

// Beyond the border the border goes on: it is empty, or farther out than the picture's operators look
// (ScreenExtent).
ivec2 clamped(ivec2 at) { return clamp(at, ivec2(0), textureSize(depth_image, 0) - 1); }
float depth_at(ivec2 at) { return texelFetch(depth_image, clamped(at), 0).x; }

// One of its four neighbours lies more than d_min nearer or farther; background: infinitely far.
bool is_edge(ivec2 pixel, float depth) {
  bool is_marked = false;
  const ivec2 cross_of_four[4] = ivec2[4](ivec2(1, 0), ivec2(-1, 0), ivec2(0, 1), ivec2(0, -1));
  for (int k = 0; k < 4; ++k) {
    float neighbor = depth_at(pixel + cross_of_four[k]);
    // Not the absolute difference: infinity minus infinity is no jump.
    is_marked = is_marked || max(depth, neighbor) > min(depth, neighbor) + d_min;
  }
  return is_marked;
}
