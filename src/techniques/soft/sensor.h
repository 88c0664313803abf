// How uncertain a range measurement is, from where it was made and what it hit.
#pragma once

#include <string>
#include <vector>

#include "core/prepared_cloud.h"

namespace sfumato::soft {

/// Standard deviation of every point's range over the median of all, as F = 1 - 1 / max(sigma / median, 1): 0
/// up to the median, 1/2 where it is twice that, towards 1. Noise falls with the light that comes back, and
/// that is P = cos(alpha) / (R^2 N) for a surface that fills the beam (Hoefle, Pfeifer 2007, Eq. 1;
/// Soudarissanane, Lindenbergh, Menenti, Teunissen 2009), R the distance from the scanner, alpha the angle
/// between ray and normal, N the number of returns that share the pulse: sigma ~ 1 / P. What the file does
/// not know is left out: without the scanner's place R and alpha, without `number_of_returns` N; a point
/// without a normal counts as tilted by 60 degrees. A point that nothing is known of has F = 0. Notes say
/// what was used. Throws Error(usage) when the file knows none of them.
std::vector<float> sensor_uncertainty(const PreparedCloud& prepared, std::vector<std::string>& notes);

}  // namespace sfumato::soft
