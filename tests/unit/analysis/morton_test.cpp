#include "analysis/morton.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "clouds.h"

using namespace sfumato;
using namespace sfumato::analysis;
using namespace sfumato::test;

namespace {

/// Mean distance between points that follow each other.
double mean_step(const std::vector<vec3>& positions, const std::vector<std::uint32_t>& order) {
  double sum = 0;
  for (std::size_t i = 1; i < order.size(); ++i)
    sum += glm::distance(positions[order[i]], positions[order[i - 1]]);
  return sum / double(order.size() - 1);
}

TEST(Morton, FollowsTheCurveOnTheEightCornersOfACube) {
  // Corner i of the cube in the order x fastest, then y, then z: its place on the curve is i.
  PointCloud cloud;
  const std::vector<std::uint32_t> shuffled = {5, 0, 7, 2, 6, 1, 3, 4};
  for (std::uint32_t i : shuffled)
    cloud.positions.push_back(vec3(float(i & 1), float(i >> 1 & 1), float(i >> 2)));
  const auto order = morton_order(cloud);
  for (std::uint32_t i = 0; i < 8; ++i) EXPECT_EQ(shuffled[order[i]], i);
}

TEST(Morton, IsAPermutationThatKeepsNeighborsTogether) {
  const PointCloud cloud = cloud_of(uniform_cube(20'000));
  const auto order = morton_order(cloud);
  EXPECT_EQ(std::set<std::uint32_t>(order.begin(), order.end()).size(), cloud.size());
  std::vector<std::uint32_t> file_order(cloud.size());
  std::iota(file_order.begin(), file_order.end(), 0u);
  // Random points of a unit cube are 0.66 apart; the curve steps by about 1.5 spacings of 20000^(-1/3) =
  // 0.037.
  EXPECT_GT(mean_step(cloud.positions, file_order), 0.6);
  EXPECT_LT(mean_step(cloud.positions, order), 0.08);
}

TEST(Morton, AFarOutlierDoesNotFlattenTheCurve) {
  std::vector<vec3> positions = uniform_cube(20'000);
  positions.push_back({1e9f, 0, 0});  // one cell of 2^21 is then 477 wide and holds the whole cube
  const PointCloud cloud = cloud_of(positions);
  auto order = morton_order(cloud);
  EXPECT_EQ(order.back(), 20'000u);
  order.pop_back();
  EXPECT_LT(mean_step(cloud.positions, order), 0.08);
}

TEST(Morton, RefusesDamagedCoordinates) {
  try {
    morton_order(cloud_of({vec3(0), vec3(3e38f)}));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_input);
  }
}

TEST(Morton, CoincidentPointsKeepTheOrderOfTheFile) {
  PointCloud cloud;
  for (int i = 0; i < 1000; ++i) cloud.positions.push_back(vec3(float(i % 2), 0, 0));
  auto order = morton_order(cloud);
  for (std::uint32_t i = 0; i < 500; ++i) {
    EXPECT_EQ(order[i], 2 * i);
    EXPECT_EQ(order[500 + i], 2 * i + 1);
  }
  // A cloud that is a selection knows its places in the file: they decide, not the places in memory.
  for (std::uint32_t i = 0; i < 1000; ++i) cloud.source_index.push_back(5000 - i);
  order = morton_order(cloud);
  for (std::uint32_t i = 0; i < 500; ++i) EXPECT_EQ(order[i], 998 - 2 * i);
  cloud.positions.assign(1000, vec3(7));
  order = morton_order(cloud);
  for (std::uint32_t i = 0; i < 1000; ++i) EXPECT_EQ(order[i], 999 - i);
}

TEST(Morton, TheOrderOfTheFileDecidesOnlyAmongCoincidentPoints) {
  // Pairs closer than a cell, 2^-21 of the box.
  PointCloud cloud = cloud_of(uniform_cube(3000));
  const std::size_t n = cloud.size();
  for (std::size_t i = 0; i < n; ++i) {
    const vec3 p = cloud.positions[i];
    cloud.positions.push_back({std::nextafter(p.x, 2.0f), p.y, std::nextafter(p.z, -2.0f)});
  }
  PointCloud backwards = cloud;
  std::reverse(backwards.positions.begin(), backwards.positions.end());
  const auto forth = morton_order(cloud), back = morton_order(backwards);
  for (std::size_t i = 0; i < forth.size(); ++i)
    ASSERT_EQ(cloud.positions[forth[i]], backwards.positions[back[i]]) << i;
}

TEST(Morton, SameOrderForOneAndTwoThreads) {
  const PointCloud cloud = cloud_of(difficult_cloud());
  std::vector<std::uint32_t> alone;
  {
    tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    alone = morton_order(cloud);
  }
  tbb::global_control two(tbb::global_control::max_allowed_parallelism, 2);
  EXPECT_EQ(morton_order(cloud), alone);
}

TEST(Morton, ReorderMovesEveryAttribute) {
  PointCloud cloud = cloud_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});
  cloud.normals = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  cloud.colors = {{1, 1, 1, 1}, {2, 2, 2, 2}, {3, 3, 3, 3}};
  cloud.radii = {1, 2, 3};
  cloud.set_scalar({"intensity", 100, {1, 2, 3}});
  reorder(cloud, {2, 0, 1});
  EXPECT_EQ(cloud.positions[0].x, 2);
  EXPECT_EQ(cloud.normals[0], vec3(0, 0, 1));
  EXPECT_EQ(cloud.colors[1].r, 1);
  EXPECT_EQ(cloud.radii[2], 2);
  EXPECT_EQ(cloud.scalar("intensity")->value(0), 103);
  EXPECT_EQ(cloud.source_index, (std::vector<std::uint32_t>{2, 0, 1}));
  reorder(cloud, {1, 2, 0});  // once more: back to the file
  EXPECT_EQ(cloud.source_index, (std::vector<std::uint32_t>{0, 1, 2}));
}

}  // namespace
