// Rays of cameras and scanners, and the two ways of sampling a scene.
#pragma once

#include "synth/synth.h"

namespace sfumato::synth {

/// Camera rays with the matrices worked out once.
class CameraRays {
 public:
  explicit CameraRays(const Camera& camera)
      : k_(camera.intrinsics()),
        to_world_(camera.inverse_view()),
        direction_(camera.direction()),
        orthographic_(camera.orthographic()) {}

  /// Through a place of the picture in pixels; from the camera, or from the plane of eye depth 0.
  Ray through(double x_px, double y_px) const {
    const double x = (x_px - k_.cx) / k_.fx, y = -(y_px - k_.cy) / k_.fy;
    if (orthographic_) return {dvec3(to_world_ * glm::dvec4(x, y, 0, 1)), direction_};
    return {dvec3(to_world_[3]), glm::normalize(dvec3(to_world_ * glm::dvec4(x, y, -1, 0)))};
  }
  dvec3 direction() const { return direction_; }

 private:
  Intrinsics k_;
  dmat4 to_world_;
  dvec3 direction_;
  bool orthographic_;
};

PointCloud sample_area(const Scene& scene, const SampleOptions& options, Progress& progress);
PointCloud sample_airborne(const Scene& scene, const SampleOptions& options, Progress& progress);
PointCloud sample_devices(const Scene& scene, const SampleOptions& options, Progress& progress);

}  // namespace sfumato::synth
