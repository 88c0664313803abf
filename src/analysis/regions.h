// A cloud of which each process has any points, dealt out anew: to each the points of one region, and what
// lies around them, so that what is computed from neighbours is what it would be in the whole, but where the
// spacing is far above its median.
#pragma once

#include <vector>

#include "core/point_cloud.h"
#include "core/prepared_cloud.h"

namespace sfumato::analysis {

/// Boxes that fill space and hold as many points of the sample each, as near as can be: halved across the
/// longer side of what is there (J. Bentley, "Multidimensional binary search trees", 1975). The same for all
/// who have the same sample. Points on a border belong to the box above.
std::vector<Bounds> regions_of(const PointCloud& sample, std::size_t count);

/// How far from a point what decides about its disc may lie, scene units: the 1536 points of support.h, 22
/// spacings on a surface, and what those are told by. In median spacings of the whole.
double reach_of(const WholeCloud& whole);

/// The points of a region and those at most so far from it, in their order. `part.source_index` has their
/// numbers among all.
PointCloud points_near(const PointCloud& part, const Bounds& region, double reach);

struct Share {
  PointCloud own, around;
};
/// From `points_near` of all parts, the share that has the region: in the order of numbers, so that whoever
/// had the points before leaves no trace.
Share share_of(const std::vector<PointCloud>& parts, const Bounds& region);

}  // namespace sfumato::analysis
