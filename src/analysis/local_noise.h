// How far points lie off the surface that they are on, place by place, whatever lies before or behind it:
// what is said of a whole cloud takes a second surface near by for noise.
#pragma once

#include <span>
#include <vector>

#include "analysis/cloud_facts.h"
#include "core/prepared_cloud.h"
#include "core/progress.h"

namespace sfumato::analysis {

/// Standard deviation of some points off the plane that most of them lie on (least trimmed squares: P. J.
/// Rousseeuw, "Least Median of Squares Regression", 1984), in their unit. `positions`: relative to the first
/// one, whose surface it is; where there are fewer than eight, 0.
float trimmed_deviation(std::span<const vec3> positions);

/// Of every place, averaged over 25; `around`: the nearest 25 points of each (analysis/dots.h).
PlacedNoise noise_at_places(const Neighborhoods& around, const dvec3& origin,
                            Progress& progress = no_progress());
/// The same of a cloud's own places, or of the whole it is a part of.
PlacedNoise placed_noise_of(const PreparedCloud& prepared, Progress& progress = no_progress());
/// Of positions, each as at the nearest place; 0 where there are none.
std::vector<float> noise_near(std::span<const vec3> positions, const PlacedNoise& noise,
                              Progress& progress = no_progress());

}  // namespace sfumato::analysis
