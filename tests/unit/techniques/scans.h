// Made scans of several kinds, for the tests of what is chosen for them.
#pragma once

#include <cmath>
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

}  // namespace sfumato
