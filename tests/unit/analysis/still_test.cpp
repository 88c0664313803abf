// Points that stand still while their noise does not.
#include "analysis/still.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

using namespace sfumato;

namespace {

/// A wall of random points, `spacing` apart, measured with noise of so many spacings along all axes; in
/// another order and about another origin for every `seed`. One part of it moved by `moved`.
PointCloud wall(double noise, unsigned seed, float moved = 0) {
  constexpr double spacing = 0.01;
  std::mt19937 places(1), random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal(0, 1);
  PointCloud cloud;
  cloud.origin = dvec3(500'000.25 + seed, 0, 0);
  for (int i = 0; i < 10'000; ++i) {
    dvec3 p(500'000 + uniform(places), 0, uniform(places));
    if (moved != 0 && p.x > 500'000.5) p.z += moved;
    p += noise * spacing * dvec3(normal(random), normal(random), normal(random));
    cloud.positions.push_back(vec3(p - cloud.origin));
    cloud.colors.push_back({std::uint8_t(100 + random() % 3), 80, 60});
  }
  std::vector<std::uint32_t> order(cloud.size());
  std::iota(order.begin(), order.end(), 0u);
  std::shuffle(order.begin(), order.end(), random);
  PointCloud shuffled = select(cloud, order);
  shuffled.source_index.clear();
  return shuffled;
}

std::vector<std::array<float, 3>> places_of(const PointCloud& cloud) {
  std::vector<std::array<float, 3>> places;
  for (const vec3& p : cloud.positions) places.push_back({p.x, p.y, p.z});
  std::sort(places.begin(), places.end());
  return places;
}

double share_in_common(const PointCloud& a, const PointCloud& b) {
  if (a.origin != b.origin) return 0;
  const auto one = places_of(a), two = places_of(b);
  std::vector<std::array<float, 3>> both;
  std::set_intersection(one.begin(), one.end(), two.begin(), two.end(), std::back_inserter(both));
  return double(both.size()) / double(one.size());
}

TEST(StillPoints, NoiseBelowTheSpacingMovesNothing) {
  for (const auto& [noise, held] : {std::pair(0.0, 1.0), {0.02, 0.98}, {0.05, 0.94}, {0.2, 0.65}}) {
    analysis::StillPoints still;
    PointCloud before = wall(noise, 1);
    still.hold(before, 6);
    for (unsigned frame = 2; frame < 5; ++frame) {
      PointCloud now = wall(noise, frame);
      still.hold(now, 6);
      EXPECT_GE(share_in_common(before, now), held) << noise << " " << frame;
      before = std::move(now);
    }
  }
}

TEST(StillPoints, WhatMovesIsSeenToMove) {
  analysis::StillPoints still;
  PointCloud before = wall(0.02, 1), now = wall(0.02, 2, 0.3f);
  still.hold(before, 6);
  still.hold(now, 6);
  EXPECT_LT(share_in_common(before, now), 0.75);  // some now stand where others stood
  const auto above =
      std::count_if(now.positions.begin(), now.positions.end(), [](const vec3& p) { return p.z > 1.05f; });
  EXPECT_NEAR(double(above), 1250, 100);
}

TEST(StillPoints, ColoursStayWhileTheyAreAlike) {
  analysis::StillPoints still;
  PointCloud before = wall(0, 1), now = wall(0, 1);
  for (Rgba8& color : now.colors) color.g = std::uint8_t(color.g + 3);
  now.colors[7] = {0, 0, 0, 255};
  still.hold(before, 6);
  still.hold(now, 6);
  for (std::size_t i = 0; i < now.size(); ++i)
    EXPECT_EQ(now.colors[i], i == 7 ? Rgba8(0, 0, 0, 255) : before.colors[i]);
}

TEST(StillPoints, NothingAndOnePointAreFrames) {
  analysis::StillPoints still;
  PointCloud none, one;
  one.positions.push_back(vec3(1, 2, 3));
  still.hold(none, 6);
  still.hold(one, 6);
  still.hold(one, 6);
  EXPECT_EQ(one.positions[0], vec3(1, 2, 3));
  still.hold(none, 6);
}

}  // namespace
