// Points whose x and y are degrees, or whose places are counted from the centre of the Earth: drawn in metres
// around their middle, with heights upwards.
#pragma once

#include <optional>
#include <string>

#include "core/point_cloud.h"

namespace sfumato::scene {

/// Metres east and north of a middle in degrees or from the centre of the Earth, on the ellipsoid of WGS 84.
struct LocalMetres {
  double longitude = 0, latitude = 0;  ///< of the middle, degrees
  double east = 1, north = 1;          ///< metres a degree there
  bool latitude_first = false;         ///< x is the latitude
  bool by_values = false;              ///< nothing but the numbers says so
  bool geocentric = false;             ///< places are metres from the centre of the Earth
  double height = 0;                   ///< of the middle, where they are

  dvec3 moved(const dvec3& degrees) const;
  Bounds moved(const Bounds& degrees) const;
  void apply(PointCloud& cloud) const;
  /// One line that says so. `degrees`: the points before `apply`; of a LAS file whose steps are so wide that
  /// they leave a plan of less than a hundred places each way, it says that too.
  std::string note(const PointCloud& degrees) const;
  bool operator==(const LocalMetres&) const = default;
};

/// Where the coordinate system is geographic, or where all values are within +-180 and +-90 and the points
/// are more than a thousand times thinner in plan than in height, as no scan in metres is. `middle`: most of
/// the points.
std::optional<LocalMetres> degrees_of(const std::string& crs, const Bounds& box, const Bounds& middle);
/// Where the coordinate system is geocentric, or where none is named, all three coordinates are beyond any
/// height on land and the middle is as high as land or those who scan it may be.
std::optional<LocalMetres> geocentric_of(const std::string& crs, const Bounds& middle);
/// One of both.
std::optional<LocalMetres> local_metres_of(const std::string& crs, const Bounds& box, const Bounds& middle);
std::optional<LocalMetres> local_metres_of(const PointCloud& cloud);

}  // namespace sfumato::scene
