// What of a scan hangs together: of a picture, the part that its frame is for.
#pragma once

#include <span>
#include <vector>

#include "core/point_cloud.h"
#include "core/progress.h"

namespace sfumato {

struct Connected {
  Bounds box;
  double share = 0;           ///< of the points
  std::vector<bool> members;  ///< of the points, those that hang together
};

/// Of all that single linkage joins at some distance (in voxels of 2^k, that touch), what has most by the
/// logarithms of its share of the points and, times `gain`, of how much of a picture of it they close: what
/// is farther and sparse would make the rest small, and is left out unless it is connected, or a tenth of all
/// or more and without gaps that a picture shows. `usual` is the box of most.
Connected connected(std::span<const dvec3> points, const Bounds& usual, double gain,
                    Progress& progress = no_progress());

}  // namespace sfumato
