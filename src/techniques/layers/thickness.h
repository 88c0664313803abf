// How deep along the view a layer is: d_min, place by place.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/camera.h"
#include "core/derived.h"
#include "core/image.h"
#include "core/progress.h"
#include "passes/gpu_cloud.h"

namespace sfumato::layers {

/// So many spacings of the points, or deviations of their noise where that is more, and so many pixels.
struct ThicknessRule {
  float spacings = 1.5f, deviations = 5, pixels = 1.25f;
  bool operator==(const ThicknessRule&) const = default;
};

class Thickness {
 public:
  /// Deviation of the points off their surfaces over their spacing, the median of a cloud; measured once.
  float noise_in_spacings(const GpuCloud& cloud, Progress& progress);
  /// Of each point, without the pixels, scene units.
  const GpuCloud::Values& of_points(const GpuCloud& cloud, const ThicknessRule& rule, Progress& progress);
  /// The same where points of all parts of a cloud are, of which `cloud` is one, in a picture; 0 where none
  /// is.
  Image<float> of_pixels(const GpuCloud& cloud, const ThicknessRule& rule, const Image<float>& depth,
                         const Camera& camera, Progress& progress) const;

 private:
  const PlacedNoise& noise_of(const GpuCloud& cloud, Progress& progress);

  struct Key {
    std::uint64_t serial;
    float spacings, deviations;
    bool operator==(const Key&) const = default;
  };
  Derived<std::uint64_t, PlacedNoise> noise_;
  Derived<Key, std::shared_ptr<const GpuCloud::Values>> values_;
};

/// What no point's thickness is below, scene units.
float least_thickness(const PreparedCloud& prepared, const ThicknessRule& rule);

}  // namespace sfumato::layers
