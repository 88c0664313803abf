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

/// Optical depth through a sphere of density 1 - R/r over its value through the centre (notes A.2, closed form).
inline double closed_form(double delta) {
  const double half = std::sqrt(std::max(1 - delta * delta, 0.0));
  return delta < 1e-12 ? 1 : half - delta * delta * std::log((1 + half) / delta);
}

/// Depth through N nested spheres of density 1/(N + 1) (exact), or of Eqs. 13 (1) and 15 (2) halved.
inline double shell_sum(int count, double delta, int normalization = 0) {
  double depth = 0;
  for (int i = 0; i < count; ++i) {
    const double radius = 1 - double(i) / count;
    if (radius <= delta) break;
    double mu = normalization == 0 ? 1.0 / (count + 1) : 1 / (2 * count * radius);
    if (normalization == 2) mu *= 1 - delta / radius;
    depth += mu * 2 * std::sqrt(radius * radius - delta * delta);
  }
  return depth;
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
    double sum = 0;
    for (int i = 0; i < shells; ++i) {
      const double radius = 1 - double(i) / shells;
      if (distance >= radius * s.radius) break;
      double mu = normalization == 0 ? 1.0 / (shells + 1) : 1 / (2 * shells * radius);
      if (normalization == 2) mu *= 1 - delta / radius;
      sum += mu;
    }
    return lambda() * sum / s.radius;
  }

  /// Premultiplied colour and alpha of the haze between the two distances.
  glm::dvec4 through(const OracleRay& ray, const std::vector<OracleSphere>& spheres, double near_t,
                     double solid_t) const {
    if (express) return blended(ray, spheres, near_t, solid_t);
    std::vector<double> cuts;
    for (const OracleSphere& s : spheres) {
      const double middle = glm::dot(s.center - ray.origin, ray.direction), delta = ray_delta(ray, s.center, s.radius);
      cuts.push_back(middle);  // the density has a kink there
      for (int i = 0; i < std::max(shells, 1); ++i) {
        const double radius = 1 - double(i) / std::max(shells, 1);
        if (delta >= radius) break;
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

  glm::dvec4 blended(const OracleRay& ray, std::vector<OracleSphere> spheres, double near_t, double solid_t) const {
    std::stable_sort(spheres.begin(), spheres.end(), [&](const OracleSphere& a, const OracleSphere& b) {
      return glm::length(a.center - ray.origin) < glm::length(b.center - ray.origin);
    });
    glm::dvec4 out(0);
    for (const OracleSphere& s : spheres) {
      const double middle = glm::dot(s.center - ray.origin, ray.direction), delta = ray_delta(ray, s.center, s.radius);
      if (delta >= 1 || middle < near_t || middle > solid_t) continue;
      const double alpha = opacity * (std::cos(std::acos(-1) * delta) + 1) / 2;  // Eq. 19
      out += (1 - out.a) * alpha * glm::dvec4(s.color, 1);
    }
    return out;
  }
};

}  // namespace sfumato::testing
