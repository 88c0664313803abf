// Normals of noisy surfaces. The nearest points of one that is as thick as they reach have no plane in
// common: what lies around them, seen from farther away, does.
#pragma once

#include <span>
#include <vector>

#include "core/progress.h"
#include "core/vec.h"

namespace sfumato::analysis {

/// Expected square of the angle between the normal of a plane of least squares and that of the surface,
/// radians: the scatter over the number of points (an eigenvector's perturbation by noise), for either axis
/// of the tilt.
float error2_of_noise(float scatter, float points);

/// Whether so many points scatter that their normals are worth averaging. `scatter`: as below.
bool need_widening(std::span<const float> scatter);

/// Averages each normal (unit, of either side) with those of the planes through the 200 and 1600 points
/// around it, each by the inverse of its expected square error: that of noise, and for wider planes what
/// surfaces bend within them. Noise is as thick seen from far as from near; bends and edges are thicker.
/// `positions` in Morton order. Of the neighbours that told the normals, `neighbors` of each: `scatter_of`
/// them, 0 where the normal is not to change, and their least variance, scene units squared. Returns the
/// standard deviation of the noise, scene units: the median of all points, 0 for those whose nearest
/// neighbours tell the better plane.
float widen_normals(const std::vector<vec3>& positions, int neighbors, const std::vector<float>& scatter,
                    const std::vector<float>& thickness2, std::vector<vec3>& normals, Progress& progress);

}  // namespace sfumato::analysis
