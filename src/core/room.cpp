#include "core/room.h"

#include <algorithm>

namespace sfumato {
namespace {

/// Sine of 9 degrees: a wall that is looked along hides nothing.
constexpr double across = 0.15;

}  // namespace

std::vector<glm::dvec4> walls_before(const Room& room, const Camera& camera) {
  if (!camera.orthographic() && !is_behind(room.outside, camera.position)) return {};
  std::vector<glm::dvec4> before;
  for (const glm::dvec4& wall : room.outside) {
    const bool stands_behind = !camera.orthographic() && glm::dot(dvec3(wall), camera.position) + wall.w > 0;
    if (stands_behind || glm::dot(dvec3(wall), camera.direction()) < -across) before.push_back(wall);
  }
  return before;
}

bool is_behind(const std::vector<glm::dvec4>& walls, const dvec3& point) {
  return std::any_of(walls.begin(), walls.end(),
                     [&](const glm::dvec4& wall) { return glm::dot(dvec3(wall), point) + wall.w > 0; });
}

}  // namespace sfumato
