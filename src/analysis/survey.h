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
  /// Of the points, those that lie on a line with their six nearest: rings of a scanner, profiles, wires.
  float line_share = 0;
  /// Of those, the ones with another line among their 24 nearest, from which normals and sizes come.
  float closed_lines = 0;
  /// How far the next line is, what a tenth of those exceeds over what nine tenths do: 1.0 to 1.1 of the
  /// profiles of what moves along a tunnel, 4 to 26 of the rings around what turns, 2.8 of rims of a mesh.
  float gap_spread = 1;
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
