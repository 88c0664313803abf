#include "passes/view.h"

#include "passes/bindings.h"

namespace sfumato {
namespace {

struct Block {  // std140, as in shaders/frame.glsl
  mat4 eye_from_cloud, cloud_from_eye, clip_from_eye;
  vec4 intrinsics;
  vec2 image_size;
  float near_plane, far_plane;
  int orthographic;
  float pixels_per_unit;
  vec2 tile_origin, picture_size;
};

}  // namespace

View::View(const Camera& camera, const dvec3& cloud_origin)
    : camera_(camera), eye_from_cloud_(camera.view(cloud_origin)) {
  const Intrinsics k = camera.whole_intrinsics();
  const dmat4 clip_from_eye = camera.projection_matrix();
  Block block{};
  block.eye_from_cloud = mat4(eye_from_cloud_);
  block.cloud_from_eye = mat4(glm::inverse(eye_from_cloud_));
  block.clip_from_eye = mat4(clip_from_eye);
  block.intrinsics = vec4(k.fx, k.fy, k.cx, k.cy);
  block.image_size = vec2(camera.width, camera.height);
  block.near_plane = float(camera.near_plane);
  block.far_plane = float(camera.far_plane);
  block.orthographic = camera.orthographic();
  block.pixels_per_unit = float(camera.pixels_per_unit());
  block.tile_origin = vec2(camera.tile_origin());
  block.picture_size = vec2(camera.whole_width(), camera.whole_height());
  block_ = gl::Buffer("frame block", sizeof block, &block);

  const dmat4 rows = glm::transpose(clip_from_eye * eye_from_cloud_);
  for (int axis = 0; axis < 3; ++axis) {
    planes_[2 * axis] = rows[3] + rows[axis];
    planes_[2 * axis + 1] = rows[3] - rows[axis];
  }
}

void View::bind() const { block_.bind_uniform(binding::frame); }

bool View::may_see(const vec3& lo, const vec3& hi) const {
  for (const glm::dvec4& plane : planes_) {
    const dvec3 farthest{plane.x > 0 ? hi.x : lo.x, plane.y > 0 ? hi.y : lo.y, plane.z > 0 ? hi.z : lo.z};
    if (glm::dot(dvec3(plane), farthest) + plane.w < 0) return false;
  }
  return true;
}

}  // namespace sfumato
