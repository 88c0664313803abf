// Eigenvalues of symmetric 3 x 3 matrices, as of the covariance of points.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/vec.h"

namespace sfumato {

struct Symmetric3 {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
};

/// Largest first. By the trigonometric solution of the cubic (Smith 1961): errors are some 1e-8 of the
/// largest where two nearly coincide, as everywhere where only eigenvalues are asked for; for eigenvectors
/// there is Eigen.
inline dvec3 eigenvalues(const Symmetric3& m) {
  const double mean = (m.xx + m.yy + m.zz) / 3;
  const double x = m.xx - mean, y = m.yy - mean, z = m.zz - mean;
  const double p = std::sqrt((x * x + y * y + z * z + 2 * (m.xy * m.xy + m.xz * m.xz + m.yz * m.yz)) / 6);
  if (!(p > 0)) return dvec3(mean);
  const double a = x / p, b = y / p, c = z / p, d = m.xy / p, e = m.xz / p, f = m.yz / p;
  const double determinant = a * (b * c - f * f) - d * (d * c - f * e) + e * (d * f - b * e);
  const double angle = std::acos(std::clamp(determinant / 2, -1.0, 1.0)) / 3;
  const double largest = mean + 2 * p * std::cos(angle),
               least = mean + 2 * p * std::cos(angle + 2 * std::numbers::pi / 3);
  return {largest, 3 * mean - largest - least, least};
}

}  // namespace sfumato
