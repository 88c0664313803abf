// Which ways the surfaces of a scan face.
#pragma once

#include <span>
#include <vector>

#include "core/vec.h"

namespace sfumato::analysis {

/// Of all surface, what a direction has to do with it.
struct Facing {
  double level = 0;  ///< the share across it, tilted by 25 degrees at most
  double plumb = 0;  ///< the share across or along it within 15 degrees, as floors and walls are
  double ahead =
      0;  ///< by its normals: what is level within 15 degrees and faces there, less what faces away
};

/// The planes in the cells of a box.
class Facets {
 public:
  /// `normals` may be empty.
  Facets(std::span<const dvec3> points, std::span<const vec3> normals, const dvec3& low, const dvec3& high);

  Facing facing(const dvec3& direction) const;
  /// Of one direction, and as a share of another.
  Facing facing(const dvec3& direction, const dvec3& other, double share) const;
  /// Of what is level within 15 degrees.
  struct Level {
    double below = 0;    ///< how much more of it is lower than `from` than higher: 1 all, -1 none
    double usually = 0;  ///< by how much, on the side with more
  };
  /// Nearly nothing where little is level.
  Level level_about(const dvec3& from, const dvec3& direction) const;

 private:
  struct Facet {
    dvec3 normal;  ///< either way
    dvec3 given;   ///< the sum of the normals of its points
    dvec3 center;
  };
  std::vector<Facet> facets_;
};

}  // namespace sfumato::analysis
