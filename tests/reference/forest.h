// Ground and trees of separate leaves, sampled as an airborne scanner does, with the truth drawn leaf by
// leaf.
#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "core/camera.h"
#include "core/image.h"
#include "core/point_cloud.h"

namespace sfumato::testing {

struct Forest {
  struct Leaf {
    dvec3 center, normal;
  };
  static constexpr double side = 40, leaf_radius = 0.15;  // metres
  std::vector<Leaf> leaves;
  PointCloud cloud;
  std::vector<bool> on_leaf;  ///< per point of `cloud`

  /// 16 crowns of 2 m half-width and 3 m half-height, their leaves gathered around 60 twigs each. `density`:
  /// points a square metre of ground; a crown returns three times as many of what it covers.
  explicit Forest(double density, unsigned seed = 1) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    std::normal_distribution<double> gauss(0, 1);
    auto direction = [&] { return glm::normalize(dvec3(gauss(random), gauss(random), gauss(random))); };
    auto add = [&](const dvec3& p, bool leaf) {
      cloud.positions.push_back(vec3(p)), on_leaf.push_back(leaf);
    };
    for (int i = 0; i < int(density * side * side); ++i)
      add({side * (unit(random) - 0.5), side * (unit(random) - 0.5), 0.02 * gauss(random)}, false);
    for (int tree = 0; tree < 16; ++tree) {
      const dvec3 center(10 * (tree % 4) - 15 + gauss(random), 10 * (tree / 4) - 15 + gauss(random), 6);
      std::vector<Leaf> own;
      for (int twig = 0; twig < 60; ++twig) {
        const dvec3 tip = center + dvec3(2, 2, 3) * direction() * std::cbrt(unit(random));
        for (int i = 0; i < 8; ++i) own.push_back({tip + 0.25 * direction() * unit(random), direction()});
      }
      const int returns = int(3 * density * std::numbers::pi * 2 * 2);
      for (int i = 0; i < returns; ++i) {
        const Leaf& leaf = own[std::size_t(unit(random) * double(own.size()))];
        const dvec3 u = glm::normalize(
            glm::cross(leaf.normal, std::abs(leaf.normal.x) < 0.9 ? dvec3(1, 0, 0) : dvec3(0, 1, 0)));
        const double angle = 2 * std::numbers::pi * unit(random), r = leaf_radius * std::sqrt(unit(random));
        add(leaf.center + r * (std::cos(angle) * u + std::sin(angle) * glm::cross(leaf.normal, u)), true);
      }
      leaves.insert(leaves.end(), own.begin(), own.end());
    }
  }

  /// What each pixel of an orthographic camera sees first: 2 a leaf, 1 the ground, 0 nothing.
  Image<int> truth(const Camera& camera) const {
    Image<int> seen(camera.width, camera.height, 0);
    const dmat4 to_eye = camera.view(), to_world = camera.inverse_view();
    const dvec3 along = camera.direction();
    const double scale = camera.pixels_per_unit();
    auto ray_start = [&](int x, int y) {
      return dvec3(to_world * glm::dvec4((x + 0.5 - 0.5 * camera.width) / scale,
                                         (0.5 * camera.height - y - 0.5) / scale, 0, 1));
    };
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const dvec3 start = ray_start(x, y), p = start - along * (start.z / along.z);
        if (std::max(std::abs(p.x), std::abs(p.y)) < 0.5 * side) seen.at(x, y) = 1;
      }
    for (const Leaf& leaf : leaves) {
      const dvec3 eye(to_eye * glm::dvec4(leaf.center, 1));
      const double cx = scale * eye.x + 0.5 * camera.width, cy = 0.5 * camera.height - scale * eye.y,
                   r = scale * leaf_radius;
      for (int y = std::max(0, int(cy - r)); y <= std::min(camera.height - 1, int(cy + r)); ++y)
        for (int x = std::max(0, int(cx - r)); x <= std::min(camera.width - 1, int(cx + r)); ++x) {
          const dvec3 start = ray_start(x, y);
          const dvec3 hit =
              start + along * (glm::dot(leaf.center - start, leaf.normal) / glm::dot(along, leaf.normal));
          if (glm::length(hit - leaf.center) < leaf_radius) seen.at(x, y) = 2;
        }
    }
    return seen;
  }
};

}  // namespace sfumato::testing
