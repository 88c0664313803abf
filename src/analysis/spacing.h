// How far apart the points of a cloud are: the one length that automatic sizes derive from.
#pragma once

#include "analysis/neighbors.h"
#include "core/prepared_cloud.h"

namespace sfumato::analysis {

/// Side of the square per point, scene units: the median of R_8 sqrt(pi / 8) over at most 20,000 points drawn
/// with a fixed seed, R_8 being the distance to the 8th nearest place that holds another point (coincident points
/// count once). Clouds of fewer than nine places use the farthest of what there is in the same formula; a
/// single place has no spacing, and 1 is returned, so that the result is always positive and finite.
float median_spacing(const NeighborTree& tree);

/// Fills `spacing` of every batch: the same quantity over 16 points of the batch; `fallback` where all of a batch
/// is one place of the cloud.
void measure_batches(std::span<Batch> batches, const NeighborTree& tree, float fallback,
                     Progress& progress = no_progress());

}  // namespace sfumato::analysis
