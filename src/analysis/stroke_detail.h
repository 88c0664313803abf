// How large a stroke may be at a point before it paints over something: an eye, an edge, a leaf.
#pragma once

#include <span>
#include <vector>

#include "core/point_cloud.h"
#include "core/progress.h"

namespace sfumato::analysis {

struct DetailOptions {
  float color_step =
      10.0f / 255;           ///< standard deviation of colours (sRGB, 0..1 each) that a stroke may unite
  float normal_step = 0.2f;  ///< the same of n n^T (Frobenius), sqrt(2) times the angle for small ones
};

/// Length over which colour and direction of the surface stay within the steps, scene units, at every point;
/// at most 1000 `spacing`, which should be that of the denser parts. Cells of 4, 8, 16 ... spacings are split
/// in eight; what the means of the parts differ by, beyond what chance makes of the spread within them (a
/// one-way analysis of variance), is detail of that size, and noise of single points is none. Two grids, a
/// third of a cell apart, so that no edge hides in a border of cells. `colors` may be empty.
std::vector<float> detail_lengths(const std::vector<vec3>& positions, const std::vector<Rgba8>& colors,
                                  std::span<const vec3> normals, const dvec3& origin, float spacing,
                                  const DetailOptions& options, Progress& progress = no_progress());

/// The shape of a neighbourhood, from the eigenvalues of its covariance.
struct NeighborhoodShape {
  float non_planarity =
      1;  ///< sqrt of the least by the middle: 0 on a plane, towards 1 where points fill space as leaves do
  float strip_width =
      0;  ///< scene units: of a strip or pole that the neighbourhood holds across; 0 where it is none
};
/// Less than four neighbours fill space. `spacing` of the points about `center`: a single line of them is no
/// strip.
NeighborhoodShape neighborhood_shape(const std::vector<vec3>& positions, std::uint32_t center,
                                     std::span<const std::uint32_t> neighbors, float spacing);

}  // namespace sfumato::analysis
