// What kind of scan a cloud is, from a sample of its neighbourhoods.
#pragma once

#include <functional>
#include <span>

#include "analysis/neighbors.h"
#include "analysis/prepare.h"

namespace sfumato::analysis {

struct Survey {
  float surface_share =
      1;  ///< of the points, those on surfaces: flat among 24 or, through noise, 1536 neighbours
  float line_share =
      0;  ///< of the points, those whose 24 neighbours lie on a line: rings of a scanner, wires
};

/// From 2048 places of a cloud in Morton order.
Survey survey(const NeighborTree& tree);

/// Median over some 500 points of the standard deviation of their 64 nearest neighbours from their common
/// plane, scene units; 0 for fewer than 4 points. Ranging noise and the bend of the surface both count.
float plane_residual(std::span<const vec3> positions);

/// What a cloud that is sorted and measured needs besides, when only its shape tells; the tree is over its
/// positions.
using ChooseNeeds = std::function<Attributes(const PreparedCloud&, const NeighborTree&)>;
/// As `prepare`, with needs that follow from the sorted cloud.
PreparedCloud prepare_by_shape(PointCloud cloud, const ChooseNeeds& choose, const PrepareOptions& options,
                               Progress& progress = no_progress());

}  // namespace sfumato::analysis
