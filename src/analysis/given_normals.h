// Whether the normals that came with a cloud tell its surfaces better than its points do.
#pragma once

#include <vector>

#include "analysis/neighbors.h"

namespace sfumato::analysis {

/// Of normals as a file has them, in the order of the tree's points: whether they scatter about what varies
/// evenly around them, each against a plane through those of its neighbours, so much that normals of
/// `neighbors` points are several times closer to the surface. Then somebody has computed them from too few
/// points of a noisy scan.
bool are_rough(const std::vector<vec3>& normals, const NeighborTree& tree, int neighbors);

}  // namespace sfumato::analysis
