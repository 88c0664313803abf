// Noise of the surface that a point lies on, whatever lies before or behind it.
#include "analysis/local_noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "analysis/prepare.h"
#include "clouds.h"

using namespace sfumato;
using namespace sfumato::analysis;
using namespace sfumato::test;

namespace {

/// Sheets of a point per unit of area, `gap` apart, each with noise along z.
std::vector<vec3> sheets(int count, float gap, float noise, std::size_t each = 10'000) {
  std::mt19937 random(6);
  std::normal_distribution<float> gauss;
  std::vector<vec3> points;
  for (int sheet = 0; sheet < count; ++sheet)
    for (const vec3& p : uniform_square(each, 20 + unsigned(sheet)))
      points.push_back(std::sqrt(float(each)) * p + vec3(0, 0, float(sheet) * gap + noise * gauss(random)));
  return points;
}

double median_noise(std::vector<vec3> points) {
  PointCloud cloud;
  cloud.positions = std::move(points);
  const PreparedCloud prepared = prepare(std::move(cloud), {}, {});
  std::vector<float> noise = noise_near(prepared.cloud.positions, placed_noise_of(prepared));
  std::nth_element(noise.begin(), noise.begin() + std::ptrdiff_t(noise.size() / 2), noise.end());
  return double(noise[noise.size() / 2]);
}

TEST(LocalNoise, OfOneSurface) {
  EXPECT_LT(median_noise(sheets(1, 0, 0)), 1e-5);
  for (const float noise : {0.1f, 0.25f, 0.5f})
    EXPECT_NEAR(median_noise(sheets(1, 0, noise)) / noise, 1, 0.1);
  // A ball of 25 points is hardly wider than noise of a spacing is deep.
  EXPECT_GT(median_noise(sheets(1, 0, 1)), 0.7);
}

// The standard deviation of all neighbours would be half the gap.
TEST(LocalNoise, ASecondSurfaceIsNone) {
  EXPECT_LT(median_noise(sheets(2, 2, 0)), 0.25);  // some of the nearest 25 points are across the gap
  for (const float gap : {3.0f, 5.0f}) EXPECT_LT(median_noise(sheets(2, gap, 0)), 1e-5) << gap;
  for (const float gap : {3.0f, 4.0f, 6.0f})
    EXPECT_NEAR(median_noise(sheets(2, gap, 0.25f)) / 0.25, 1, 0.25) << gap;
}

TEST(LocalNoise, IsMeasuredPlaceByPlace) {
  std::vector<vec3> points = sheets(1, 0, 0.05f);
  for (const vec3& p : sheets(1, 0, 0.5f)) points.push_back(p + vec3(200, 0, 0));
  PointCloud cloud;
  cloud.positions = points;
  const PreparedCloud prepared = prepare(std::move(cloud), {}, {});
  const std::vector<float> noise = noise_near(prepared.cloud.positions, placed_noise_of(prepared));
  double sum[2] = {};
  std::size_t count[2] = {};
  for (std::size_t i = 0; i < noise.size(); ++i) {
    const bool is_far = double(prepared.cloud.positions[i].x) + prepared.cloud.origin.x > 150;
    sum[is_far] += double(noise[i]), ++count[is_far];
  }
  EXPECT_NEAR(sum[0] / double(count[0]), 0.05, 0.01);
  EXPECT_NEAR(sum[1] / double(count[1]), 0.5, 0.08);
}

TEST(LocalNoise, OfFewPointsAndOfPointsInOnePlaceIsNone) {
  EXPECT_EQ(trimmed_deviation({}), 0);
  std::vector<vec3> few = uniform_cube(8);
  EXPECT_GT(trimmed_deviation(few), 0);
  few.pop_back();
  EXPECT_EQ(trimmed_deviation(few), 0);
  EXPECT_EQ(trimmed_deviation(std::vector<vec3>(25, vec3(0))), 0);
  EXPECT_TRUE(noise_near({}, {}).empty());
  EXPECT_EQ(noise_near(std::vector<vec3>(2, vec3(0)), {}), std::vector<float>(2, 0));
}

}  // namespace
