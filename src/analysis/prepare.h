// From a cloud as it was read to a cloud ready for rendering.
#pragma once

#include <memory>
#include <vector>

#include "analysis/neighbors.h"
#include "analysis/stroke_attributes.h"
#include "core/param.h"
#include "core/prepared_cloud.h"
#include "core/progress.h"

namespace sfumato::analysis {

struct PrepareOptions {
  int neighbors = 24;
  float clutter_radius = 0.5f;
  StrokeOptions strokes;
  void describe(ParamList& p);
};

/// Of so many points.
std::size_t batch_count(std::uint64_t points);
/// Batches of 512 to 10,240 of the positions, some 512 of them, more for clouds of over 5 million.
std::vector<Batch> cut_batches(const std::vector<vec3>& positions);

/// Sorts the cloud along a Morton curve, does `cut_batches`, measures their spacing and then does `complete`.
/// Viewpoints of grids, which do not survive sorting, are kept as `scanners` and the scalar `scanner`. The
/// result is the same for any number of threads. Throws Cancelled when the user stops it.
PreparedCloud prepare(PointCloud cloud, Attributes needs, const PrepareOptions& options,
                      Progress& progress = no_progress());

/// A cloud that still lacks what is measured from neighbours, and the tree that views its positions.
struct SortedCloud {
  PreparedCloud cloud;
  std::unique_ptr<NeighborTree> tree;
};
/// The first half of `prepare`; `complete` is the other, with needs that may follow from the shape. Of a part
/// of a cloud what decides is that of `whole`. Throws Error(usage) where the part has another origin.
SortedCloud sort_cloud(PointCloud cloud, const PrepareOptions& options, Progress& progress = no_progress(),
                       std::shared_ptr<const WholeCloud> whole = nullptr);

/// Computes those attributes of `needs` that the cloud lacks, from its RGB-D views or else from neighbours,
/// which are found once. What the file brought wins: only normals that are zero and radii that are not
/// positive are computed.
void complete(PreparedCloud& prepared, Attributes needs, const PrepareOptions& options,
              Progress& progress = no_progress());

}  // namespace sfumato::analysis
