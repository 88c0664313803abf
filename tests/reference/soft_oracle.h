// The oracle of soft transparency: every sphere along a ray, in double precision. Densities are integrated
// numerically, in world space, from their definitions; the shaders use antiderivatives in eye space.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "reference/splat_oracle.h"

namespace sfumato::testing {

struct OracleSphere {
  dvec3 center{0};
  double radius = 0;
  dvec3 color{0};
};

/// Optical depth through a sphere of density 1 - R/r over its value through the centre (notes A.2, closed
/// form).
inline double closed_form(double delta) {
  const double half = std::sqrt(std::max(1 - delta * delta, 0.0));
  return delta < 1e-12 ? 1 : half - delta * delta * std::log((1 + half) / delta);
}

/// Nested spheres about one centre in units of the outermost: radii and densities on a chord at delta. With
/// `normalization` 1 (Eq. 13) and 2 (Eq. 15) r_i = 1 - i/N, halved, as they sum up to 2 through the centre.
/// With 0 a density of 1/M each has depth 1 + 1/M through the centre; between powers of two the two of them
/// are mixed so that it is 1 + 1/N, and that is divided out.
struct Shells {
  std::vector<double> radii, densities;
  Shells(double count, double delta, int normalization) {
    if (normalization != 0) {
      for (int i = 0; i < int(count); ++i) {
        const double radius = 1 - i / count;
        add(radius, 1 / (2 * count * radius) * (normalization == 2 ? std::max(0.0, 1 - delta / radius) : 1));
      }
      return;
    }
    const int below = 1 << int(std::floor(std::log2(count) + 1e-12));
    const double share =
        2 * (1 - below / count);  // of the finer one: 1/count = (1 - share)/below + share/(2 below)
    for (int i = 0; i < below; ++i) add(1 - double(i) / below, (1 - share) / below / (1 + 1 / count));
    for (int i = 0; i < 2 * below && share > 0; ++i)
      add(1 - i / (2.0 * below), share / (2 * below) / (1 + 1 / count));
  }
  double depth(double delta) const {
    double sum = 0;
    for (std::size_t i = 0; i < radii.size(); ++i)
      if (radii[i] > delta) sum += densities[i] * 2 * std::sqrt(radii[i] * radii[i] - delta * delta);
    return sum;
  }

 private:
  void add(double radius, double density) { radii.push_back(radius), densities.push_back(density); }
};
inline double shell_sum(double count, double delta, int normalization = 0) {
  return Shells(count, delta, normalization).depth(delta);
}

inline double ray_delta(const OracleRay& ray, const dvec3& center, double radius) {
  const dvec3 away = center - ray.origin;
  return glm::length(away - glm::dot(away, ray.direction) * ray.direction) / radius;
}

struct SoftOracle {
  double opacity = 0.15;
  int shells = 0;         ///< 0: Base model
  int normalization = 0;  ///< of shells: exact, eq13, eq15
  bool express = false;

  double lambda() const { return -std::log(1 - std::min(opacity, 0.999)); }

  /// Optical depth per length at a place of the ray.
  double density(const OracleSphere& s, double distance, double delta) const {
    if (distance >= s.radius) return 0;
    if (shells == 0) return lambda() * (1 - distance / s.radius) / s.radius;
    const Shells nested(shells, delta, normalization);
    double sum = 0;
    for (std::size_t i = 0; i < nested.radii.size(); ++i)
      if (distance < nested.radii[i] * s.radius) sum += nested.densities[i];
    return lambda() * sum / s.radius;
  }

  /// Premultiplied colour and alpha of the haze between the two distances.
  glm::dvec4 through(const OracleRay& ray, const std::vector<OracleSphere>& spheres, double near_t,
                     double solid_t) const {
    if (express) return blended(ray, spheres, near_t, solid_t);
    std::vector<double> cuts;
    for (const OracleSphere& s : spheres) {
      const double middle = glm::dot(s.center - ray.origin, ray.direction),
                   delta = ray_delta(ray, s.center, s.radius);
      cuts.push_back(middle);  // the density has a kink there
      const Shells nested(std::max(shells, 1), delta, normalization);
      for (double radius : nested.radii) {
        if (delta >= radius) continue;
        const double half = s.radius * std::sqrt(radius * radius - delta * delta);
        cuts.insert(cuts.end(), {middle - half, middle + half});
      }
    }
    for (double& cut : cuts) cut = std::clamp(cut, near_t, solid_t);
    std::sort(cuts.begin(), cuts.end());
    glm::dvec4 out(0);
    for (std::size_t k = 0; k + 1 < cuts.size(); ++k) add_segment(ray, spheres, cuts[k], cuts[k + 1], out);
    return out;
  }

 private:
  void add_segment(const OracleRay& ray, const std::vector<OracleSphere>& spheres, double from, double to,
                   glm::dvec4& out) const {
    if (!(to > from)) return;
    dvec3 weighted(0);
    double weights = 0, depth = 0;
    for (const OracleSphere& s : spheres) {
      const double delta = ray_delta(ray, s.center, s.radius);
      if (glm::length(ray.origin + 0.5 * (from + to) * ray.direction - s.center) >= s.radius) continue;
      weighted += (1 - delta) * s.color;  // Eq. 11
      weights += 1 - delta;
      // Simpson's rule on 32 intervals.
      constexpr int intervals = 32;
      double sum = 0;
      for (int i = 0; i <= intervals; ++i) {
        // A hair inside, so that the ends of shells count for the segment's side.
        const double t = from + (to - from) * (1e-9 + (1 - 2e-9) * i / intervals);
        const double weight = i == 0 || i == intervals ? 1 : i % 2 ? 4 : 2;
        sum += weight * density(s, glm::length(ray.origin + t * ray.direction - s.center), delta);
      }
      depth += sum * (to - from) / (3 * intervals);
    }
    if (weights <= 0) return;
    const double alpha = (1 - out.a) * (1 - std::exp(-depth));
    out += glm::dvec4(alpha * weighted / weights, alpha);
  }

  glm::dvec4 blended(const OracleRay& ray, std::vector<OracleSphere> spheres, double near_t,
                     double solid_t) const {
    std::stable_sort(spheres.begin(), spheres.end(), [&](const OracleSphere& a, const OracleSphere& b) {
      return glm::length(a.center - ray.origin) < glm::length(b.center - ray.origin);
    });
    glm::dvec4 out(0);
    for (const OracleSphere& s : spheres) {
      const double middle = glm::dot(s.center - ray.origin, ray.direction),
                   delta = ray_delta(ray, s.center, s.radius);
      if (delta >= 1 || middle < near_t || middle > solid_t) continue;
      const double alpha = opacity * (std::cos(std::acos(-1) * delta) + 1) / 2;  // Eq. 19
      out += (1 - out.a) * alpha * glm::dvec4(s.color, 1);
    }
    return out;
  }
};

}  // namespace sfumato::testing
