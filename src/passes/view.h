// The uniform block that shaders know as `frame` (shaders/frame.glsl), for one camera and one cloud origin.
#pragma once

#include "core/camera.h"
#include "gl/buffer.h"

namespace sfumato {

class View {
 public:
  View(const Camera& camera, const dvec3& cloud_origin);
  void bind() const;
  const Camera& camera() const { return camera_; }
  int width() const { return camera_.width; }
  int height() const { return camera_.height; }
  /// Of the picture that this is a tile of, or this one: what sizes in shares of a picture's height refer to.
  int picture_height() const { return camera_.whole_height(); }
  const dmat4& eye_from_cloud() const { return eye_from_cloud_; }
  /// False when the box (cloud space) is certainly outside the view.
  bool may_see(const vec3& box_min, const vec3& box_max) const;

 private:
  Camera camera_;
  dmat4 eye_from_cloud_;
  glm::dvec4 planes_[6];  // in cloud space, inside is positive
  gl::Buffer block_;
};

}  // namespace sfumato
