#include "session/view_wishes.h"

#include "core/error.h"

namespace sfumato {
namespace {

std::optional<double> radians(const std::optional<double>& degrees) {
  return degrees ? std::optional(glm::radians(*degrees)) : std::nullopt;
}

/// What suits the scan, from the side that is wished for.
Camera framed(const Pose& pose, const ViewWishes& wishes) {
  const UpAxis up = pose.upright.up;
  double azimuth = glm::radians(wishes.azimuth.value_or(pose.upright.azimuth_deg));
  double elevation = glm::radians(wishes.elevation.value_or(pose.upright.elevation_deg));
  if (wishes.direction) {
    const Compass compass(up);
    azimuth = compass.azimuth(-glm::normalize(*wishes.direction));
    elevation = compass.elevation(-glm::normalize(*wishes.direction));
  }
  const auto [width, height] = wishes.size.value_or(wishes.first_size);
  Camera camera = frame(pose.subject.box, up, width, height, azimuth, elevation, glm::radians(45.0),
                        wishes.orthographic ? Projection::orthographic : Projection::perspective);
  if (wishes.view_up) camera.up = *wishes.view_up;
  fit(camera, pose.subject);
  return camera;
}

void aim(Camera& camera, UpAxis up, const ViewWishes& wishes) {
  const double reach_before = glm::length(camera.target - camera.position);
  if (wishes.position) camera.position = *wishes.position;
  if (wishes.focal_point) camera.target = *wishes.focal_point;
  if (wishes.look_at) {
    if (!wishes.position) camera.position += *wishes.look_at - camera.target;
    camera.target = *wishes.look_at;
  }
  if (wishes.direction) {
    const dvec3 along = glm::normalize(*wishes.direction);
    if (wishes.position)
      camera.target = camera.position + along * reach_before;
    else
      camera.position = camera.target - along * glm::length(camera.target - camera.position);
  }
  if (wishes.azimuth || wishes.elevation)
    look_from(camera, up, radians(wishes.azimuth), radians(wishes.elevation), wishes.upright);
  if (wishes.distance) {
    const double before = glm::length(camera.target - camera.position);
    camera.position = camera.target - camera.direction() * *wishes.distance;
    camera.height_world *= *wishes.distance / before;  // a parallel view also shows less from nearer
  }
  if (glm::length(camera.target - camera.position) <= 0)
    throw Error(ErrorCode::usage, "the camera's position and the place it looks at are the same point");
  if (wishes.view_up) camera.up = *wishes.view_up;
}

}  // namespace

Camera view_of(const Pose& pose, const ViewWishes& wishes) {
  Camera camera = wishes.start ? *wishes.start : framed(pose, wishes);
  if (wishes.start && wishes.size) camera = camera.resized(wishes.size->first, wishes.size->second);
  if (wishes.fov) camera.fov_y = glm::radians(*wishes.fov);
  aim(camera, pose.upright.up, wishes);
  if (wishes.orthographic) make_orthographic(camera);
  if (wishes.zoom != 1) magnify(camera, wishes.zoom);
  if (wishes.roll != 0) roll(camera, glm::radians(wishes.roll));
  return camera;
}

}  // namespace sfumato
