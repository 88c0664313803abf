// Normals, radii and uncertainty of points, from their neighbourhoods.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "analysis/neighbors.h"
#include "analysis/prepare.h"

namespace sfumato::analysis {

/// The scalar of a cloud that is part of a denser one: `scale_free_uncertainty` of that, in place of its own.
inline const std::string stored_uncertainty = "scale_free_uncertainty";

/// The stored uncertainty, where every point has one: of several files some may have none. Else null.
const ScalarField* whole_stored_uncertainty(const PointCloud& cloud);

/// What is there for every point: a cloud with some zero normals or non-positive radii does not have them
/// yet.
Attributes attributes_of(const PointCloud& cloud);

/// r_i = 2 R_i / sqrt(K) (Seemann 2018, Eq. 20, with the square on the distance that the print lost: the area
/// of K discs fills four times the disc that holds K points). R_i: distance to the K-th neighbour.
float radius_of(float farthest, std::size_t neighbors);

/// F_i = r_i (1/K) sum_j (2 - |n_i . n_j|)^2 (Seemann 2018, Eq. 21; absolute, because the sign of our normals
/// means nothing). Scene units.
float uncertainty_of(const std::vector<vec3>& normals, float radius, std::uint32_t point,
                     std::span<const std::uint32_t> neighbors);

/// As `complete` without a tree; `tree` is over the cloud's positions, or nothing where it is still to be
/// built.
void complete(PreparedCloud& prepared, Attributes needs, const PrepareOptions& options,
              const NeighborTree* tree, Progress& progress);

}  // namespace sfumato::analysis
