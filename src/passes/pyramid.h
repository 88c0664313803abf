// Pyramids over the screen: the nearest point of ever larger squares, and pull-push, which floods an image
// from scattered samples. Both are shared by techniques that work on the image alone.
#pragma once

#include <vector>

#include "gl/texture.h"
#include "passes/screen_pass.h"

namespace sfumato {

/// Min pyramid of eye positions (Bouchiba 2018, Sec. 3.1.1): a texel of level l holds the whole position of
/// the nearest point among its 2x2 children of level l - 1. RGBA32F: xyz = eye position, w = point spacing of
/// that point, 0 where the square holds no point (then z = -3e38, behind everything).
class NearestPyramid {
 public:
  static constexpr int levels = 7;
  /// Sizes that halve exactly down to the last level: what `size` has to be padded to.
  static int padded(int size) { return (size + (1 << (levels - 1)) - 1) >> (levels - 1) << (levels - 1); }

  /// Level 0, to be filled before `build`; of a padded size.
  gl::Texture& points(int width, int height);
  void build();
  /// All levels, for texelFetch with a level.
  const gl::Texture& texture() const { return storage_; }
  const gl::Texture& level(int l) const { return views_[std::size_t(l)]; }
  /// All levels but the finest, as a texture of their own: its level 0 are squares of 2x2 px.
  const gl::Texture& squares() const { return squares_; }

 private:
  gl::Texture storage_, squares_;
  std::vector<gl::Texture> views_;
  ScreenPass reduce_;
};

/// Weighted pull-push (Gortler 1996; Kraus 2009) of two images that share their weights: fine to coarse with
/// the normalised 4x4 kernel (1 3 3 1) and the weight gained and clamped, w' = min(1, 4 W); coarse to fine
/// y_l = x_l + (1 - w_l) B(y_{l+1}) with bilinear B. Samples of weight 1 come back unchanged.
class PullPush {
 public:
  struct Level {
    gl::Texture a, b;  ///< RGBA32F
  };
  explicit PullPush(ScreenPassKind kind = ScreenPassKind::automatic) : kind_(kind) {}
  /// `a` = (x y z) w and the weight w; `b` = (p q r s), not multiplied, of the same weight and size.
  /// With `depth_edge` > 0, `a.x` is an eye depth, and samples do not mix across a jump of depth that is
  /// steeper than this slope (depth over width); the side with more weight decides. The view is bound then.
  /// Levels finer than `first` are not filled: a pass over the picture may do that step itself (shaders/
  /// push_level.glsl) and save a round trip through memory. With `tiles`, `a` is 0 within a tile's size
  /// around those that are off, and nobody looks up what is filled there: the finest levels stay 0 in them.
  void run(const gl::Texture& a, const gl::Texture& b, float depth_edge = 0, int first = 0,
           const Tiles* tiles = nullptr);
  /// Filled levels, finest first; level l is ceil(size / 2^l). `a.w` is 1 unless there was no sample at all.
  std::vector<Level>& filled() { return filled_; }

 private:
  void allocate(int width, int height);
  void pull(const gl::Texture& fine_a, const gl::Texture& fine_b, int level, const Tiles* tiles);
  void push(const gl::Texture& pulled_a, const gl::Texture& pulled_b, int level, const Tiles* tiles);
  ScreenPassKind kind_;
  std::vector<Level> pulled_, filled_;  // level 0 of what is pulled are the caller's
  ScreenPass pull_, push_;
};

}  // namespace sfumato
