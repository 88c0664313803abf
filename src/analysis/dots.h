// How large a point is where it is drawn as itself, neither a disc of a surface nor a part of anything.
#pragma once

#include <vector>

#include "analysis/cloud_facts.h"
#include "core/prepared_cloud.h"
#include "core/progress.h"

namespace sfumato::analysis {

/// Of every point the spacing around it, in spacing_unit(), and how far what is there is a surface whose
/// points lie on all sides, from 0 to 1. Measured at 8,192 places (CloudFacts::places), averaged over 25 of
/// them, so that neighbours have nearly the same size, and taken from a near one: of a part of a cloud as of
/// the whole.
std::vector<vec2> dots_of(const PreparedCloud& prepared, Progress& progress = no_progress());

inline constexpr std::size_t around_dot_place = 25;  ///< itself among them
/// The nearest so many points of the places of a cloud that is no part of another.
Neighborhoods around_own_places(const PreparedCloud& prepared);
/// Sizes at places of which all parts know what is around them, relative to `origin`, for clouds of so
/// many points. `median_spacing`: where there are too few to measure it.
PlacedDots dots_at(const Neighborhoods& around, const dvec3& origin, std::uint64_t points,
                   float median_spacing, Progress& progress = no_progress());

}  // namespace sfumato::analysis
