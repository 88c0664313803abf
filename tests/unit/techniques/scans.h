// Made scans of several kinds, for the tests of what is chosen for them.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "synth/synth.h"

namespace sfumato {

inline PointCloud scan(const std::string& scene, synth::Sampling sampling, int points) {
  synth::SampleOptions options;
  options.points = points;
  options.sampling = sampling;
  return synth::sample(synth::make_scene(scene), options);
}

/// One turn of a street scanner: 32 degrees of rings over a road between two walls.
inline PointCloud street_sweep(int rings = 32) {
  PointCloud cloud;
  for (int ring = 0; ring < rings; ++ring)
    for (int step = 0; step < 1800; ++step) {
      const double angle = glm::radians(0.2 * step), rise = glm::radians(-25.0 + ring * 32.0 / rings);
      const dvec3 way(std::cos(rise) * std::cos(angle), std::cos(rise) * std::sin(angle), std::sin(rise));
      double t = 80;
      if (way.z < 0) t = std::min(t, -1.8 / way.z);
      if (way.y != 0) t = std::min(t, 8 / std::abs(way.y));
      if (t < 80) cloud.positions.push_back(vec3(t * way));
    }
  return cloud;
}

/// The inside of a box of this size, z up, turned about z by so much, with a cupboard, a table and a sofa:
/// what they stand on is not seen, as from scanners in the room.
inline PointCloud closed_room(const vec3& size, float turned) {
  std::mt19937 random(31);
  std::uniform_real_distribution<float> unit(0, 1);
  struct Box {
    vec3 low, high;
  };
  const Box things[] = {{{0, 0, 0}, {0.1f * size.x, 0.5f * size.y, 2}},
                        {{0.4f * size.x, 0.3f * size.y, 0}, {0.6f * size.x, 0.6f * size.y, 0.75f}},
                        {{0.3f * size.x, 0.8f * size.y, 0}, {0.8f * size.x, size.y, 0.8f}}};
  const auto hidden = [&](const vec3& p) {
    return std::any_of(std::begin(things), std::end(things), [&](const Box& b) {
      return glm::all(glm::greaterThanEqual(p, b.low)) &&
             glm::all(glm::lessThan(p + vec3(0, 0, 0.01f), b.high));
    });
  };
  PointCloud cloud;
  const auto add = [&](const vec3& low, const vec3& high, int count) {
    for (int i = 0; i < count; ++i) {
      const int side = int(random() % 6);
      vec3 p = low + (high - low) * vec3(unit(random), unit(random), unit(random));
      p[side / 2] = side % 2 == 0 ? low[side / 2] : high[side / 2];
      if (count > 10'000 ? hidden(p) : p.z == low.z) continue;
      cloud.positions.push_back({std::cos(turned) * p.x - std::sin(turned) * p.y,
                                 std::sin(turned) * p.x + std::cos(turned) * p.y, p.z});
    }
  };
  add(vec3(0), size, 60'000);
  for (const Box& thing : things) add(thing.low, thing.high, 3000);
  return cloud;
}

}  // namespace sfumato
