#include "analysis/normals.h"

#include <Eigen/Eigenvalues>

#include <cmath>

namespace sfumato::analysis {
namespace {

using Solver = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>;

std::optional<vec3> direction_of(const Solver& solver, int which) {
  const Eigen::Vector3d n = solver.eigenvectors().col(which);
  const vec3 direction = vec3(float(n.x()), float(n.y()), float(n.z()));
  const float length = glm::length(direction);
  if (!(length > 0.5f)) return std::nullopt;
  return direction / length;
}

/// Eigenvalues, ascending, and eigenvectors of the neighbourhood's covariance, times the number of points.
std::optional<Solver> decompose(std::span<const vec3> positions, std::uint32_t center,
                                std::span<const std::uint32_t> neighbors) {
  // Relative to the point, so that large coordinates do not cancel.
  const vec3 p = positions[center];
  double sum[3] = {}, xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  for (std::uint32_t j : neighbors) {
    const double x = positions[j].x - p.x, y = positions[j].y - p.y, z = positions[j].z - p.z;
    sum[0] += x, sum[1] += y, sum[2] += z;
    xx += x * x, xy += x * y, xz += x * z, yy += y * y, yz += y * z, zz += z * z;
  }
  const double each = 1.0 / double(neighbors.size() + 1);  // the point itself adds zeros
  Eigen::Matrix3d covariance;
  covariance(0, 0) = xx - sum[0] * sum[0] * each;
  covariance(1, 0) = xy - sum[0] * sum[1] * each;
  covariance(2, 0) = xz - sum[0] * sum[2] * each;
  covariance(1, 1) = yy - sum[1] * sum[1] * each;
  covariance(2, 1) = yz - sum[1] * sum[2] * each;
  covariance(2, 2) = zz - sum[2] * sum[2] * each;
  if (!(covariance.trace() > 0)) return std::nullopt;
  Solver solver;
  solver.computeDirect(covariance);  // reads the lower triangle
  return solver;
}

}  // namespace

std::optional<LocalFrame> local_frame(const vec3& squares, const vec3& crossed) {
  Eigen::Matrix3d covariance;
  covariance << double(squares.x), 0, 0, double(crossed.z), double(squares.y), 0, double(crossed.y),
      double(crossed.x), double(squares.z);
  if (!(covariance.trace() > 0)) return std::nullopt;
  Solver solver;
  solver.computeDirect(covariance);  // reads the lower triangle
  const auto normal = direction_of(solver, 0);
  if (!normal) return std::nullopt;
  const Eigen::Vector3d variance = solver.eigenvalues().cwiseMax(0.0);
  return LocalFrame{*normal, vec3(float(variance.x()), float(variance.y()), float(variance.z()))};
}

std::optional<LocalFrame> local_frame(std::span<const vec3> positions, std::uint32_t center,
                                      std::span<const std::uint32_t> neighbors) {
  const auto solver = decompose(positions, center, neighbors);
  const auto normal = solver ? direction_of(*solver, 0) : std::nullopt;
  if (!normal) return std::nullopt;
  const Eigen::Vector3d variance = solver->eigenvalues().cwiseMax(0.0) / double(neighbors.size() + 1);
  return LocalFrame{*normal, vec3(float(variance.x()), float(variance.y()), float(variance.z()))};
}

std::optional<vec3> thinnest_direction(const std::vector<vec3>& positions, std::uint32_t center,
                                       std::span<const std::uint32_t> neighbors) {
  const auto solver = decompose(positions, center, neighbors);
  return solver ? direction_of(*solver, 0) : std::nullopt;
}

std::optional<vec3> widest_direction(const std::vector<vec3>& positions, std::uint32_t center,
                                     std::span<const std::uint32_t> neighbors) {
  const auto solver = decompose(positions, center, neighbors);
  return solver ? direction_of(*solver, 2) : std::nullopt;
}

Tangents tangents_of(const vec3& normal) {
  const vec3 aside = std::abs(normal.x) < 0.6f ? vec3(1, 0, 0) : vec3(0, 1, 0);
  const vec3 along = glm::normalize(glm::cross(normal, aside));
  return {along, glm::cross(normal, along)};
}

std::optional<dvec3> way_to_scanner(const PointCloud& cloud, const ScalarField* scanner, std::size_t point) {
  std::size_t which = 0;
  if (scanner) {
    const double value = std::round(scanner->value(point));
    if (!(value >= 0 && value < double(cloud.scanners.size()))) return std::nullopt;
    which = std::size_t(value);
  } else if (cloud.scanners.size() != 1) {
    return std::nullopt;
  }
  const dvec3 way = cloud.scanners[which] - cloud.world(point);
  const double length = glm::length(way);
  if (!(length > 0) || !std::isfinite(length)) return std::nullopt;
  return way;
}

Orientation::Orientation(const PointCloud& cloud)
    : cloud_(cloud), scanner_(cloud.scalar("scanner")), up_(up_vector(cloud.up)) {
  // Tilted, so that the many walls that stand exactly upright do not flip with their noise.
  almost_up_ = up_ + 0.1f * vec3(up_.y, up_.z, up_.x) + 0.17f * vec3(up_.z, up_.x, up_.y);
}

std::optional<vec3> Orientation::to_scanner(std::uint32_t point) const {
  const std::optional<dvec3> way = way_to_scanner(cloud_, scanner_, point);
  return way ? std::optional(vec3(*way / glm::length(*way))) : std::nullopt;
}

vec3 Orientation::facing(std::uint32_t point, const vec3& normal) const {
  const std::optional<vec3> way = to_scanner(point);
  float side = way ? glm::dot(*way, normal) : 0;
  if (side == 0) side = glm::dot(almost_up_, normal);
  return side < 0 ? -normal : normal;
}

vec3 Orientation::fallback(std::uint32_t point) const { return to_scanner(point).value_or(up_); }

}  // namespace sfumato::analysis
