// A small cloud with what a LAS point format can hold, for the tests of damage.
#pragma once

#include <random>

#include "core/point_cloud.h"

namespace sfumato::test {

/// Points in rows of `columns`. `format`: LAS point format, 0 to 8.
inline PointCloud las_cloud(int points, int format, int columns) {
  PointCloud cloud;
  cloud.las.emplace();
  cloud.las->point_format = format;
  ScalarField time{"gps_time", 1000, {}, StoredType::float64},
      intensity{"intensity", 0, {}, StoredType::uint16};
  std::mt19937 random(7);
  for (int i = 0; i < points; ++i) {
    cloud.positions.push_back({float(i % columns), float(i / columns) * 0.1f, float(random() % 100) * 0.01f});
    cloud.colors.push_back({std::uint8_t(random()), std::uint8_t(i), 9, 255});
    time.values.push_back(float(i) * 0.125f);
    intensity.values.push_back(float(random() % 4000));
  }
  cloud.scalars = {intensity, time};
  return cloud;
}

}  // namespace sfumato::test
