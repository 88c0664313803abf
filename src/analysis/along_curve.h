// Places of which each point takes the nearest: what is measured at a few thousand places of a cloud holds
// around them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/progress.h"
#include "core/vec.h"

namespace sfumato::analysis {

/// Numbers of places in the order of a Morton curve over where they usually lie, equal keys by number.
std::vector<std::uint32_t> order_along_curve(std::span<const vec3> places);

/// Of every position the nearest of four places that are near it on that curve. `places`: in its order, one
/// at least. Fast where positions follow the curve.
std::vector<std::uint32_t> nearest_along_curve(std::span<const vec3> positions, std::span<const vec3> places,
                                               Progress& progress = no_progress());

}  // namespace sfumato::analysis
