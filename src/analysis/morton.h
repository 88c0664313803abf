// The order in which points are stored: along a Morton curve, so that neighbours in space are neighbours in
// memory.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/point_cloud.h"
#include "core/progress.h"

namespace sfumato::analysis {

/// Indices into `cloud` along a Morton curve of 2^21 cells an axis over the cloud's box. Points of one cell
/// are sorted again inside their own box, so that a far outlier cannot flatten the curve, few of them by x, y
/// and z; coincident points keep the order of the file (`source_index`), which decides nothing else. The same
/// for any number of threads. Throws Error(bad_input) beyond 2^32 - 1 points or an extent of 1e18.
std::vector<std::uint32_t> morton_order(const PointCloud& cloud, Progress& progress = no_progress());

/// How far along a Morton curve over a box places lie; beyond the box, as on its border.
std::vector<std::uint64_t> curve_keys(std::span<const vec3> places, const vec3& box_min, const vec3& box_max);

/// Permutes every attribute of `cloud` (`order` names old places), one at a time, so that the peak of memory
/// is one attribute. `source_index` is filled. Grids do not survive, as in `select`.
void reorder(PointCloud& cloud, std::vector<std::uint32_t> order);

}  // namespace sfumato::analysis
