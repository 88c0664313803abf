#include "session/camera_request.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace sfumato {
namespace {

std::optional<double> radians(const std::optional<double>& degrees) {
  return degrees ? std::optional(glm::radians(*degrees)) : std::nullopt;
}

/// Whether it says more of where the camera stands than what suits the scan.
bool says_side(const CameraRequest& request) {
  return request.start || request.position || request.focal_point || request.azimuth || request.elevation ||
         request.direction || request.view_up;
}

/// What suits the scan, from the side that is asked for.
Camera framed(const Pose& pose, const CameraRequest& request) {
  const auto [width, height] = request.size.value_or(request.first_size);
  if ((pose.sensor || pose.around) && !request.position && !request.azimuth && !request.elevation &&
      !request.direction && !request.view_up && !request.orthographic)
    return first_view(pose, width, height);
  const UpAxis up = pose.upright.up;
  double azimuth = glm::radians(request.azimuth.value_or(pose.upright.azimuth_deg));
  double elevation = glm::radians(request.elevation.value_or(pose.upright.elevation_deg));
  if (request.direction) {
    const Compass compass(up);
    azimuth = compass.azimuth(-glm::normalize(*request.direction));
    elevation = compass.elevation(-glm::normalize(*request.direction));
  }
  // Between two given places an orthographic view is as high as the perspective one there, whatever the scan.
  const bool is_placed = request.position && (request.focal_point || request.look_at);
  const bool is_fitted = request.orthographic && !is_placed;
  Camera camera = frame(pose.subject.box, up, width, height, azimuth, elevation, glm::radians(45.0),
                        is_fitted ? Projection::orthographic : Projection::perspective);
  if (!says_side(request)) stand_on(camera, up, pose.vertical());
  if (request.view_up) camera.up = *request.view_up;
  fit(camera, pose.subject);
  return camera;
}

void aim(Camera& camera, UpAxis up, const CameraRequest& request) {
  const double reach_before = glm::length(camera.target - camera.position);
  if (request.position) camera.position = *request.position;
  if (request.focal_point) camera.target = *request.focal_point;
  if (request.look_at) {
    if (!request.position) camera.position += *request.look_at - camera.target;
    camera.target = *request.look_at;
  }
  if (request.direction) {
    const dvec3 along = glm::normalize(*request.direction);
    if (request.position)
      camera.target = camera.position + along * reach_before;
    else
      camera.position = camera.target - along * glm::length(camera.target - camera.position);
  }
  if (request.azimuth || request.elevation)
    look_from(camera, up, radians(request.azimuth), radians(request.elevation), !request.side.empty());
  if (request.distance) {
    const double before = glm::length(camera.target - camera.position);
    camera.position = camera.target - camera.direction() * *request.distance;
    camera.height_world *= *request.distance / before;  // a parallel view also shows less from nearer
  }
  if (glm::length(camera.target - camera.position) <= 0)
    throw Error(ErrorCode::usage, "the camera's position and the place it looks at are the same point");
  if (request.view_up) camera.up = *request.view_up;
}

/// The size of a pixel in scene units that is asked for; 0: none.
double pixel_size_of(const Pose& pose, const CameraRequest& request) {
  if (request.pixel_size) return *request.pixel_size;
  if (!request.print_scale) return 0;
  if (pose.unit.symbol == "°")
    throw Error(ErrorCode::usage,
                "--scale: the file's coordinates are degrees, which have no length on paper");
  const double metres = pose.unit.metres > 0 ? pose.unit.metres : 1;
  return *request.print_scale * 0.0254 / request.dpi.value_or(300) / metres;
}

/// A parallel view whose pixels have this size; `placed`: what it looks at stays in the middle.
void set_pixel_size(Camera& camera, const Bounds& box, double pixel, const CameraRequest& request) {
  make_orthographic(camera);
  const dmat4 to_world = camera.inverse_view();
  const bool placed = request.look_at || request.position || request.focal_point || request.start;
  for (const int axis : {0, 1}) {
    const dvec3 along(to_world[axis]);
    double low = 1e300, high = -1e300;
    for (const dvec3& p : box.corners())
      low = std::min(low, glm::dot(along, p)), high = std::max(high, glm::dot(along, p));
    // Borders at multiples of a pixel, so that pictures of neighbouring scans lie on one grid.
    double first = std::floor(low / pixel + 1e-6), last = std::max(first + 1, std::ceil(high / pixel - 1e-6));
    int& size = axis == 0 ? camera.width : camera.height;
    if (!request.size && !placed) {
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

dvec3 vertical_of(const Pose& pose, const CameraRequest& request) {
  return says_side(request) ? up_vector(pose.upright.up) : pose.vertical();
}

Camera view_of(const Pose& pose, const CameraRequest& request) {
  Camera camera = request.start ? *request.start : framed(pose, request);
  if (request.start && request.size) camera = camera.resized(request.size->first, request.size->second);
  if (request.fov) camera.fov_y = glm::radians(*request.fov);
  aim(camera, pose.upright.up, request);
  if (request.orthographic) make_orthographic(camera);
  if (request.zoom.value_or(1) != 1) magnify(camera, *request.zoom);
  if (request.roll.value_or(0) != 0) roll(camera, glm::radians(*request.roll));
  if (const double pixel = pixel_size_of(pose, request); pixel > 0)
    set_pixel_size(camera, pose.subject.box, pixel, request);
  return camera;
}

}  // namespace sfumato
