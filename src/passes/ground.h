// A shadow-catching plane under the cloud: on a white page only the shadow is seen, on a transparent one the
// shadow is darkness with its own alpha.
#pragma once

#include "gl/texture.h"
#include "passes/screen_pass.h"
#include "passes/shadows.h"

namespace sfumato {

/// The plane at the cloud's lowest points (0.5 % quantile along up: an outlier must not lower it).
Ground ground_below(const PointCloud& cloud);

class GroundPlane {
 public:
  /// Puts the shadow of `factor` (R32F, 1 lit) under `color` (premultiplied) where the plane is seen in front
  /// of nothing or of what lies behind it.
  void run(const View& view, const Ground& ground, const dvec3& cloud_origin, const gl::Texture& color,
           const gl::Texture& depth, const gl::Texture& factor, const gl::Texture& out);

 private:
  ScreenPass pass_;
};

}  // namespace sfumato
