// A cloud for the tests of levels.
#pragma once

#include <cmath>
#include <random>

#include "core/point_cloud.h"

namespace sfumato::test {

// A wavy ground with walls: surfaces, as scans have, in steps of a millimetre.
inline PointCloud scan(std::size_t points, int format = 7, double east = 0, unsigned seed = 5) {
  PointCloud cloud;
  cloud.origin = {500000 + east, 4100000, 100};
  cloud.las.emplace();
  cloud.las->scale = dvec3(0.001);
  cloud.las->offset = {500000, 4100000, 0};
  cloud.las->point_format = format;
  cloud.crs = "PROJCS[\"somewhere\",UNIT[\"metre\",1]]";
  ScalarField time{"gps_time", 1000, {}, StoredType::float64},
      intensity{"intensity", 0, {}, StoredType::uint16}, classes{"classification", 0, {}, StoredType::uint8},
      extra{"echo_width", 0, {}, StoredType::float32};
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  for (std::size_t i = 0; i < points; ++i) {
    const float x = 100 * unit(random), y = 100 * unit(random);
    const bool is_wall = i % 4 == 0;
    const float millimetre = 0.001f;
    const vec3 p = is_wall ? vec3(std::floor(x / 20) * 20, y, 20 * unit(random))
                           : vec3(x, y, 3 * std::sin(x / 9) * std::cos(y / 7));
    cloud.positions.push_back(glm::round(p / millimetre) * millimetre);
    cloud.colors.push_back({std::uint8_t(random()), std::uint8_t(i), std::uint8_t(x), 255});
    time.values.push_back(float(i) * 0.125f);
    intensity.values.push_back(float(random() % 4000));
    classes.values.push_back(is_wall ? 6.0f : 2.0f);
    extra.values.push_back(unit(random));
  }
  cloud.scalars = {time, intensity, classes, extra};
  return cloud;
}

}  // namespace sfumato::test
