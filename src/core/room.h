// Walls that stand between whoever looks from outside and what is in a room.
#pragma once

#include <vector>

#include "core/camera.h"

namespace sfumato {

/// A room seen from within, as its half spaces behind ceiling and outer walls: a world point p is in one
/// where dot(xyz, p) + w > 0; xyz is a unit vector out of the room.
struct Room {
  std::vector<glm::dvec4> outside;
};

/// Those of the half spaces that hide the room from a camera outside of it: in which it stands, or whose wall
/// it meets from behind. None for a camera in the room.
std::vector<glm::dvec4> walls_before(const Room& room, const Camera& camera);

/// Whether a world point lies in one of the half spaces.
bool is_behind(const std::vector<glm::dvec4>& walls, const dvec3& point);

}  // namespace sfumato
