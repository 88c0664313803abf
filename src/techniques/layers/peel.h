// Depth peeling of points: the nearest point of every pixel at or behind a limit, layer by layer.
#pragma once

#include "passes/flag.h"
#include "passes/points_to_pixels.h"
#include "passes/screen_pass.h"

namespace sfumato::layers {

class Peel {
 public:
  /// Whether lists for a picture of this height fit a texture.
  static bool can_cascade(const View& view);
  /// With `cascade`, a visit keeps lists of the nearest depths, and only lists that end too early cost
  /// another one; without, every layer is a visit. The layers are the same, bit by bit, for limits that are
  /// multiples of `bin`.
  void begin(const View& view, const Footprint& footprint, bool cascade, float bin);
  /// Depth (R32F, +inf where nothing) and source index (R32UI) of the points at or behind `limit` (R32F, eye
  /// depth; +inf: nothing more). Call with limits that never decrease; the first one is 0 everywhere. Returns
  /// where the depth is: in `depth`, or, with `may_be_bits`, in an R32UI of PointsToPixels that lives until
  /// the next call.
  const gl::Texture& next(GpuCloud& cloud, const View& view, const gl::Texture& limit, gl::Texture& depth,
                          gl::Texture& index, bool may_be_bits, gl::Timers& timers);
  /// Times that the depths of all points in view were computed since `begin`.
  int visits() const { return visits_; }

 private:
  void select(const View& view, const gl::Texture& limit, const gl::Texture& depth, const gl::Texture& index);
  PointsToPixels to_pixels_;
  ScreenPass decode_, select_, empty_;
  Footprint footprint_;
  bool cascade_ = false;
  float bin_ = 0;
  int visits_ = 0;
  PixelLayer layer_;
  gl::Texture depth_lists_, index_lists_, revisit_;
  Flag too_short_;
};

}  // namespace sfumato::layers
