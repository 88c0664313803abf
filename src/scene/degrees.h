// Points whose x and y are degrees: drawn in metres, by the scale at their middle.
#pragma once

#include <optional>
#include <string>

#include "core/point_cloud.h"

namespace sfumato::scene {

/// Metres east and north of a middle in degrees.
struct LocalMetres {
  double longitude = 0, latitude = 0;  ///< of the middle, degrees
  double east = 1, north = 1;          ///< metres a degree there, on the ellipsoid of WGS 84
  bool latitude_first = false;         ///< x is the latitude
  bool by_values = false;              ///< nothing but the numbers says that they are degrees

  dvec3 moved(const dvec3& degrees) const;
  Bounds moved(const Bounds& degrees) const;
  void apply(PointCloud& cloud) const;
  /// One line that says so.
  std::string note() const;
  bool operator==(const LocalMetres&) const = default;
};

/// Where the coordinate system is geographic, or where all values are within +-180 and +-90 and the points
/// are more than a thousand times thinner in plan than in height, as no scan in metres is. `middle`: most of
/// the points.
std::optional<LocalMetres> degrees_of(const std::string& crs, const Bounds& box, const Bounds& middle);
std::optional<LocalMetres> degrees_of(const PointCloud& cloud);

}  // namespace sfumato::scene
