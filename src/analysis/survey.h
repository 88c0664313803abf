// How much of a cloud is surface, from a sample of its neighbourhoods.
#pragma once

#include <span>

#include "analysis/neighbors.h"
#include "analysis/prepare.h"

namespace sfumato::analysis {

/// `surface`: the share of the area that discs would cover for which neighbours vouch: points surround it in
/// all directions, and the planes through them agree. `dimension`: over the mean of its inverse, by maximum
/// likelihood (Levina and Bickel 2004). From 2048 places of a cloud in Morton order.
SurfaceShare surface_share(const NeighborTree& tree);
/// The same of a prepared cloud, measured once. Where the file has normals and sizes of all points, as of
/// faces, all of it is. `tree`: over its positions, or nothing where it is still to be built.
SurfaceShare surface_share_of(const PreparedCloud& prepared, const NeighborTree* tree = nullptr);
/// From here on a picture is one of surfaces, and light shows their shape (the curve: docs/first_look.md).
inline constexpr float enough_surface = 0.75f;

/// So many nearest points tell how far a point is from the plane through them.
inline constexpr std::size_t around_residual = 64;
/// Median over some 500 points of the standard deviation of their 64 nearest neighbours from their common
/// plane, scene units; 0 for fewer than 4 points. Ranging noise and the bend of the surface both count.
float plane_residual(std::span<const vec3> positions);

}  // namespace sfumato::analysis
