// Where the cloud is on the screen, and how dense.
#pragma once

#include "core/camera.h"
#include "core/prepared_cloud.h"
#include "gl/texture.h"

namespace sfumato::layers {

/// Over the batches in view.
struct ScreenSpacing {
  float median_px = 1, largest_px = 0;  ///< point spacing in pixels
  float pixel = 0;                      ///< median size of a pixel where they are, scene units
};
ScreenSpacing screen_spacing(const PreparedCloud& prepared, const Camera& camera);

/// The part of the picture that the cloud can reach, and what screen operators see beyond its border. Passes
/// over this part alone give the same picture.
struct ScreenExtent {
  static constexpr int most_reach = 64;
  Camera camera;     ///< the view of this part
  int x = 0, y = 0;  ///< its first pixel, counted in the picture: negative in the guard band

  /// `reach`: pixels that operators move or look; `point_size`: diameter of a point, in spacings.
  ScreenExtent(const PreparedCloud& prepared, const Camera& picture, float point_size, int reach);
  /// Copies what lies inside the picture.
  void copy(const gl::Texture& part, const gl::Texture& picture) const;
  /// The other way, depths: infinity in what the picture does not hold.
  void take(const gl::Texture& picture, gl::Texture& part) const;
};

}  // namespace sfumato::layers
