// How far points are apart, and on surfaces, where they are drawn as themselves.
#include "analysis/dots.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

#include "analysis/prepare.h"
#include "clouds.h"

using namespace sfumato;
using namespace sfumato::analysis;
using namespace sfumato::test;

namespace {

/// A level square and a ball of random points above it, as many each; the ball's have z > 1.
PointCloud square_and_ball(std::size_t each) {
  PointCloud cloud;
  cloud.positions = uniform_square(each);
  for (const vec3& p : uniform_cube(4 * each, 5))
    if (glm::distance(p, vec3(0.5f)) < 0.5f && cloud.positions.size() < 2 * each)
      cloud.positions.push_back(p + vec3(0, 0, 1.5f));
  return cloud;
}

TEST(Dots, SurfacesAreToldFromWhatFillsSpace) {
  for (const std::size_t each : {4'000u, 40'000u}) {
    const PreparedCloud prepared = prepare(square_and_ball(each), {}, {});
    const std::vector<vec2> dots = dots_of(prepared);
    ASSERT_EQ(dots.size(), prepared.cloud.size());
    double surface = 0, filled = 0;
    std::size_t on = 0, in = 0;
    for (std::size_t i = 0; i < dots.size(); ++i) {
      const bool is_ball = prepared.cloud.positions[i].z + float(prepared.cloud.origin.z) > 1;
      (is_ball ? filled : surface) += double(dots[i].y), ++(is_ball ? in : on);
    }
    EXPECT_GT(surface / double(on), 0.95) << each;
    EXPECT_LT(filled / double(in), 0.02) << each;
  }
}

// What is near each other has one size, whatever 8 neighbours happen to be.
TEST(Dots, NeighboursAreAlike) {
  const PreparedCloud prepared = prepare(square_and_ball(4'000), {}, {});
  const std::vector<vec2> dots = dots_of(prepared);
  std::size_t jumps = 0, pairs = 0;
  for (std::size_t i = 1; i < dots.size(); ++i) {
    if (glm::distance(prepared.cloud.positions[i], prepared.cloud.positions[i - 1]) > 0.05f) continue;
    ++pairs, jumps += std::abs(std::log2(dots[i].x / dots[i - 1].x)) > 0.2f;
  }
  EXPECT_LT(double(jumps), 0.03 * double(pairs));
}

// Dots meet the next one on their line, not the next line; on a surface, the next in both directions.
TEST(Dots, OnALineTheyAreAsFarApartAsAlongIt) {
  std::mt19937 random(7);
  std::normal_distribution<float> noise(0, 0.05f);
  for (const int gap : {1, 20}) {
    PointCloud cloud;
    for (int line = 0; line < 40; ++line)
      for (int i = 0; i < 400; ++i)
        cloud.positions.emplace_back(float(i) + noise(random), float(gap * line) + noise(random),
                                     noise(random));
    const std::vector<vec2> dots = dots_of(prepare(cloud, {}, {}));
    const float unit = prepare(cloud, {}, {}).spacing_unit();
    std::vector<float> spacings;
    for (const vec2& dot : dots) spacings.push_back(dot.x * unit);
    std::sort(spacings.begin(), spacings.end());
    // The 8th neighbour is 4 steps away on a line: taken for that of a surface it says 2.4.
    EXPECT_GT(spacings[spacings.size() / 10], 0.8f) << gap;
    EXPECT_LT(spacings[spacings.size() * 9 / 10], gap == 1 ? 1.2f : 1.5f) << gap;
  }
}

// Too few to tell.
TEST(Dots, FewPointsAreClosed) {
  PointCloud cloud;
  cloud.positions = uniform_cube(100);
  const PreparedCloud prepared = prepare(cloud, {}, {});
  for (const vec2& dot : dots_of(prepared)) {
    EXPECT_NEAR(dot.x * prepared.spacing_unit() / prepared.median_spacing, 1, 2e-3);  // of an even number
    EXPECT_EQ(dot.y, 1);
  }
}

/// Whatever the order of the points, of which some lie in one place: as many as a run has, and more.
TEST(Dots, AreThoseOfPlacesNotOfTheOrder) {
  PointCloud cloud = square_and_ball(10'000);
  for (std::size_t i = 0; i < 300; ++i) cloud.positions[i] = cloud.positions[i % 40 + 1'000];
  const auto by_place = [](const PointCloud& of) {
    const PreparedCloud prepared = prepare(of, {}, {});
    const std::vector<vec2> dots = dots_of(prepared);
    std::vector<std::array<double, 5>> rows;
    for (std::size_t i = 0; i < dots.size(); ++i) {
      const dvec3 p = prepared.cloud.world(i);
      rows.push_back({p.x, p.y, p.z, dots[i].x, dots[i].y});
    }
    std::sort(rows.begin(), rows.end());
    return rows;
  };
  PointCloud shuffled = cloud;
  std::shuffle(shuffled.positions.begin(), shuffled.positions.end(), std::mt19937(3));
  const auto rows = by_place(cloud);
  EXPECT_TRUE(rows == by_place(shuffled));
  for (std::size_t i = 1; i < rows.size(); ++i)
    if (std::equal(rows[i].begin(), rows[i].begin() + 3, rows[i - 1].begin()))
      EXPECT_EQ(rows[i], rows[i - 1]) << "which of them is drawn is chance";
}

}  // namespace
