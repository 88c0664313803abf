// The last steps of every picture: relief, smooth outlines, background, linear to sRGB.
#pragma once

#include "core/image.h"
#include "gl/texture.h"
#include "gl/timer.h"
#include "passes/light.h"
#include "passes/relief.h"
#include "passes/screen_pass.h"
#include "passes/view.h"

namespace sfumato {

/// Antialiases outlines and depth edges (Reshetov 2009, "Morphological Antialiasing");
/// coverage in alpha follows. Reads all of `color` and `depth`, writes `out`.
class SmoothOutlines {
 public:
  void run(const View& view, const gl::Texture& color, const gl::Texture& depth, const gl::Texture& out);

 private:
  ScreenPass find_edges_, smooth_;
  gl::Texture edges_;
  PixelMask mask_;
};

/// Relief and smooth outlines in place, by the processor where OpenGL is software. Normals are read for
/// radiance scaling.
class PostProcessing {
 public:
  void run(const View& view, const Relief::Options& relief, bool with_smooth_outlines, gl::Texture& color,
           const gl::Texture& depth, const gl::Texture& normal, gl::Timers& timers);

 private:
  Relief relief_;
  SmoothOutlines outlines_;
  gl::Texture scratch_;
};

/// Background and encoding, by the processor where OpenGL is software. `color` is linear and premultiplied.
class Finish {
 public:
  /// `rgba8`: sRGB, straight alpha.
  void run(const RenderSettings& settings, const gl::Texture& color, gl::Texture& rgba8);
  /// `linear`: RGBA32F premultiplied over the background (alpha 1) or without one.
  void run_linear(const RenderSettings& settings, const gl::Texture& color, const gl::Texture& linear);

 private:
  ScreenPass encode_, linear_;
};

}  // namespace sfumato
