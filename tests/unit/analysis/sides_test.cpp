// The sides of thin sheets that were measured on both.
#include "analysis/sides.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <random>

#include "analysis/prepare.h"
#include "clouds.h"

using namespace sfumato;
using namespace sfumato::analysis;
using namespace sfumato::test;

namespace {

constexpr int across = 40;  ///< spacings; the spacing is 1

/// Random points of a plane, noise off it.
std::vector<vec3> plane_at(float height, float noise, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(0, across);
  std::normal_distribution<float> off(0, 1);
  std::vector<vec3> points;
  for (int i = 0; i < across * across; ++i) {
    const float x = place(random), y = place(random);
    points.emplace_back(x, y, height + noise * off(random));
  }
  return points;
}

/// First all of the upper side, then all of the lower.
std::vector<vec3> plate(float gap, float noise) {
  std::vector<vec3> points = plane_at(0.5f * gap, noise, 3);
  for (const vec3& p : plane_at(-0.5f * gap, noise, 4)) points.push_back(p);
  return points;
}

int nobody_knows(std::uint32_t, const vec3&) { return 0; }

/// Of the points, by where they came from: 1 marked with a normal that faces up, -1 down, 0 not marked.
std::vector<int> marked_sides(PointCloud cloud) {
  const std::size_t n = cloud.size();
  const PreparedCloud prepared = prepare(std::move(cloud), Attribute::normal | Attribute::radius, {});
  std::vector<int> sides(n);
  for (std::size_t i = 0; i < n && !prepared.on_surface.empty(); ++i)
    if (prepared.on_surface[i] < 0)
      sides[prepared.cloud.source_index[i]] = prepared.cloud.normals[i].z > 0 ? 1 : -1;
  return sides;
}

/// Shares of points of the upper half that are marked as up, and of those that are marked otherwise.
std::pair<double, double> right_and_wrong(const std::vector<int>& sides) {
  double right = 0, wrong = 0;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const int truth = i < sides.size() / 2 ? 1 : -1;
    right += sides[i] == truth, wrong += sides[i] == -truth;
  }
  return {right / double(sides.size()), wrong / double(sides.size())};
}

}  // namespace

TEST(Sides, APlateHasTwo) {
  for (const float gap : {0.5f, 1.0f, 2.0f, 3.0f})
    for (const float noise : {0.0f, gap < 1 ? 0.05f : 0.1f}) {
      const auto [right, wrong] = right_and_wrong(marked_sides(cloud_of(plate(gap, noise))));
      // Beyond the border of a place that tells there may be none: a row of places of 8 spacings along it.
      EXPECT_GT(right, 0.97) << gap << ' ' << noise;
      EXPECT_LT(wrong, 1e-3) << gap << ' ' << noise;
    }
}

TEST(Sides, NormalsOfTheFileTellThoseThatNoiseHides) {
  PointCloud cloud = cloud_of(plate(0.5f, 0.25f));
  EXPECT_LT(right_and_wrong(marked_sides(cloud)).first, 0.01) << "positions alone do not tell";
  for (std::size_t i = 0; i < cloud.size(); ++i)
    cloud.normals.emplace_back(0, 0, i < cloud.size() / 2 ? 1 : -1);
  const auto [right, wrong] = right_and_wrong(marked_sides(cloud));
  EXPECT_GT(right, 0.97);
  EXPECT_EQ(wrong, 0);
}

TEST(Sides, NormalsThatFaceEachOtherAreThoseOfAGap) {
  PointCloud cloud = cloud_of(plate(1, 0));
  for (std::size_t i = 0; i < cloud.size(); ++i)
    cloud.normals.emplace_back(0, 0, i < cloud.size() / 2 ? -1 : 1);
  for (const int side : marked_sides(cloud)) ASSERT_EQ(side, 0);
}

TEST(Sides, NormalsOfOneSignAreThoseOfOneSurfaceSeenTwice) {
  PointCloud cloud = cloud_of(plate(1, 0));
  cloud.normals.assign(cloud.size(), vec3(0, 0, 1));
  for (const int side : marked_sides(cloud)) ASSERT_EQ(side, 0);
}

TEST(Sides, AScannerTellsThem) {
  PointCloud cloud = cloud_of(plate(1, 0.1f));
  cloud.scanners = {dvec3(20, 20, 100)};  // saw both layers from above
  for (const int side : marked_sides(cloud)) ASSERT_EQ(side, 0);
  cloud.scanners.push_back(dvec3(20, 20, -100));
  ScalarField scanner{"scanner", 0, std::vector<float>(cloud.size(), 0.0f)};
  std::fill(scanner.values.begin() + std::ptrdiff_t(cloud.size() / 2), scanner.values.end(), 1.0f);
  cloud.set_scalar(std::move(scanner));
  const auto [right, wrong] = right_and_wrong(marked_sides(cloud));
  EXPECT_GT(right, 0.97);
  EXPECT_EQ(wrong, 0);
}

