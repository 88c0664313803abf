#include "analysis/facets.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <vector>

#include "core/order.h"

namespace sfumato::analysis {
namespace {

constexpr double straight = 0.966;  // cos 15 degrees

struct PlaneCell {
  int count = 0;
  dvec3 corner{0};
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  dvec3 normal{0};
};

}  // namespace

Facets::Facets(std::span<const dvec3> points, std::span<const vec3> normals, const dvec3& low,
               const dvec3& high) {
  constexpr double points_each = 24;
  constexpr int fewest_points = 6, fewest_cells = 6, most_cells = 48;
  const dvec3 size = high - low;
  const double longest = std::max({size.x, size.y, size.z});
  if (!(longest > 0)) return;
  const int side = std::clamp(int(std::sqrt(double(points.size()) / points_each)), fewest_cells, most_cells);
  std::unordered_map<int, PlaneCell> cells;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (glm::any(glm::lessThan(points[i], low)) || glm::any(glm::greaterThan(points[i], high))) continue;
    const dvec3 at = (points[i] - low) / longest * double(side);
    const glm::ivec3 place = glm::min(glm::ivec3(at), side - 1);
    PlaneCell& cell = cells[(place.z * side + place.y) * side + place.x];
    cell.corner = dvec3(place);
    const dvec3 inside = at - cell.corner;
    const Eigen::Vector3d p(inside.x, inside.y, inside.z);
    ++cell.count, cell.sum += p, cell.squares += p * p.transpose();
    if (!normals.empty()) cell.normal += dvec3(normals[i]);
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  for (const auto& [place, cell] : cells) {
    if (cell.count < fewest_points) continue;
    const Eigen::Vector3d mean = cell.sum / cell.count;
    solver.computeDirect(cell.squares / cell.count - mean * mean.transpose());
    // Planar rather than linear or scattered (Demantke et al. 2011, "Dimensionality based scale selection").
    const Eigen::Vector3d deviation = solver.eigenvalues().cwiseMax(0).cwiseSqrt();
    const double planar = deviation[1] - deviation[0];
    if (!(planar > deviation[2] - deviation[1] && planar > deviation[0])) continue;
    const Eigen::Vector3d normal = solver.eigenvectors().col(0);
    const dvec3 center = low + (cell.corner + dvec3(mean[0], mean[1], mean[2])) * longest / double(side);
    facets_.push_back({{normal[0], normal[1], normal[2]}, cell.normal, center});
  }
}

Facing Facets::facing(const dvec3& direction) const {
  constexpr double tilted = 0.906, across = 0.259;  // cos 25, 75 degrees
  int level = 0, plumb = 0, ahead = 0;
  for (const Facet& facet : facets_) {
    const double along = std::abs(glm::dot(facet.normal, direction));
    level += along > tilted;
    plumb += along > straight || along < across;
    if (along > straight) ahead += int(glm::sign(glm::dot(facet.given, direction)));
  }
  const double all = double(std::max<std::size_t>(facets_.size(), 1));
  return {level / all, plumb / all, ahead / all};
}

Facing Facets::facing(const dvec3& direction, const dvec3& other, double share) const {
  const Facing a = facing(direction), b = facing(other);
  return {glm::mix(a.level, b.level, share), glm::mix(a.plumb, b.plumb, share),
          glm::mix(a.ahead, b.ahead, share)};
}

Facets::Level Facets::level_about(const dvec3& from, const dvec3& direction) const {
  constexpr double little = 0.05;
  std::vector<double> lower, higher;  // by how much
  for (const Facet& facet : facets_) {
    if (!(std::abs(glm::dot(facet.normal, direction)) > straight)) continue;
    const double depth = glm::dot(from - facet.center, direction);
    (depth > 0 ? lower : higher).push_back(std::abs(depth));
  }
  const double level = double(lower.size() + higher.size()),
               net = double(lower.size()) - double(higher.size());
  if (level == 0) return {};
  std::vector<double>& more = net > 0 ? lower : higher;
  return {net / std::max(level, little * double(facets_.size())), value_at_share(more, 0.5)};
}

}  // namespace sfumato::analysis
