// The solids' surfaces: exact intersection with rays, area, uniform sampling. All in double precision.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/point_cloud.h"
#include "core/vec.h"
#include "synth/random.h"

namespace sfumato::synth {

using glm::dvec2;

struct Ray {
  dvec3 origin{0}, direction{0, 0, 1};  ///< unit direction, so that the parameter is a distance
};

/// Surface kinds in the primitive's own frame (center; axes x, y, z).
enum class Shape : std::uint8_t {
  quad,    ///< z = 0, |y| <= b, |x| <= half width that runs from a (y = -b) to c (y = b); may have openings
  disc,    ///< z = 0, b <= radius <= a
  sphere,  ///< radius a, b <= z / a <= c
  torus,   ///< ring radius a about z, tube radius b, ring angle within c of the x axis
  cone,    ///< lateral surface, radius a at z = 0 to b at z = c, angle within d of the x axis
};

/// A hole in a quad, in its (x, y): a rectangle, with half a disc on top when `arched`.
struct Opening {
  double x_min = 0, x_max = 0, y_min = 0, y_max = 0;
  bool arched = false;
  bool contains(dvec2 p) const;
  double area() const;
};

struct Primitive {
  Shape shape = Shape::quad;
  bool inward = false;        ///< the outside is on the axis' side (vaults, arches, basins)
  std::uint8_t class_id = 1;  ///< ASPRS class
  std::uint8_t material = 0;  ///< index into Scene::materials
  double a = 1, b = 1, c = 1, d = M_PI;
  dvec3 center{0}, x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  std::vector<Opening> openings;

  dvec3 to_local(dvec3 v) const { return {glm::dot(v, x), glm::dot(v, y), glm::dot(v, z)}; }
  dvec3 to_world(dvec3 v) const { return v.x * x + v.y * y + v.z * z; }
};

/// Distances of at most four crossings, ascending.
struct Roots {
  std::array<double, 4> t{};
  int count = 0;
  void add(double value) { t[std::size_t(count++)] = value; }
};

/// A place on a surface: world position, unit normal on the outer side, and surface coordinates in scene
/// units that materials draw their patterns with.
struct SurfacePoint {
  dvec3 position{0}, normal{0};
  dvec2 uv{0};
};

/// All crossings of the whole line, also behind the origin.
Roots crossings(const Primitive& primitive, const Ray& ray);
double area(const Primitive& primitive);
/// Uniform by area.
SurfacePoint sample(const Primitive& primitive, Random& random);
/// Normal and surface coordinates at a point of the surface.
SurfacePoint describe_point(const Primitive& primitive, dvec3 position_world);
Bounds bounds(const Primitive& primitive);

/// Real roots of c[0] + c[1] t + ... + c[degree] t^degree in [lo, hi], ascending; degree at most 4. Double
/// roots that do not change the sign may be missed: a ray that only touches a surface does not cross it.
Roots polynomial_roots(const std::array<double, 5>& c, int degree, double lo, double hi);

}  // namespace sfumato::synth
