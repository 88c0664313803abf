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

/// Nested spheres about one centre in units of the point's radius: radii and densities on a chord at delta.
/// With `normalization` 1 (Eq. 13) and 2 (Eq. 15) r_i = 1 - i/N, halved, as they sum up to 2 through the
/// centre. With 0 equal densities at the middles of N steps, as far as these are positive, with a scale and a
/// density that give two integrals of 1 - R: 1 along a ray through the centre, pi/3 over the ball.
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
    double diameters = 0, volumes = 0;
    for (int i = 0; 1 - (i + 0.5) / count > 0; ++i) {
      add(1 - (i + 0.5) / count, 0);
      diameters += 2 * radii.back();
      volumes += 4 * std::acos(-1) / 3 * std::pow(radii.back(), 3);
    }
    const double scale = std::sqrt(diameters * std::acos(-1) / 3 / volumes);
    for (double& radius : radii) radius *= scale;
    for (double& density : densities) density = 1 / (scale * diameters);
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
      for (double radius : radii(delta)) {
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
  /// Where the density of a sphere changes, in units of its radius.
  std::vector<double> radii(double delta) const {
    return shells == 0 ? std::vector<double>{1} : Shells(shells, delta, normalization).radii;
  }
  void add_segment(const OracleRay& ray, const std::vector<OracleSphere>& spheres, double from, double to,
                   glm::dvec4& out) const {
    if (!(to > from)) return;
    dvec3 weighted(0);
    double weights = 0, depth = 0;
    for (const OracleSphere& s : spheres) {
      const double delta = ray_delta(ray, s.center, s.radius);
      const double reach = s.radius * radii(delta).front();
      if (glm::length(ray.origin + 0.5 * (from + to) * ray.direction - s.center) >= reach) continue;
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
