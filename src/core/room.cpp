#include "core/room.h"

#include <algorithm>
#include <limits>

namespace sfumato {
namespace {

/// Sine of 9 degrees: a wall that is looked along hides nothing.
constexpr double across = 0.15;

bool is_behind(const glm::dvec4& wall, const dvec3& point) {
  return glm::dot(dvec3(wall), point) + wall.w > 0;
}

/// The cell of the plan that a place is in.
std::optional<glm::ivec2> cell_of(const Ceiling& ceiling, const dvec3& place) {
  const double x = glm::dot(dvec3(ceiling.u), place) + ceiling.u.w,
               y = glm::dot(dvec3(ceiling.v), place) + ceiling.v.w;
  if (!(x >= 0 && y >= 0 && x < ceiling.across && y < ceiling.across)) return std::nullopt;
  return glm::ivec2(int(x), int(y));
}

/// The height of the ceiling over a place of the plan, or where it has a hole, of the nearest; infinite
/// beside the plan.
double nearest_height(const Ceiling& ceiling, const dvec3& place) {
  constexpr double none = std::numeric_limits<double>::infinity();
  const std::optional<glm::ivec2> cell = cell_of(ceiling, place);
  if (!cell) return none;
  double height = none;
  int least = std::numeric_limits<int>::max();
  for (int v = 0; v < ceiling.across; ++v)
    for (int u = 0; u < ceiling.across; ++u) {
      const double here = ceiling.heights[std::size_t(v * ceiling.across + u)];
      const int away = (cell->x - u) * (cell->x - u) + (cell->y - v) * (cell->y - v);
      if (here < none && away < least) least = away, height = here;
    }
  return height;
}

bool holds(const Room& room, const dvec3& place) {
  if (room.ceiling) {
    const double height = nearest_height(*room.ceiling, place);
    if (!(height < std::numeric_limits<double>::infinity() && glm::dot(room.ceiling->up, place) < height))
      return false;
  }
  return std::none_of(room.outside.begin(), room.outside.end(),
                      [&](const glm::dvec4& wall) { return is_behind(wall, place); });
}

}  // namespace

double Ceiling::height_at(const dvec3& point) const {
  const std::optional<glm::ivec2> cell = cell_of(*this, point);
  return cell ? heights[std::size_t(cell->y * across + cell->x)] : std::numeric_limits<double>::infinity();
}

Cut cut_before(const Room& room, const Camera& camera) {
  Cut cut;
  if (!camera.orthographic() && holds(room, camera.position)) return cut;
  for (const glm::dvec4& wall : room.outside) {
    const bool stands_behind = !camera.orthographic() && is_behind(wall, camera.position);
    if (stands_behind || glm::dot(dvec3(wall), camera.direction()) < -across) cut.walls.push_back(wall);
  }
  if (room.ceiling) {
    const bool stands_above = !camera.orthographic() && room.ceiling->is_below(camera.position);
    if (stands_above || glm::dot(room.ceiling->up, camera.direction()) < -across) cut.ceiling = room.ceiling;
  }
  return cut;
}

bool is_cut(const Cut& cut, const dvec3& point) {
  return (cut.ceiling && cut.ceiling->is_below(point)) ||
         std::any_of(cut.walls.begin(), cut.walls.end(),
                     [&](const glm::dvec4& wall) { return is_behind(wall, point); });
}

}  // namespace sfumato
