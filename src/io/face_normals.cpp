#include "io/face_normals.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace sfumato::io {
namespace {

/// Faces that turn by less are one surface (30 degrees, as in VTK's vtkPolyDataNormals).
const float smooth = std::cos(30 * float(M_PI) / 180);
/// More faces than this meet at the tip of a cone or the middle of a lid, which are no smooth places.
constexpr std::size_t most_around = 256;

float angle_at(const vec3& corner, const vec3& b, const vec3& c) {
  const vec3 one = b - corner, other = c - corner;
  return std::atan2(glm::length(glm::cross(one, other)), glm::dot(one, other));
}

}  // namespace

FaceNormals::FaceNormals(std::span<const vec3> positions, std::span<const Triangle> triangles)
    : positions_(positions), triangles_(triangles) {
  for (const Triangle& t : triangles) {
    of_face_.push_back(face(positions, t));
    vec3& angles = angles_.emplace_back(0);
    for (std::size_t k = 0; k < 3; ++k)
      angles[int(k)] = angle_at(positions[t[k]], positions[t[(k + 1) % 3]], positions[t[(k + 2) % 3]]);
  }
  // Exporters split vertices where faces of other pictures or other normals meet.
  std::vector<std::uint32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t i) {
    return std::tuple(positions[i].x, positions[i].y, positions[i].z, i);
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  same_.resize(positions.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    same_[order[k]] =
        k > 0 && positions[order[k]] == positions[order[k - 1]] ? same_[order[k - 1]] : order[k];
  begin_.assign(positions.size() + 1, 0);
  for (const Triangle& triangle : triangles)
    for (const std::uint32_t vertex : triangle) ++begin_[same_[vertex] + 1];
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  around_.resize(3 * triangles.size());
  std::vector<std::uint32_t> at(begin_.begin(), begin_.end() - 1);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (const std::uint32_t vertex : triangles[t]) around_[at[same_[vertex]]++] = std::uint32_t(t);
}

vec3 FaceNormals::face(std::span<const vec3> positions, const Triangle& t) {
  // In doubles: slivers of large coordinates are lost in floats.
  const dvec3 a(positions[t[0]]);
  const dvec3 normal = glm::cross(dvec3(positions[t[1]]) - a, dvec3(positions[t[2]]) - a);
  const double length = glm::length(normal);
  return length > 0 && std::isfinite(length) ? vec3(normal / length) : vec3(0);
}

// Weighted by the angle at the corner (G. Thürmer, C. A. Wüthrich, "Computing Vertex Normals from Polygonal
// Facets", JGT 3(1), 1998), so that how a surface was cut into triangles does not count.
std::array<vec3, 3> FaceNormals::corners(std::size_t triangle) const {
  const vec3 own = of_face_[triangle];
  std::array<vec3, 3> normals = {own, own, own};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t place = same_[triangles_[triangle][k]];
    if (begin_[place + 1] - begin_[place] > most_around) continue;
    vec3 sum(0);
    for (std::size_t i = begin_[place]; i < begin_[place + 1]; ++i) {
      const Triangle& other = triangles_[around_[i]];
      const vec3 normal = of_face_[around_[i]];
      if (!(glm::dot(normal, own) > smooth)) continue;
      std::size_t c = 0;
      while (c < 2 && same_[other[c]] != place) ++c;
      sum += normal * angles_[around_[i]][int(c)];
    }
    const float length = glm::length(sum);
    if (length > 0) normals[k] = sum / length;
  }
  return normals;
}

}  // namespace sfumato::io