TEST(Sides, NothingElseIsASheet) {
  std::mt19937 random(9);
  std::uniform_real_distribution<float> place(0, across);
  const auto sheets = [&](std::string_view name, const std::vector<vec3>& points) {
    int found = 0;
    for (const int side : marked_sides(cloud_of(points))) found += side != 0;
    EXPECT_EQ(found, 0) << name;
  };
  for (const float noise : {0.0f, 0.1f, 0.3f, 1.0f}) sheets("a plane", plane_at(0, noise, 5));
  std::vector<vec3> ball, step, ridge, groove;
  for (int i = 0; i < 20'000; ++i) ball.emplace_back(place(random), place(random), place(random));
  for (int i = 0; i < across * across; ++i) {
    const float x = place(random) - 0.5f * across, y = place(random);
    step.emplace_back(x, y, x > 0 ? 2 : 0);
    ridge.emplace_back(x, y, -std::abs(x));
    groove.emplace_back(0.26f * x, y, 0.97f * std::abs(x));  // of 30 degrees
  }
  for (int i = 0; i < 2 * across; ++i) step.emplace_back(0, place(random), place(random) * 2 / across);
  std::vector<vec3> lines;  // of a scanner, eight spacings apart
  for (int line = 0; line < 2; ++line)
    for (int i = 0; i < 2000; ++i) lines.emplace_back(i + 0.3f * place(random) / across, 8 * line, 0);
  std::normal_distribution<float> gauss(0, 1);
  std::vector<vec3> steps;  // of a file's numbers
  for (int i = 0; i < across * across; ++i)
    steps.emplace_back(place(random), place(random), 0.1f * std::round(0.5f + 0.3f * gauss(random)));
  sheets("a plane in steps of its numbers", steps);
  sheets("two lines", lines);
  sheets("a ball", ball);
  sheets("a step", step);
  sheets("a ridge", ridge);
  sheets("a groove", groove);
}

// Depth cameras measure in steps, between which noise chooses: a picture shows one side of all.
TEST(Sides, StepsOfADepthPictureAreNoSheet) {
  std::mt19937 random(23);
  std::normal_distribution<float> gauss(0, 1);
  constexpr float step = 0.002f;  // a spacing
  std::vector<vec3> points;
  for (int i = -80; i <= 80; ++i)
    for (int j = -80; j <= 80; ++j) {
      const vec3 ray(0.002f * float(i), 0.002f * float(j), 1);
      const float depth = 1 + 0.02f * glm::dot(ray, ray) + 0.3f * step * gauss(random);
      points.push_back(ray * step * std::round(depth / step));
    }
  const auto sheets = [&](const dvec3& sensor) {
    PointCloud cloud = cloud_of(points);
    cloud.origin = sensor;
    int found = 0;
    for (const int side : marked_sides(cloud)) found += side != 0;
    return found;
  };
  EXPECT_EQ(sheets(dvec3(0)), 0);
  EXPECT_GT(sheets(dvec3(0, 0, -1)), 100) << "what nobody knows to be a picture";
}

TEST(Sides, StripsOfASurveyAreNoSheet) {
  PointCloud cloud = cloud_of(plate(1, 0.1f));
  cloud.las.emplace();
  for (const int side : marked_sides(cloud)) ASSERT_EQ(side, 0);
}

TEST(Sides, NeighborsAreThoseOfThePointsOwn) {
  const std::vector<vec3> points = plate(1, 0.1f);
  const PreparedCloud prepared = prepare(cloud_of(points), {}, {});
  const NeighborTree tree(prepared.cloud.positions);
  const Sides sides(tree, nobody_knows, no_progress());
  ASSERT_FALSE(sides.empty());
  const auto upper = [&](std::uint32_t i) { return prepared.cloud.source_index[i] < points.size() / 2; };
  std::atomic<std::size_t> wrong = 0, all = 0;
  for_each_neighborhood(tree, 72, [&](std::uint32_t i, auto ids, auto distances2) {
    Sides::Own own;
    if (i % 7 != 0 || !sides.find(i, ids, distances2, 24, own)) return;
    ASSERT_EQ(own.ids.size(), 24u);
    for (std::size_t k = 0; k < own.ids.size(); ++k) {
      wrong += upper(own.ids[k]) != upper(i);
      EXPECT_LE(own.distances2[k], own.distances2.back());
    }
    all += own.ids.size();
  });
  EXPECT_GT(all.load(), 2'000u);
  // Half a gap is 3.5 deviations of a difference: one in 2000.
  EXPECT_LT(wrong.load(), all.load() / 1000);
}

// Noise hides which of the layers lies outside, but elsewhere in the file normals face outward.
TEST(Sides, NormalsOfAWedgeTellDownToItsEdge) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> place(0, across);
  std::normal_distribution<float> off(0, 0.1f);
  PointCloud cloud;
  for (const int side : {1, -1})
    for (int i = 0; i < across * across; ++i) {
      const float x = place(random), y = place(random);
      cloud.positions.emplace_back(x, y, float(side) * 0.5f * x / across + off(random));
      cloud.normals.emplace_back(0, 0, side);
    }
  const auto [right, wrong] = right_and_wrong(marked_sides(cloud));
  EXPECT_GT(right, 0.97);
  EXPECT_EQ(wrong, 0);
  std::bernoulli_distribution flip(0.5);
  for (vec3& normal : cloud.normals)
    if (flip(random)) normal = -normal;
  for (const int side : marked_sides(cloud)) ASSERT_EQ(side, 0) << "normals of either sign tell nothing";
}
