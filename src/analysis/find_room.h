// Whether a scan is a room seen from within, and where its ceiling and outer walls are.
#pragma once

#include <optional>

#include "core/point_cloud.h"
#include "core/room.h"

namespace sfumato::analysis {

/// From a sample of at most 200,000 points. A room has a level ceiling over a level floor, open space between
/// and something that stands there; a hollow statue has no level top, a roof seen from the air no floor.
/// Ceilings of several heights are cut at the lower ones. `cloud.up` must be right.
std::optional<Room> find_room(const PointCloud& cloud);

}  // namespace sfumato::analysis
