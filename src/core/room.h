// Ceilings and walls that stand between whoever looks from outside and what is in rooms.
#pragma once

#include <optional>
#include <vector>

#include "core/camera.h"

namespace sfumato {

/// Above which height nothing is drawn, by the place in the plan: rooms have ceilings of their own, and maps
/// of a drifting scanner lean.
struct Ceiling {
  static constexpr int most_across = 60;  // floats of a uniform block: 16 KiB are sure
  dvec3 up{0};                            ///< unit
  glm::dvec4 u{0}, v{0};        ///< a point is in the cell floor(dot(xyz, p) + w), along either side
  int across = 0;               ///< cells of a side of the square plan
  std::vector<double> heights;  ///< of cell (u, v) at v * across + u; infinite: no ceiling there

  /// Infinite where there is none.
  double height_at(const dvec3& point) const;
  bool is_below(const dvec3& point) const { return glm::dot(up, point) > height_at(point); }
};

/// Rooms seen from within. Of the half spaces behind their outer walls a world point p is in one where
/// dot(xyz, p) + w > 0; xyz is a unit vector out of the room.
struct Room {
  std::vector<glm::dvec4> outside;
  std::optional<Ceiling> ceiling = {};
};

/// What is left out of a picture of a room.
struct Cut {
  std::vector<glm::dvec4> walls;
  std::optional<Ceiling> ceiling = {};
  bool empty() const { return walls.empty() && !ceiling; }
};

/// The ceiling and those of the walls that hide the room from a camera outside of it: behind or above which
/// it stands, or which it meets from there. Nothing for a camera in the room.
Cut cut_before(const Room& room, const Camera& camera);

bool is_cut(const Cut& cut, const dvec3& point);

}  // namespace sfumato
