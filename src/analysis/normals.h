// Normals of the points: the direction in which a neighbourhood is thinnest, turned to where it was seen
// from.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/point_cloud.h"

namespace sfumato::analysis {

/// Unit direction of least variance of `center` and its neighbours; nothing when they all coincide. Its sign
/// is arbitrary. On a line, one of the directions across it.
std::optional<vec3> thinnest_direction(const std::vector<vec3>& positions, std::uint32_t center,
                                       std::span<const std::uint32_t> neighbors);

/// Unit direction of most variance, likewise; in a plane without a preferred direction, any in that plane.
std::optional<vec3> widest_direction(const std::vector<vec3>& positions, std::uint32_t center,
                                     std::span<const std::uint32_t> neighbors);

/// The shape of a neighbourhood: its direction of least variance, and its variances in ascending order.
struct LocalFrame {
  vec3 normal{0};
  vec3 variance{0};
};
/// Of a covariance, xx yy zz and yz zx xy; nothing when all points coincide.
std::optional<LocalFrame> local_frame(const vec3& squares, const vec3& crossed);
std::optional<LocalFrame> local_frame(std::span<const vec3> positions, std::uint32_t center,
                                      std::span<const std::uint32_t> neighbors);

/// Two unit vectors in the plane of a unit normal, perpendicular to each other.
struct Tangents {
  vec3 along, across;
};
Tangents tangents_of(const vec3& normal);

/// The way from a point to the scanner that saw it, world; nothing where nobody knows. `scanner`: the cloud's
/// scalar of that name, or null.
std::optional<dvec3> way_to_scanner(const PointCloud& cloud, const ScalarField* scanner, std::size_t point);

/// Gives normals their sign: towards the scanner that saw the point where the cloud knows it (`scanners`,
/// with the scalar `scanner` where there are several), else by a fixed rule that looks at the normal alone:
/// upwards.
class Orientation {
 public:
  explicit Orientation(const PointCloud& cloud);
  vec3 facing(std::uint32_t point, const vec3& normal) const;
  /// For a point whose neighbourhood has no normal: towards its scanner, else up.
  vec3 fallback(std::uint32_t point) const;

 private:
  /// A unit vector.
  std::optional<vec3> to_scanner(std::uint32_t point) const;
  const PointCloud& cloud_;
  const ScalarField* scanner_;
  vec3 up_, almost_up_;
};

}  // namespace sfumato::analysis
