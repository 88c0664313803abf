#include "passes/ground.h"

namespace sfumato {

Ground ground_below(const PointCloud& cloud) {
  const Bounds box = robust_bounds(cloud, 0.005, 0.995);
  Ground ground;
  ground.normal = up_vector(cloud.up);
  ground.point = box.center();
  for (int axis = 0; axis < 3; ++axis) {
    if (ground.normal[axis] > 0) ground.point[axis] = box.min[axis];
    if (ground.normal[axis] < 0) ground.point[axis] = box.max[axis];
  }
  return ground;
}

void GroundPlane::run(const View& view, const Ground& ground, const dvec3& cloud_origin,
                      const gl::Texture& color, const gl::Texture& depth, const gl::Texture& factor,
                      const gl::Texture& out) {
  if (!pass_) pass_ = ScreenPass("passes/ground.glsl", {GL_RGBA32F});
  view.bind();
  const dvec3 point(view.eye_from_cloud() * glm::dvec4(ground.point - cloud_origin, 1));
  const dvec3 normal(view.eye_from_cloud() * glm::dvec4(ground.normal, 0));
  pass_.set("plane_eye", vec4(vec3(normal), float(-glm::dot(normal, point))));
  pass_.run({&color, &depth, &factor}, {&out});
}

}  // namespace sfumato
