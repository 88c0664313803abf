// Points that no order was made for, around a surface.
#pragma once

#include <random>

#include "reference/gl_fixture.h"

namespace sfumato::testing {

/// A sphere in an even cloud of 3000 strays of any direction and colour, some without a normal.
inline PointCloud sphere_among_strays(std::mt19937& random) {
  std::uniform_real_distribution<float> uniform(-1, 1);
  PointCloud cloud = sphere_cloud(4000, 0.9f);
  for (int k = 0; k < 3000; ++k) {
    const vec3 n(uniform(random), uniform(random), uniform(random));
    cloud.positions.push_back(1.2f * vec3(uniform(random), uniform(random), uniform(random)));
    cloud.normals.push_back(k % 50 == 0 ? vec3(0) : glm::normalize(n));
    cloud.colors.push_back({std::uint8_t(random()), std::uint8_t(random()), std::uint8_t(random()), 255});
  }
  return cloud;
}

}  // namespace sfumato::testing
