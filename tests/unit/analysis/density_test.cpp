#include "analysis/density.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "analysis/morton.h"
#include "clouds.h"

using namespace sfumato;
using namespace sfumato::analysis;
using namespace sfumato::test;

namespace {

// Random points on a slope of 45 degrees: as many a unit of the slope, not of its plan.
TEST(SurfaceDensity, IsThatOfRandomPointsOnASlope) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(0, 10);
  for (const int count : {4'000, 40'000}) {
    std::vector<vec3> positions;
    for (int i = 0; i < count; ++i) {
      const float x = uniform(random);
      positions.push_back({x, uniform(random), x});
    }
    PointCloud cloud = cloud_of(positions);
    reorder(cloud, morton_order(cloud));
    const std::vector<float> density = surface_density(NeighborTree(cloud.positions));
    double sum = 0;
    int inside = 0;
    for (std::size_t i = 0; i < density.size(); ++i) {
      const vec3 p = cloud.positions[i];
      if (std::min({p.x, p.y, 10 - p.x, 10 - p.y}) < 1) continue;  // circles that the border cuts
      sum += density[i], ++inside;
    }
    // The estimate is unbiased; its deviation of 1/sqrt(14) a point leaves 1 % of so many that share theirs.
    EXPECT_NEAR(sum / inside / (count / (100 * std::sqrt(2.0))), 1, 0.03) << count;
  }
}

TEST(SurfaceDensity, OfPointsInOnePlaceIsNoNumber) {
  const std::vector<vec3> positions(40, vec3(1, 2, 3));
  for (const float value : surface_density(NeighborTree(positions))) EXPECT_TRUE(std::isnan(value));
  EXPECT_TRUE(surface_density(NeighborTree(std::vector<vec3>())).empty());
}

}  // namespace
