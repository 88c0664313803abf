#include "analysis/sensor_view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

using namespace sfumato;
using namespace sfumato::analysis;

namespace {

/// What a lidar of 16 lines, 2 degrees apart, measures inside a sphere in steps of 0.2 degrees, in any order.
std::vector<vec3> sweep() {
  std::vector<vec3> points;
  for (int line = 0; line < 16; ++line)
    for (int step = 0; step < 1800; ++step) {
      const double elevation = (2 * line - 15) * std::numbers::pi / 180,
                   azimuth = 0.2 * step * std::numbers::pi / 180;
      points.push_back(10.0f * vec3(std::cos(elevation) * std::cos(azimuth),
                                    std::cos(elevation) * std::sin(azimuth), std::sin(elevation)));
    }
  std::shuffle(points.begin(), points.end(), std::mt19937(1));
  return points;
}

}  // namespace

TEST(TurnedShare, IsAllOfASweepAboutItsAxis) {
  std::vector<vec3> points = sweep();
  EXPECT_GT(turned_share(points, vec3(0), vec3(0, 0, 1)), 0.98);
  EXPECT_LT(turned_share(points, vec3(0), vec3(1, 0, 0)), 0.5);
  // Beside a stray all others have nearly the same x; that one of the 128 may be it.
  points.push_back({1e6f, 0, 0});
  EXPECT_GT(turned_share(points, vec3(0), vec3(0, 0, 1)), 0.97);
}

TEST(TurnedShare, OfAPlaneAcrossXIsThatOfItsLines) {
  std::vector<vec3> lines;
  for (int line = -10; line <= 10; ++line)
    for (int step = -500; step <= 500; ++step) lines.push_back({10, 0.01f * float(step), 0.2f * float(line)});
  // All have one x. Along a level line the elevation falls to the sides, the steeper the farther up it is.
  EXPECT_GT(turned_share(lines, vec3(0), vec3(0, 0, 1)), 0.8);
  EXPECT_LT(turned_share(lines, vec3(0), vec3(0, 1, 0)), 0.1);
}

TEST(TurnedShare, IsLittleOfRandomPoints) {
  std::mt19937 random(2);
  std::normal_distribution<float> normal;
  std::vector<vec3> points(20'000);
  for (vec3& p : points) p = 10.0f * glm::normalize(vec3(normal(random), normal(random), normal(random)));
  // A tenth of the directions are as level as that, and half of those steps are as long as is usual.
  EXPECT_LT(turned_share(points, vec3(0), vec3(0, 0, 1)), 0.2);
  EXPECT_EQ(turned_share({}, vec3(0), vec3(0, 0, 1)), 0);
}

TEST(SensorView, ALatticeIsNoPicture) {
  // What one image shows of ground, with noisy depths, and a body of voxels before the origin.
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.02);
  std::vector<dvec3> image, body;
  for (int row = -60; row <= 60; ++row)
    for (int column = -80; column <= 80; ++column)
      image.push_back((2 + noise(random)) * dvec3(0.006 * column, 0.006 * row, 1));
  for (int i = -20; i <= 20; ++i)
    for (int j = -20; j <= 20; ++j)
      for (int k = 20; k <= 80; ++k) body.push_back(dvec3(0.0116 * i, 0.01 * j, 0.03 * k));
  EXPECT_TRUE(sensor_view_of(image, dvec3(0), dvec3(0, 0, 1), dvec3(0, 1, 0)).of_pixels);
  EXPECT_FALSE(sensor_view_of(body, dvec3(0), dvec3(0, 0, 1), dvec3(0, 1, 0)).of_pixels);
  // A wall across the line of sight has one place for each pixel.
  for (dvec3& p : image) p *= 2 / p.z;
  EXPECT_TRUE(sensor_view_of(image, dvec3(0), dvec3(0, 0, 1), dvec3(0, 1, 0)).of_pixels);
}
