// How far points lie off the surfaces that they were measured on.
#pragma once

#include "analysis/cloud_facts.h"
#include "analysis/neighbors.h"

namespace sfumato::analysis {

/// Standard deviation of the noise across surfaces, scene units: what three quarters of 128 places do not
/// exceed. Noise, and depths that were rounded, are as thick seen from far as from near; edges are twice as
/// thick among four times as many neighbours, and what bends four times. So a place has the thickness of the
/// widest plane (through 1536, 384 or 96 points) that is hardly thicker than the next one, and 0 where none
/// is.
float surface_noise(const NeighborTree& tree);

inline constexpr std::size_t noise_places = 128, around_noise_place = 1536;
/// The same of places of which all parts of a cloud know what is around them.
float noise_of(const Neighborhoods& around);

}  // namespace sfumato::analysis
