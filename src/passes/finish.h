// The last steps of every picture: eye-dome lighting, smooth outlines, background, linear to sRGB.
#pragma once

#include "gl/texture.h"
#include "passes/light.h"
#include "passes/screen_pass.h"
#include "passes/view.h"

namespace sfumato {

/// Eye-dome lighting (Boucheny 2009), with the radius and strength that Potree users know. Darkens pixels
/// that lie behind their neighbours, a step of any height alike; background neighbours do not count.
class EyeDomeLighting {
 public:
  /// `spacing`: of the points between which a surface was closed, scene units: where they are far apart on
  /// the screen, lower steps are none of theirs; 0 where nothing was closed. `noise`: standard deviation of
  /// the points off their surfaces, scene units: steps up to three times that are none either.
  void run(const View& view, const RenderSettings& settings, float spacing, float noise,
           const gl::Texture& color, const gl::Texture& depth, const gl::Texture& out);

 private:
  ScreenPass pass_;
};

/// Antialiases outlines and depth edges (Reshetov 2009, "Morphological Antialiasing");
/// coverage in alpha follows. Reads all of `color` and `depth`, writes `out`.
class SmoothOutlines {
 public:
  void run(const View& view, const gl::Texture& color, const gl::Texture& depth, const gl::Texture& out);

 private:
  ScreenPass find_edges_, smooth_;
  gl::Texture edges_;
};

/// Background and encoding. `color` is linear and premultiplied.
class Finish {
 public:
  /// `rgba8`: sRGB, straight alpha.
  void run(const RenderSettings& settings, const gl::Texture& color, const gl::Texture& rgba8);
  /// `linear`: RGBA32F premultiplied over the background (alpha 1) or without one.
  void run_linear(const RenderSettings& settings, const gl::Texture& color, const gl::Texture& linear);

  /// Sets the uniforms of shaders/finished.glsl, for a pass that writes the picture itself.
  static void set(ScreenPass& pass, const RenderSettings& settings);

 private:
  ScreenPass encode_, linear_;
};

}  // namespace sfumato
