// How noisy a cloud is, measured from itself.
#pragma once

#include <vector>

#include "core/prepared_cloud.h"
#include "core/progress.h"

namespace sfumato::denoise {

/// Median over a fixed sample of points of the standard deviation of their 64 nearest neighbours from their common
/// plane, scene units; 0 for fewer than 4 points. Ranging noise and the bend of the surface both count.
float plane_residual(const PreparedCloud& prepared);

constexpr float isolated_support = 1.0f / 64;

/// Per point, how much its splat may say about a surface: 1 where it lies among equals, down to `isolated_support` where
/// it is isolated. From the distance R to the 8th neighbour, to the power of 4: against twice its median over the
/// cloud, as radii are limited, and against 1.5 times its median over the neighbours, which tells a stray point near
/// a dense surface from a point of a sparse one (compare the local outlier factor, Breunig et al. 2000). The margins
/// keep random samples of a surface at 1.
std::vector<float> splat_support(const PreparedCloud& prepared, Progress& progress);

}  // namespace sfumato::denoise
