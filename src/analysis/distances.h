// How far the points of one cloud lie from another: change between two surveys of a place.
#pragma once

#include <vector>

#include "core/point_cloud.h"
#include "core/progress.h"

namespace sfumato::analysis {

/// From each point to the nearest one of `reference`, scene units.
std::vector<float> nearest_distances(const PointCloud& cloud, const PointCloud& reference,
                                     Progress& progress = no_progress());

/// Along the normal of each point, positive where the cloud lies before `reference` (Lague, Brodu and Leroux
/// 2013, M3C2). The normal is that of the points of the cloud within a ball of diameter `scale`, towards the
/// scanner or upwards; what is compared are the means, along it, of what both clouds have in a cylinder of
/// that diameter. The cylinder reaches `scale` from the point for the cloud, and `scale` beyond the nearest
/// point of `reference` for that (the paper has one length for all). NaN where there is no normal, or nothing
/// of `reference` in the cylinder.
std::vector<float> signed_distances(const PointCloud& cloud, const PointCloud& reference, double scale,
                                    Progress& progress = no_progress());

}  // namespace sfumato::analysis
