// Where the cloud is on the screen.
#pragma once

#include "core/camera.h"
#include "core/prepared_cloud.h"
#include "gl/texture.h"

namespace sfumato::layers {

/// The part of the picture that the cloud can reach, and what screen operators see beyond its border. Passes
/// over this part alone give the same picture.
struct ScreenExtent {
  static constexpr int most_reach = 64;
  Camera camera;     ///< the view of this part
  int x = 0, y = 0;  ///< its first pixel, counted in the picture: negative in the guard band

  /// `reach`: pixels that operators move or look; `point_size`: diameter of a point, in spacings.
  ScreenExtent(const PreparedCloud& prepared, const Camera& picture, float point_size, int reach);
  /// All of the picture, and so many pixels around it: the same for all parts of a cloud.
  ScreenExtent(const Camera& picture, int band);
  /// Copies what lies inside the picture.
  void copy(const gl::Texture& part, const gl::Texture& picture) const;
  /// The other way, depths: infinity in what the picture does not hold.
  void take(const gl::Texture& picture, gl::Texture& part) const;
};

}  // namespace sfumato::layers
