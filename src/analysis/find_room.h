// Whether a scan is of rooms seen from within, and where their ceilings and outer walls are.
#pragma once

#include <optional>

#include "core/point_cloud.h"
#include "core/room.h"

namespace sfumato::analysis {

/// From a sample of at most 200,000 points. Rooms have level ceilings, each at a height of its own, over open
/// space, that end at walls, and something stands below them. A hollow statue has no level top, a canopy no
/// thin one, a table or a bridge no walls, an empty box nothing inside. `cloud.up` must be right.
std::optional<Room> find_room(const PointCloud& cloud);

}  // namespace sfumato::analysis
