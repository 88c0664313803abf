// What of a scan hangs together: of a picture, the part that its frame is for.
#pragma once

#include <span>
#include <vector>

#include "core/point_cloud.h"
#include "core/progress.h"

namespace sfumato {

/// What shows of a picture, some 20 px of one 720 px high, and the most that it grows by for what few points
/// have, in shares of its height or width, or the mean of its widths.
constexpr double gap_that_shows = 0.03, most_added = 0.5;

struct Connected {
  Bounds box;
  std::vector<bool> members;  ///< of the points, those that hang together
};

/// Of all that single linkage joins at some distance (in voxels of 2^k, that touch), what has most by the
/// logarithm of its points less `gain` times that of its mean width: what is farther and sparse would make
/// the rest small, and is left out. What goes on from it without a gap that shows belongs to it, however
/// sparse, unless it adds more than `most_added`. `usual` is the box of most.
Connected connected(std::span<const dvec3> points, const Bounds& usual, double gain,
                    Progress& progress = no_progress());

}  // namespace sfumato
