// What of a scan hangs together: of a picture, the part that its frame is for.
#pragma once

#include <span>
#include <vector>

#include "core/point_cloud.h"
#include "core/progress.h"

namespace sfumato {

struct Connected {
  Bounds box;
  std::vector<bool> members;  ///< of the points, those that hang together
};

/// Of all that single linkage joins at some distance (in voxels of 2^k, that touch), what has most by the
/// logarithm of its points less `gain` times that of its mean width: what is farther and sparse would make
/// the rest small, and is left out. `usual` is the box of most.
Connected connected(std::span<const dvec3> points, const Bounds& usual, double gain,
                    Progress& progress = no_progress());

}  // namespace sfumato
