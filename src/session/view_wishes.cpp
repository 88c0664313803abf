#include "session/view_wishes.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace sfumato {
namespace {

std::optional<double> radians(const std::optional<double>& degrees) {
  return degrees ? std::optional(glm::radians(*degrees)) : std::nullopt;
}

/// Whether it says more of where the camera stands than what suits the scan.
bool says_side(const ViewWishes& wishes) {
  return wishes.start || wishes.position || wishes.focal_point || wishes.azimuth || wishes.elevation ||
         wishes.direction || wishes.view_up;
}

/// What suits the scan, from the side that is wished for.
Camera framed(const Pose& pose, const ViewWishes& wishes) {
  const auto [width, height] = wishes.size.value_or(wishes.first_size);
  if ((pose.sensor || pose.around) && !wishes.position && !wishes.azimuth && !wishes.elevation &&
      !wishes.direction && !wishes.view_up && !wishes.orthographic)
    return first_view(pose, width, height);
  const UpAxis up = pose.upright.up;
  double azimuth = glm::radians(wishes.azimuth.value_or(pose.upright.azimuth_deg));
  double elevation = glm::radians(wishes.elevation.value_or(pose.upright.elevation_deg));
  if (wishes.direction) {
    const Compass compass(up);
    azimuth = compass.azimuth(-glm::normalize(*wishes.direction));
    elevation = compass.elevation(-glm::normalize(*wishes.direction));
  }
  // Between two given places an orthographic view is as high as the perspective one there, whatever the scan.
  const bool is_placed = wishes.position && (wishes.focal_point || wishes.look_at);
  const bool is_fitted = wishes.orthographic && !is_placed;
  Camera camera = frame(pose.subject.box, up, width, height, azimuth, elevation, glm::radians(45.0),
                        is_fitted ? Projection::orthographic : Projection::perspective);
  if (!says_side(wishes)) stand_on(camera, up, pose.vertical());
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
    look_from(camera, up, radians(wishes.azimuth), radians(wishes.elevation), !wishes.side.empty());
  if (wishes.distance) {
    const double before = glm::length(camera.target - camera.position);
    camera.position = camera.target - camera.direction() * *wishes.distance;
    camera.height_world *= *wishes.distance / before;  // a parallel view also shows less from nearer
  }
  if (glm::length(camera.target - camera.position) <= 0)
    throw Error(ErrorCode::usage, "the camera's position and the place it looks at are the same point");
  if (wishes.view_up) camera.up = *wishes.view_up;
}

/// The size of a pixel in scene units that is wished for; 0: none.
double pixel_size_of(const Pose& pose, const ViewWishes& wishes) {
  if (wishes.pixel_size) return *wishes.pixel_size;
  if (!wishes.print_scale) return 0;
  if (pose.unit.symbol == "°")
    throw Error(ErrorCode::usage,
                "--scale: the file's coordinates are degrees, which have no length on paper");
  const double metres = pose.unit.metres > 0 ? pose.unit.metres : 1;
  return *wishes.print_scale * 0.0254 / wishes.dpi.value_or(300) / metres;
}

/// A parallel view whose pixels have this size; `placed`: what it looks at stays in the middle.
void set_pixel_size(Camera& camera, const Bounds& box, double pixel, const ViewWishes& wishes) {
  make_orthographic(camera);
  const dmat4 to_world = camera.inverse_view();
  const bool placed = wishes.look_at || wishes.position || wishes.focal_point || wishes.start;
  for (const int axis : {0, 1}) {
    const dvec3 along(to_world[axis]);
    double low = 1e300, high = -1e300;
    for (const dvec3& p : box.corners())
      low = std::min(low, glm::dot(along, p)), high = std::max(high, glm::dot(along, p));
    // Borders at multiples of a pixel, so that pictures of neighbouring scans lie on one grid.
    double first = std::floor(low / pixel + 1e-6), last = std::max(first + 1, std::ceil(high / pixel - 1e-6));
    int& size = axis == 0 ? camera.width : camera.height;
    if (!wishes.size && !placed) {
      size = int(std::min(last - first, 1e6));
    } else {
      first = std::round(0.5 * (first + last - size)), last = first + size;
    }
    if (placed) continue;
    const double shift = 0.5 * (first + last) * pixel - glm::dot(along, camera.position);
    camera.position += shift * along, camera.target += shift * along;
  }
  camera.height_world = pixel * camera.height;
}

}  // namespace

dvec3 vertical_of(const Pose& pose, const ViewWishes& wishes) {
  return says_side(wishes) ? up_vector(pose.upright.up) : pose.vertical();
}

Camera view_of(const Pose& pose, const ViewWishes& wishes) {
  Camera camera = wishes.start ? *wishes.start : framed(pose, wishes);
  if (wishes.start && wishes.size) camera = camera.resized(wishes.size->first, wishes.size->second);
  if (wishes.fov) camera.fov_y = glm::radians(*wishes.fov);
  aim(camera, pose.upright.up, wishes);
  if (wishes.orthographic) make_orthographic(camera);
  if (wishes.zoom.value_or(1) != 1) magnify(camera, *wishes.zoom);
  if (wishes.roll.value_or(0) != 0) roll(camera, glm::radians(*wishes.roll));
  if (const double pixel = pixel_size_of(pose, wishes); pixel > 0)
    set_pixel_size(camera, pose.subject.box, pixel, wishes);
  return camera;
}

}  // namespace sfumato
