// How densely a surface was sampled at every point.
#pragma once

#include <string>
#include <vector>

#include "analysis/neighbors.h"

namespace sfumato::analysis {

inline const std::string density_name = "density";

/// Points per square unit of surface, one value a point: (k - 1) / (pi R_k^2) with k = 16 neighbours, the
/// unbiased estimate for random points in a plane (Loftsgaarden and Quesenberry 1965). NaN where 16 points
/// lie in one place.
std::vector<float> surface_density(const NeighborTree& tree);

}  // namespace sfumato::analysis
