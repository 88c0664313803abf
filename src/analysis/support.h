// Whether points lie on a surface at all, or in clutter: foliage, grass, outliers. A disc in a tangent
// plane makes sense on a surface only.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "analysis/normals.h"
#include "core/progress.h"

namespace sfumato::analysis {

/// A neighbourhood's least variance over what the two others make (the root of their product): 0 in a plane
/// and on a line.
float scatter_of(const LocalFrame& frame);
/// Whether a neighbourhood of that scatter lies in a plane, or on a line, without a doubt.
bool is_flat(float scatter);

/// How flat the neighbourhood of a point is: 1 on a plane, or on one of two near sheets; 0 where points fill
/// space, but also at edges. `frame` is the neighbourhood's, `reach` the distance to its farthest point.
float flatness_of(std::span<const vec3> positions, std::uint32_t point,
                  std::span<const std::uint32_t> neighbors, const LocalFrame& frame, float reach);

/// Fewer points do not tell what surrounds them: nothing is clutter.
inline bool tells_clutter(std::size_t points, std::size_t neighbors) { return points / 8 > neighbors; }

/// Of every point, from 1 to 0.
struct SurfaceShares {
  std::vector<float> own;
  /// How far there are surfaces around it at all: the mean of `own` over 1536 points, or whether those lie on
  /// one surface together with it. A few points within a crown that are flat among themselves are a branch at
  /// most.
  std::vector<float> around;
  /// How far it lies in the layer, thin or thick, that the 1536 points around it make, or in a thin one of
  /// 192. Wires above a field do not, though a few of them are flat among themselves.
  std::vector<float> in_layer;
};

/// How far each point lies on a surface, from 1 to 0 (clutter). One flat neighbourhood does not tell an edge
/// from a leaf, nor noise from grass, but what surrounds it and what is seen from farther away do. A point is
/// on a surface when most of those around it are flat, or some and itself, or when the wider neighbourhoods
/// of every 8th or every 64th point are flat, which reach as far as 192 and 1536 of all points, and the point
/// lies in what is flat there. Flat neighbourhoods that no other one agrees with are chance, and do not
/// count.
SurfaceShares surface_shares(const std::vector<vec3>& positions, std::vector<float> flatness, int neighbors,
                             Progress& progress);

}  // namespace sfumato::analysis
