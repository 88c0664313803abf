// Points on an isosurface of a volume, for the volumes of Dobrev, Rosenthal, Linsen 2010: uniform by area on
// the surface that marching tetrahedra find, normals from the gradient.
#pragma once

#include <filesystem>
#include <vector>

#include "core/point_cloud.h"

namespace sfumato::bench {

struct Volume {
  int size = 0;               ///< nodes along each axis
  std::vector<float> values;  ///< size^3, x fastest, 0..1
  float at(int x, int y, int z) const { return values[(std::size_t(z) * size + y) * size + x]; }
  /// Trilinear; clamped to the volume. `p` counts nodes.
  float value(vec3 p) const;
  vec3 gradient(vec3 p) const;
};

/// Raw cubes of the sample data: `neghip` (uint8, 66^3) and `hydrogen` (float, 64^3). Throws when there is
/// none.
Volume load_volume(const std::filesystem::path& folder, const std::string& name);

/// `count` random points; the longest side of the volume is 2 and its middle the origin. Scalar `layer` is
/// `layer`.
PointCloud sample_isosurface(const Volume& volume, float level, std::size_t count, Rgba8 color, int layer);

/// The two clouds of the paper: `neghip`, 128k points on one surface; `hydrogen`, 535k points on three nested
/// ones.
PointCloud isosurfaces(const std::filesystem::path& folder, const std::string& name);

}  // namespace sfumato::bench
