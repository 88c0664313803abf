// Small clouds with known answers.
#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "core/point_cloud.h"

namespace sfumato::test {

inline std::vector<vec3> uniform_cube(std::size_t n, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<vec3> points(n);
  for (vec3& p : points) p = {unit(random), unit(random), unit(random)};
  return points;
}

/// Uniform in the unit square of the plane z = 0.
inline std::vector<vec3> uniform_square(std::size_t n, unsigned seed = 2) {
  std::vector<vec3> points = uniform_cube(n, seed);
  for (vec3& p : points) p.z = 0;
  return points;
}

/// side x side points of a square grid in the plane z = 0, row by row.
inline std::vector<vec3> square_grid(int side, float spacing) {
  std::vector<vec3> points;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) points.push_back(spacing * vec3(float(x), float(y), 0));
  return points;
}

/// Uniform on a sphere about the origin, with Gaussian noise along the normal.
inline std::vector<vec3> noisy_sphere(std::size_t n, float radius, float noise, unsigned seed = 3) {
  std::mt19937 random(seed);
  std::normal_distribution<float> gauss(0, 1);
  std::vector<vec3> points(n);
  for (vec3& p : points) {
    const vec3 direction = glm::normalize(vec3(gauss(random), gauss(random), gauss(random)));
    p = direction * (radius + noise * gauss(random));
  }
  return points;
}

/// Clusters of very different density (1 : 1e4 in spacing), a line, coincident points and far outliers.
inline std::vector<vec3> difficult_cloud(unsigned seed = 4) {
  std::mt19937 random(seed);
  std::normal_distribution<float> gauss(0, 1);
  std::vector<vec3> points;
  auto cluster = [&](std::size_t n, vec3 center, float size) {
    for (std::size_t i = 0; i < n; ++i)
      points.push_back(center + size * vec3(gauss(random), gauss(random), gauss(random)));
  };
  cluster(1500, {0, 0, 0}, 1);
  cluster(1500, {0.5f, 0, 0}, 1e-4f);
  for (int i = 0; i < 500; ++i) points.push_back({float(i) * 0.01f, 3, 3});
  for (int i = 0; i < 100; ++i) points.push_back({1, 2, 3});
  points.push_back({1e6f, 0, 0});
  points.push_back({0, -3e7f, 0});
  return points;
}

inline PointCloud cloud_of(std::vector<vec3> positions) {
  PointCloud cloud;
  cloud.positions = std::move(positions);
  return cloud;
}

}  // namespace sfumato::test
