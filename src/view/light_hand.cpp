#include "view/light_hand.h"

#include <cstdio>
#include <numbers>

#include "view/controls.h"

namespace sfumato::view {
namespace {

/// Rodrigues' formula.
dvec3 turned(const dvec3& v, const dvec3& axis, double angle) {
  return v * std::cos(angle) + glm::cross(axis, v) * std::sin(angle) +
         axis * glm::dot(axis, v) * (1 - std::cos(angle));
}

}  // namespace

dvec3 towards_light(const RenderSettings& settings, const Camera& camera, UpAxis up) {
  const Light parsed = Light::parse(settings.light_text);
  if (parsed.kind == Light::Kind::directional) return parsed.vector;
  if (parsed.is_of_camera() && settings.shadows != Shadows::off) return key_light(camera, up).vector;
  if (parsed.kind == Light::Kind::shoulder)
    return dvec3(camera.inverse_view() * glm::dvec4(dvec3(over_shoulder), 0));
  if (parsed.kind == Light::Kind::headlight) return -camera.direction();
  const dvec3 way = parsed.vector - camera.target;
  return glm::length(way) > 0 ? glm::normalize(way) : -camera.direction();
}

std::string drag_light(const RenderSettings& settings, const Camera& camera, UpAxis up, double dx_px,
                       double dy_px, int height_px) {
  const double angle_of_px = std::numbers::pi / height_px;
  const dvec3 right = glm::normalize(glm::cross(camera.direction(), camera.up));
  const dvec3 above = glm::cross(right, camera.direction());
  dvec3 way = turned(towards_light(settings, camera, up), above, dx_px * angle_of_px);
  way = glm::normalize(turned(way, right, dy_px * angle_of_px));
  const Light before = Light::parse(settings.light_text);
  if (before.kind == Light::Kind::point) {
    const dvec3 place = camera.target + way * glm::length(before.vector - camera.target);
    return number_text(place.x) + "," + number_text(place.y) + "," + number_text(place.z);
  }
  // Steps of a ten-thousandth: less than a tenth of a pixel's turn. No "-0.0000".
  std::string text = "dir:";
  for (int axis = 0; axis < 3; ++axis) {
    char number[32];
    std::snprintf(number, sizeof number, "%.4f", std::round(way[axis] * 1e4) / 1e4 + 0.0);
    text += (axis ? "," : "") + std::string(number);
  }
  return text;
}

}  // namespace sfumato::view
