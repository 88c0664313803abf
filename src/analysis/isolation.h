// How far each point lies among others, so that isolated points, outliers, can be told from a sparse surface.
#pragma once

#include <vector>

#include "analysis/cloud_facts.h"
#include "analysis/neighbors.h"
#include "core/prepared_cloud.h"
#include "core/progress.h"

namespace sfumato::analysis {

constexpr float isolated_support = 1.0f / 64;

/// PreparedCloud::support: 1 where a point lies among equals, down to `isolated_support` where it is
/// isolated. From the distance R to the 8th neighbour, compared with
///   - the median of R over the neighbours, times 1.5: an outlier near a surface has neighbours that are
///   closer together than it is to them, a point of a sparse surface has not (compare the local outlier
///   factor, Breunig et al. 2000); power of 4. The margin keeps random samples of a surface at 1;
///   - 0.45 times the median of R over places anywhere in the cloud's box, or twice its median over the
///   points if that is more: outliers lie as far apart as places in the empty space lie from them, and 8 of
///   points that lie at random are within half of the usual distance with a probability of 1e-5; power of 12.
///   The median over the points alone would not do: density falls by orders of magnitude with the distance
///   from a scanner.
std::vector<float> support_of(const PreparedCloud& prepared, const NeighborTree& tree, Progress& progress);

/// Places anywhere in the box of a cloud that lies in parts, world; and R of such places and of those of
/// points, from what lies around them (WholeCloud::empty_reach, usual_reach). 0: there are too few points.
std::vector<dvec3> places_anywhere(const CloudFacts& whole);
inline constexpr std::size_t around_any_place = 8;
float empty_reach_of(const Neighborhoods& anywhere);
float usual_reach_of(const Neighborhoods& around_points);

}  // namespace sfumato::analysis
