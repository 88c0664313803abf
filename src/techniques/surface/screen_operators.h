// The operators of `surface` on the screen, apart from the shared pyramids: which pixels are holes, and
// normals of several sizes.
#pragma once

#include <vector>

#include "passes/pyramid.h"
#include "passes/view.h"

namespace sfumato::surface {

enum class Removal { pyramid, window, none };

/// Hidden point removal (Bouchiba 2018, Sec. 3.1.2).
class HiddenPoints {
 public:
  struct Options {
    Removal method = Removal::pyramid;  ///< `none` finds holes like `pyramid`
    float threshold = 0.1f;             ///< mean occlusion below which a pixel is a hole
    int coarse_level = 4;
    float removal_scale = 10;  ///< s_hpr / s_0
    float gap_scale = 5;       ///< the same for pixels without a point: how wide gaps are closed
    float disc_radius =
        0.65f;  ///< what lies behind a point within this many spacings on the screen is hidden
    /// A level whose squares are as wide as the radius of any disc on the screen: discs need no coarser ones.
    int disc_level = NearestPyramid::levels - 1;
    int window_radius = 25;  ///< px
    bool holes = true;       ///< pixels without a point as well
    bool count_fetches = false;
    float point_threshold() const { return method == Removal::none ? -1 : threshold; }
  };
  /// The view is bound.
  void run(const NearestPyramid& pyramid, const Options& options);
  /// For squares of 2x2 px instead of pixels, each with its nearest point. Gaps and discs are left out.
  void run_squares(const NearestPyramid& pyramid, Options options);
  /// Mean occlusion of every pixel, R32F, 0 hidden .. 2 open.
  const gl::Texture& mean() const { return mean_; }
  /// RGBA32F: eye depth, 0, point spacing and 1 where there is a visible point, else 0.
  const gl::Texture& visible() const { return visible_; }
  /// Where there is more than open sky, after `run`: every point, and all that it may close or hide.
  Tiles tiles() const { return {tiles_, 1 << tile_level_}; }
  /// R32F, 1 / 2^coarse_level of the size: the level of Eq. 1.
  const gl::Texture& levels() const { return level_; }
  /// R32F: neighbours that were read, when asked for.
  const gl::Texture& fetches() const { return fetches_; }

 private:
  void run(const gl::Texture& points, const gl::Texture& coarse, int levels, const Options& options);
  int tile_level_ = 5;  // of 32 px
  gl::Texture level_, tiles_, mean_, visible_, fetches_;
  ScreenPass choose_level_, find_tiles_, removal_[8];
};

/// Normals of every push level (Bouchiba 2018, Sec. 3.3), for a trilinear lookup.
class LevelNormals {
 public:
  /// RGBA32F with levels: eye-space unit normals of the depths in `filled` (`a.x`), levels first..last only.
  /// The view is bound.
  const gl::Texture& run(const std::vector<PullPush::Level>& filled, int first, int last);
  const gl::Texture& level(int l) const { return views_[std::size_t(l)]; }

 private:
  gl::Texture storage_;
  std::vector<gl::Texture> views_;
  ScreenPass pass_;
};

}  // namespace sfumato::surface
