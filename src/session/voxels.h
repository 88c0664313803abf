// Where points are, each place once: a scan has most of its points beside the scanner, whatever it shows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/vec.h"

namespace sfumato {

class Voxels {
 public:
  /// Cubes of `edge` (scene units, more than 0), one of which begins at `corner`.
  Voxels(const dvec3& corner, double edge) : corner_(corner), edge_(edge) {}
  void reserve(std::size_t points) { keys_.reserve(points); }
  /// What is farther than a million edges is left out.
  void add(const dvec3& point);
  /// The middles of the voxels with so many points or more, in edges from the corner; by x, then y, then z.
  std::vector<dvec3> holding(std::size_t least);

 private:
  dvec3 corner_;
  double edge_;
  std::vector<std::uint64_t> keys_;  ///< of each point its voxel, 21 bits an axis
};

}  // namespace sfumato
