// Distances between clouds, against every pair of points looked at.
#include "analysis/distances.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace sfumato::analysis {
namespace {

/// A rolling hill, `above` it, of another origin each; noise of `sigma`.
PointCloud hill(std::size_t count, double above, unsigned seed, const dvec3& origin, double sigma = 0.002) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(0, 4);
  std::normal_distribution<double> noise(0, sigma);
  PointCloud cloud;
  cloud.origin = origin;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = place(random), y = place(random),
                 z = 0.3 * std::sin(x) + 0.2 * y + above + noise(random);
    cloud.positions.push_back(vec3(dvec3(389120 + x, 5819300 + y, 34 + z) - origin));
  }
  return cloud;
}

const dvec3 here(389120, 5819300, 30), there(389100, 5819320, 0);

TEST(DistancesTest, NearestAgreesWithEveryPair) {
  const PointCloud now = hill(3000, 0.1, 1, here), before = hill(2500, 0, 2, there);
  const std::vector<float> found = nearest_distances(now, before);
  ASSERT_EQ(found.size(), now.size());
  for (std::size_t i = 0; i < now.size(); ++i) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < before.size(); ++j)
      least = std::min(least, glm::length(now.world(i) - before.world(j)));
    ASSERT_NEAR(double(found[i]), least, 1e-5) << i;  // floats of 20 units
  }
  for (float distance : nearest_distances(now, now)) EXPECT_EQ(distance, 0);
}

/// Slow and plain: normals by power iteration would be another oracle; here the cylinder's means of every
/// point, about the normal of the surface itself.
TEST(DistancesTest, SignedDistancesAreThoseAlongTheNormal) {
  const PointCloud before = hill(8000, 0, 2, there);
  for (const double above : {0.25, -0.4, 0.0}) {
    const PointCloud now = hill(8000, above, 1, here);
    const std::vector<float> found = signed_distances(now, before, 0.4);
    double worst = 0, sum = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < now.size(); i += 7) {
      const dvec3 p = now.world(i);
      const double x = p.x - 389120, y = p.y - 5819300;
      if (x < 0.8 || x > 3.2 || y < 0.8 || y > 3.2) continue;
      const dvec3 normal = glm::normalize(dvec3(-0.3 * std::cos(x), -0.2, 1));
      const auto mean = [&](const PointCloud& cloud) {
        double sum_along = 0, n = 0;
        for (std::size_t j = 0; j < cloud.size(); ++j) {
          const dvec3 d = cloud.world(j) - p;
          const double along = glm::dot(d, normal);
          if (std::abs(along) <= std::abs(above) + 0.4 && glm::dot(d, d) - along * along <= 0.04)
            sum_along += along, ++n;
        }
        return sum_along / n;
      };
      const double expected = mean(now) - mean(before);
      ASSERT_TRUE(std::isfinite(found[i])) << i;
      worst = std::max(worst, std::abs(double(found[i]) - expected));
      sum += double(found[i]), ++count;
    }
    EXPECT_GT(count, 200u);
    EXPECT_LT(worst, 0.01) << above;
    EXPECT_NEAR(sum / double(count), above * 0.95, std::abs(above) * 0.05 + 0.002);  // cosine of the slope
  }
}

TEST(DistancesTest, NothingInTheCylinderIsNoDistance) {
  PointCloud now = hill(4000, 0, 1, here), before;
  before.origin = here;
  for (std::size_t i = 0; i < now.size(); ++i)
    if (now.positions[i].x < 2) before.positions.push_back(now.positions[i]);
  const std::vector<float> found = signed_distances(now, before, 0.3);
  for (std::size_t i = 0; i < now.size(); ++i) {
    const bool is_inside =
        std::min(now.positions[i].x, now.positions[i].y) > 0.3f && now.positions[i].y < 3.7f;
    if (is_inside && now.positions[i].x < 1.5f) EXPECT_NEAR(found[i], 0, 1e-5) << i;
    if (now.positions[i].x > 2.4f) EXPECT_TRUE(std::isnan(found[i])) << i;
  }
  for (float distance : signed_distances(now, {}, 0.3)) EXPECT_TRUE(std::isnan(distance));
  for (float distance : nearest_distances(now, {})) EXPECT_TRUE(std::isnan(distance));
}

}  // namespace
}  // namespace sfumato::analysis
