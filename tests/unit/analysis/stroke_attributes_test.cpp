// How far strokes may reach: detail, strips, support.
#include "analysis/stroke_attributes.h"

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

/// `side`^2 points of a unit grid in z = 0, their colours by x.
PointCloud shaded_grid(int side, const std::function<float(int x)>& shade, float noise = 0) {
  PointCloud cloud = cloud_of(square_grid(side, 1));
  std::mt19937 random(3);
  std::normal_distribution<float> gauss(0, noise > 0 ? noise : 1);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const auto level = std::uint8_t(std::clamp(shade(x) + (noise > 0 ? gauss(random) : 0), 0.0f, 255.0f));
      cloud.colors.push_back({level, level, level});
    }
  return cloud;
}

std::vector<float> details(const PointCloud& cloud) {
  return detail_lengths(cloud.positions, cloud.colors, std::vector<vec3>(cloud.size(), vec3(0, 0, 1)),
                        dvec3(0), 1, {});
}

TEST(StrokeDetail, StrokesAreShortAtAnEdgeAndLongAwayFromIt) {
  constexpr int side = 160;
  const std::vector<float> length = details(shaded_grid(side, [](int x) { return x < 80 ? 60.0f : 180.0f; }));
  for (int x = 0; x < side; ++x) {
    const float away = std::abs(float(x) - 79.5f), here = length[std::size_t(80 * side + x)];
    // A step of 120 levels in three channels deviates by sqrt(3) 60 levels, ten times what a stroke may
    // unite: at the edge a cell of 4 spacings makes that 0.4, and no cell that holds the edge is more than 3
    // times as wide as it is away.
    if (away < 2) EXPECT_LT(here, 2) << x;
    if (away > 40) EXPECT_GT(here, 3) << x;
    EXPECT_LT(here, std::max(3 * away, 2.0f)) << x;
  }
}

TEST(StrokeDetail, NoiseOfPointsIsNoDetail) {
  const std::vector<float> even = details(shaded_grid(
      96, [](int) { return 120.0f; }, 25));
  std::vector<float> sorted = even;
  std::sort(sorted.begin(), sorted.end());
  // 25 levels in each channel are 4 times what a stroke may unite. A variance estimated from few cells
  // exceeds its mean by chance, in the smallest of them: some strokes of ten spacings remain.
  EXPECT_GT(sorted[sorted.size() / 2], 8);
  // The same spread as a pattern of 8 spacings is detail everywhere.
  for (float length : details(shaded_grid(96, [](int x) { return x / 4 % 2 ? 95.0f : 145.0f; })))
    EXPECT_LT(length, 5);
}

TEST(StrokeDetail, ASlopeOfColourLimitsByItsSteepness) {
  // One level a spacing in three channels: a stroke of width w deviates by sqrt(3) w / sqrt(12) = w / 2
  // levels; 10 of them at 20 spacings. Cells are coarser and their parts means: within a factor of two.
  const std::vector<float> length = details(shaded_grid(200, [](int x) { return float(x); }));
  const float middle = length[100 * 200 + 100];
  EXPECT_GT(middle, 10);
  EXPECT_LT(middle, 40);
}

TEST(StrokeShape, PlanesPolesAndLeaves) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::vector<vec3> plane, pole, leaves, line;
  std::vector<std::uint32_t> all;
  for (std::uint32_t i = 0; i < 400; ++i) {
    const float angle = 3.14159265f * uniform(random);
    plane.push_back({uniform(random), uniform(random), 0.01f * uniform(random)});
    pole.push_back({0.2f * std::cos(angle), 0.2f * std::sin(angle), uniform(random)});
    leaves.push_back({uniform(random), uniform(random), uniform(random)});
    line.push_back({0.001f * uniform(random), 0.001f * uniform(random), uniform(random)});
    if (i > 0) all.push_back(i);
  }
  EXPECT_LT(neighborhood_shape(plane, 0, all, 0.1f).non_planarity, 0.05f);
  EXPECT_EQ(neighborhood_shape(plane, 0, all, 0.1f).strip_width, 0);
  EXPECT_GT(neighborhood_shape(leaves, 0, all, 0.1f).non_planarity, 0.8f);
  // A ring of radius r has the variance r^2 / 2 either way: a strip of that is sqrt(6) r wide. 10 %: 400
  // random points.
  EXPECT_NEAR(neighborhood_shape(pole, 0, all, 0.1f).strip_width, std::sqrt(6.0f) * 0.2f, 0.05f);
  EXPECT_EQ(neighborhood_shape(line, 0, all, 0.1f).strip_width, 0);  // a single line of a scanner
  EXPECT_EQ(neighborhood_shape(line, 0, {}, 0.1f).non_planarity, 1);
}

TEST(StrokeSize, WhatHasNoSupportIsCapped) {
  PointCloud cloud = cloud_of(square_grid(40, 1));
  cloud.positions.push_back({20, 20, 15});
  cloud.positions.push_back({20.5f, 20, 15});
  const PreparedCloud prepared = prepare(cloud, Attribute::cluster, {});
  const std::vector<float>& sizes = prepared.cloud.scalar("stroke_size")->values;
  float on_grid = 0;
  for (std::size_t i = 0; i < sizes.size(); ++i)
    if (prepared.cloud.source_index[i] < 1600) on_grid = std::max(on_grid, sizes[i]);
  for (std::size_t i = 0; i < sizes.size(); ++i)
    if (prepared.cloud.source_index[i] >= 1600) EXPECT_LE(sizes[i], 2 * on_grid);  // their own would be 15
}

TEST(StrokeAxis, SurvivesPacking) {
  std::mt19937 random(5);
  std::normal_distribution<float> gauss(0, 1);
  EXPECT_FALSE(unpack_axis(0));
  for (int i = 0; i < 1000; ++i) {
    const vec3 axis = glm::normalize(vec3(gauss(random), gauss(random), gauss(random)));
    const auto back = unpack_axis(pack_axis(axis));
    ASSERT_TRUE(back);
    ASSERT_GT(std::abs(glm::dot(axis, *back)), 1 - 2e-6f);  // 1/4094 in two coordinates, squared and halved
  }
}

TEST(StrokeOptions, SizesOfClustersAreThoseOfThePaper) {
  // Two squares of two colours and spacings, each on a perfect grid: s = r within it, up to the rims.
  PointCloud cloud = cloud_of(square_grid(30, 1));
  cloud.colors.assign(900, {200, 40, 40});
  PointCloud wide = cloud_of(square_grid(30, 2));
  for (vec3& p : wide.positions) p.x += 300;
  wide.colors.assign(900, {40, 40, 200});
  append(cloud, wide);
  PrepareOptions options;
  options.strokes.size_of = SizeOf::cluster;
  options.strokes.size_neighbors = 4;
  options.strokes.size_spread = 0;
  const PreparedCloud prepared = prepare(cloud, Attribute::cluster, options);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const float spacing = prepared.cloud.source_index[i] < 900 ? 1 : 2;
    // The rims' fourth neighbour is farther: 4 x 28 points of 900 at (3 + sqrt 2) / 4.
    ASSERT_NEAR(prepared.cloud.scalar("stroke_size")->values[i], spacing, 0.03f * spacing);
  }
}

}  // namespace
