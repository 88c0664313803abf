// Against Eigen, which iterates where ours has a formula.
#include "core/symmetric3.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

namespace sfumato {
namespace {

dvec3 by_iteration(const Symmetric3& m) {
  Eigen::Matrix3d matrix;
  matrix << m.xx, m.xy, m.xz, m.xy, m.yy, m.yz, m.xz, m.yz, m.zz;
  const Eigen::Vector3d values = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(matrix).eigenvalues();
  return {values[2], values[1], values[0]};
}

void expect_as_by_iteration(const Symmetric3& m) {
  const dvec3 ours = eigenvalues(m), theirs = by_iteration(m);
  // acos turns a rounding of 1e-16 into an angle of 1e-8 where two eigenvalues coincide.
  const double most = 3e-8 * std::max(std::abs(theirs.x), std::abs(theirs.z));
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(ours[k], theirs[k], most) << k;
}

TEST(Symmetric3, EigenvaluesAreThoseOfAnIteration) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 2000; ++i) {
    const double scale = std::pow(10.0, i % 21 - 10);
    expect_as_by_iteration({scale * normal(random), scale * normal(random), scale * normal(random),
                            scale * normal(random), scale * normal(random), scale * normal(random)});
    // Of points on a plane and on a line.
    const double x = normal(random), y = normal(random), z = normal(random), w = normal(random);
    expect_as_by_iteration({x * x + 1, x * y, x * z, y * y + 1, y * z, z * z});
    expect_as_by_iteration({w * x * x, w * x * y, w * x * z, w * y * y, w * y * z, w * z * z});
  }
}

TEST(Symmetric3, EqualEigenvaluesAreEqual) {
  EXPECT_EQ(eigenvalues({}), dvec3(0));
  EXPECT_EQ(eigenvalues({2, 0, 0, 2, 0, 2}), dvec3(2));
  const dvec3 two = eigenvalues({1, 0, 0, 3, 0, 3});
  EXPECT_NEAR(two.x, 3, 1e-7);
  EXPECT_NEAR(two.y, 3, 1e-7);
  EXPECT_NEAR(two.z, 1, 1e-7);
}

}  // namespace
}  // namespace sfumato
