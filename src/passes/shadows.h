// Point cloud shadow textures (Dobrev, Rosenthal, Linsen 2010, Sec. 4): a light map of the points, closed by the
// occluded-pixel filter, and a lit test for every point; averaged over samples of the light's disc. One value per
// point, so that every technique darkens through the shared shading pass.
#pragma once

#include <string>
#include <vector>

#include "core/camera.h"
#include "core/progress.h"
#include "passes/fill.h"
#include "passes/gpu_cloud.h"
#include "passes/light.h"
#include "passes/points_to_pixels.h"

namespace sfumato {

/// The plane that catches shadows under a cloud: world, `normal` is up.
struct Ground {
  dvec3 point{0}, normal{0, 0, 1};
};

class ShadowMaps {
 public:
  /// Gives the cloud its shadow factors; keeps them while cloud, light and settings stay. With `ground`, also fills
  /// `ground_factor` (R32F, the view's size): the shadow factor of the ground seen by each pixel.
  void update(GpuCloud& cloud, const RenderSettings& settings, const Light& light, gl::Timers& timers,
              Progress& progress, const View* ground_view = nullptr, const Ground& ground = {},
              gl::Texture* ground_factor = nullptr);
  void clear(GpuCloud& cloud);

  /// Cameras that see the whole cloud from the light: one, or six faces when it stands inside.
  static std::vector<Camera> light_cameras(const Light& light, const Bounds& box, double texel);
  /// Seeded positions of the light on its disc, perpendicular to its direction; sample 0 is the centre.
  static std::vector<Light> light_samples(const Light& light, const Bounds& box, double size, int count);
  /// Side of a texel of the light map: with 1.5 spacings a texel holds 2.25 points on average and is empty in
  /// exp(-2.25) = 11 % of the cases, which one pass of the filter closes.
  static constexpr double texel_spacings = 1.5;

 private:
  void accumulate(GpuCloud& cloud, const Camera& light_camera, float d_min, float share, gl::Timers& timers,
                  const View* ground_view, const Ground& ground, gl::Texture* ground_factor);
  PointsToPixels to_pixels_;
  Fill fill_;
  ScreenPass decode_, ground_pass_;
  gl::Program lit_test_;
  gl::Texture bits_, map_, closed_;
  std::string key_;  ///< what the cloud's factors were computed for
};

}  // namespace sfumato
