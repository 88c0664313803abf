// Normals at the corners of faces whose file has none.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "io/faces.h"

namespace sfumato::io {

/// Of smooth surfaces from the faces around a corner, of edges from the face alone.
class FaceNormals {
 public:
  FaceNormals(std::span<const vec3> positions, std::span<const Triangle> triangles);
  /// Unit; zero for a triangle of no area.
  static vec3 face(std::span<const vec3> positions, const Triangle& triangle);
  std::array<vec3, 3> corners(std::size_t triangle) const;

 private:
  std::span<const vec3> positions_;
  std::span<const Triangle> triangles_;
  std::vector<vec3> of_face_, angles_;
  std::vector<std::uint32_t> same_;            ///< of the vertices in one place, the first
  std::vector<std::uint32_t> begin_, around_;  ///< of a place, its triangles
};

}  // namespace sfumato::io
