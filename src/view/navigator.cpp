#include "view/navigator.h"

#include <algorithm>
#include <cmath>

namespace sfumato::view {
namespace {

constexpr double pi = 3.14159265358979323846;
/// Nearer to a pole than this the picture would spin.
constexpr double steepest = 0.5 * pi - 1e-3;

dvec3 rotated(const dvec3& v, double angle, const dvec3& axis) {
  return dvec3(glm::rotate(dmat4(1), angle, axis) * glm::dvec4(v, 0));
}

}  // namespace

ViewCamera ViewCamera::from(const Camera& camera) {
  ViewCamera out{camera.position, camera.target, camera.up, glm::degrees(camera.fov_y),
                 camera.orthographic()};
  // 45 degrees in radians and back are not 45.
  if (const double round = std::round(out.fov_deg * 1e6) / 1e6; glm::radians(round) == camera.fov_y)
    out.fov_deg = round;
  if (camera.custom_intrinsics && !out.orthographic)
    out.fov_deg = glm::degrees(2 * std::atan(0.5 * camera.height / camera.custom_intrinsics->fy));
  if (out.orthographic) {  // from where the angle shows as much
    const double reach = 0.5 * camera.height_world / std::tan(0.5 * glm::radians(out.fov_deg));
    out.position = out.target - camera.direction() * reach;
  }
  return out;
}

Camera ViewCamera::to_camera(int width, int height) const {
  Camera camera;
  camera.position = position, camera.target = target, camera.up = up;
  camera.fov_y = glm::radians(fov_deg);
  camera.width = width, camera.height = height;
  if (orthographic) {  // as --camera-orthographic does it
    camera.projection = Projection::orthographic;
    camera.height_world = 2 * std::tan(0.5 * camera.fov_y) * glm::length(target - position);
  }
  return camera;
}

Ray ray_through(const Camera& camera, double x_px, double y_px) {
  const Intrinsics k = camera.intrinsics();
  const dvec3 eye((x_px - k.cx) / k.fx, -(y_px - k.cy) / k.fy, -1);
  const dmat4 to_world = camera.inverse_view();
  if (camera.orthographic()) return {dvec3(to_world * glm::dvec4(eye.x, eye.y, 0, 1)), camera.direction()};
  return {camera.position, glm::normalize(dvec3(to_world * glm::dvec4(eye, 0)))};
}

dvec3 project(const Camera& camera, const dvec3& world) {
  const dvec3 eye(camera.view(camera.position) * glm::dvec4(world - camera.position, 1));
  const Intrinsics k = camera.intrinsics();
  const double w = camera.orthographic() ? 1 : -eye.z;
  return {k.cx + k.fx * eye.x / w, k.cy - k.fy * eye.y / w, -eye.z};
}

void Navigator::set_scene(UpAxis up, const Subject& subject, const dvec3& vertical) {
  up_ = up;
  vertical_ = vertical == dvec3(0) ? up_vector(up) : vertical;
  subject_ = subject;
  size_ = std::max(subject.box.diagonal(), 1e-9);
}

dvec3 Navigator::upright() const {
  const dvec3 axis = up_vector(up_);
  return glm::dot(camera_.up, vertical_) > glm::dot(camera_.up, axis) ? vertical_ : axis;
}

void Navigator::rotate(double dx_px, double dy_px, int height_px, const dvec3& pivot) {
  const dvec3 up = upright(), from = -camera_.direction();
  const double step = pi / std::max(1, height_px);
  const double elevation = std::asin(std::clamp(glm::dot(from, up), -1.0, 1.0));
  // What was straight down or rolled comes upright with the first turn.
  dvec3 right = glm::cross(up, from);
  if (glm::length(right) < 1e-6) right = glm::cross(camera_.direction(), camera_.up);
  right = glm::normalize(right);
  const double yaw = -dx_px * step;
  const double wanted = std::clamp(elevation + dy_px * step, -steepest, steepest);
  const auto turn = [&](const dvec3& v) { return rotated(rotated(v, elevation - wanted, right), yaw, up); };
  camera_.position = pivot + turn(camera_.position - pivot);
  camera_.target = pivot + turn(camera_.target - pivot);
  camera_.up = up;
}

void Navigator::pan(double dx_px, double dy_px, int height_px, const dvec3& grabbed) {
  const dmat4 to_world = camera_.to_camera(height_px, height_px).inverse_view();
  const dvec3 right(to_world[0]), up(to_world[1]);
  double depth = glm::dot(grabbed - camera_.position, camera_.direction());
  if (camera_.orthographic || depth <= 0) depth = camera_.distance();
  const double per_px = 2 * std::tan(0.5 * glm::radians(camera_.fov_deg)) * depth / std::max(1, height_px);
  const dvec3 shift = (-dx_px * right + dy_px * up) * per_px;
  camera_.position += shift;
  camera_.target += shift;
}

void Navigator::zoom(double steps, const dvec3& place) {
  // Everything scaled about the place: it keeps its pixel, and so does the direction of view.
  double factor = std::pow(0.85, steps);
  const double reach = camera_.distance();
  factor = std::clamp(factor, 1e-6 * size_ / reach, std::max(1.0, 100 * size_ / reach));
  camera_.position = place + factor * (camera_.position - place);
  camera_.target = place + factor * (camera_.target - place);
}

void Navigator::fly(const dvec3& way, double seconds, double fast) {
  const dmat4 to_world = camera_.to_camera(1, 1).inverse_view();
  const dvec3 right(to_world[0]), forward = camera_.direction();
  const dvec3 shift = (way.x * right + way.y * upright() + way.z * forward) * (0.25 * size_ * seconds * fast);
  camera_.position += shift;
  camera_.target += shift;
}

void Navigator::look_at(const dvec3& place) {
  camera_.position += place - camera_.target;
  camera_.target = place;
}

void Navigator::show(const NamedView& side, int width_px, int height_px) {
  const double azimuth = glm::radians(side.azimuth_deg), elevation = glm::radians(side.elevation_deg);
  const Compass compass(up_);
  Camera camera = sfumato::frame(subject_.box, up_, width_px, height_px, azimuth, elevation,
                                 glm::radians(camera_.fov_deg));
  const bool is_steep = std::abs(side.elevation_deg) == 90;
  camera.up = !is_steep ? compass.up : (elevation > 0 ? -1.0 : 1.0) * compass.from(azimuth, 0);
  if (!subject_.points.empty()) fit(camera, subject_);
  const bool parallel = camera_.orthographic;
  const double angle = camera_.fov_deg;
  camera_ = ViewCamera::from(camera);
  camera_.orthographic = parallel, camera_.fov_deg = angle;
}

void Navigator::frame(int width_px, int height_px) {
  if (subject_.points.empty()) return;
  Camera camera = camera_.to_camera(width_px, height_px);
  camera.projection = Projection::perspective;
  camera.position += subject_.box.center() - camera.target;
  camera.target = subject_.box.center();
  fit(camera, subject_);
  camera_.position = camera.position, camera_.target = camera.target;
}

void Navigator::set_angle(double fov_deg) {
  fov_deg = std::clamp(std::round(fov_deg * 10) / 10, 1.0, 120.0);
  const double reach = camera_.distance() * std::tan(0.5 * glm::radians(camera_.fov_deg)) /
                       std::tan(0.5 * glm::radians(fov_deg));
  camera_.position = camera_.target - camera_.direction() * reach;
  camera_.fov_deg = fov_deg;
}

}  // namespace sfumato::view
