// Hole filling on the screen (Rosenthal and Linsen 2008, as used by Dobrev, Rosenthal, Linsen 2010): a pixel
// takes over its nearest neighbour unless it looks like a place beyond an outline.
#pragma once

#include <initializer_list>

#include "gl/texture.h"
#include "passes/screen_pass.h"

namespace sfumato {

enum class FillKind {
  background,  ///< candidates: pixels without a sample
  occluded,    ///< candidates: pixels that show something more than d_min behind their neighbours
  gaps,        ///< both at once, for who needs no more than that no gap stays open
};

class Fill {
 public:
  /// Reads `depth_in` (R32F, +inf where nothing, or the R32UI that PointsToPixels leaves), writes `depth_out`
  /// (R32F); `extra_in[k]` (RGBA32F) follow the same choice into `extra_out[k]`, at most two. Outside the
  /// image counts as background.
  void run(FillKind kind, float d_min, const gl::Texture& depth_in, const gl::Texture& depth_out,
           std::initializer_list<const gl::Texture*> extra_in = {},
           std::initializer_list<const gl::Texture*> extra_out = {});
  /// The same with source indices (R32UI) following: attributes are fetched once, after all iterations.
  void run_index(FillKind kind, float d_min, const gl::Texture& depth_in, const gl::Texture& depth_out,
                 const gl::Texture& index_in, const gl::Texture& index_out);

 private:
  ScreenPass passes_[6][3], index_passes_[6];
};

}  // namespace sfumato
