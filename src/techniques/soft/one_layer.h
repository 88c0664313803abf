// The baseline: only the first layer of soft points is transparent, everything behind it opaque (Seemann
// 2018, Sec. 5.3).
#pragma once

#include "passes/frame.h"
#include "passes/merge.h"
#include "passes/shade.h"
#include "passes/splat_surface.h"

namespace sfumato::soft {

class OneLayer {
 public:
  /// Draws the whole picture into the frame's target. `shape` says which points are soft (part = above).
  void draw(Frame& frame, const View& view, SplatShape shape, const SplatBlend& blend, float opacity);

 private:
  SplatSurface front_;
  SplatRaster nearest_, accumulate_[4];
  ScreenPass normalize_, over_;
  gl::Texture front_albedo_, front_depth_, front_normal_, front_color_;
  gl::Texture nearest_t_, color_sum_, normal_sum_, shadow_sum_, albedo_, behind_color_;
  Shade shade_;
  Merge merge_;
};

}  // namespace sfumato::soft
