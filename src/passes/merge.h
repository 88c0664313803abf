// Several pictures of one view become one, by depth.
#pragma once

#include "passes/frame.h"
#include "passes/screen_pass.h"
#include "passes/view.h"

namespace sfumato {

class Merge {
 public:
  /// Of two pictures the nearer surface of each pixel, blended over the other where its edge covers a part
  /// (premultiplied colours). `target` and `other` have one size; the result is in `target`. Without normals,
  /// its normals stay.
  void run(const Target& other, Target& target, bool with_normals);
  /// Ray distances (R32F, passes/splat_surface.h) become those of `depth` (R32F, eye depth) where it is
  /// nearer.
  void limit(const View& view, const gl::Texture& depth, gl::Texture& ray_distance);

 private:
  ScreenPass nearer_[2], limit_;
  Target scratch_;
  gl::Texture distance_;
};

}  // namespace sfumato
