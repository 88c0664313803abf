// How far apart the points of a cloud are: the one length that automatic sizes derive from.
#pragma once

#include <vector>

#include "analysis/cloud_facts.h"
#include "analysis/neighbors.h"
#include "core/prepared_cloud.h"

namespace sfumato::analysis {

/// The spacing at a point is the side of the square per point, R_8 sqrt(pi / 8) in scene units, R_8 being the
/// distance to the 8th nearest place that holds another point (coincident points count once). Where there are
/// fewer than nine places, the farthest of what there is goes into the same formula.
///
/// Returns the median over a sample of at most 20,000 points: as many from each batch (some 8,192 in all, at
/// least 16 of a batch), one out of each of as many equal runs at a place hashed from the run's number.
/// `spacing` of every batch becomes the median of its own part, and `log2_spacing` a plane through its
/// logarithms. A batch that is all in one place of the cloud gets the cloud's spacing, and a cloud of a
/// single place 1, so that results are always positive and finite. The same for any number of threads.
float measure_spacing(std::span<Batch> batches, const NeighborTree& tree, Progress& progress = no_progress());

/// The same of a cloud that lies in parts, from what is around places of it: of so many stretches of the
/// curve over `whole.box`, at most one for each 16 places, with as many points of its sample each.
PlacedSpacing spacing_along_curve(const Neighborhoods& around, const WholeCloud& whole,
                                  std::size_t stretches);
/// Of every point, scene units.
std::vector<float> spacings_at(std::span<const vec3> positions, const PlacedSpacing& spacing,
                               Progress& progress = no_progress());

}  // namespace sfumato::analysis
