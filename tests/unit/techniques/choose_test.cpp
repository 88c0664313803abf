// What is chosen without being asked: the technique for each kind of scan.
#include "techniques/choose.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "analysis/prepare.h"
#include "analysis/survey.h"
#include "scans.h"

using namespace sfumato;
using namespace sfumato::analysis;

namespace {

TechniqueChoice choice_for(PointCloud cloud, bool by_levels = false) {
  const SortedCloud sorted = sort_cloud(std::move(cloud), {});
  return choose_technique(sorted.cloud, sorted.tree.get(), by_levels);
}

/// A tube of 3 m radius and a level floor, in profiles `gap` apart as of a scanner that moves along it;
/// points 2 cm apart along each. `speeds`: so many times as far apart at the end as at the start.
PointCloud profiles(double gap, double speeds = 1) {
  constexpr int count = 150, around = 900;
  std::mt19937 random(31);
  std::normal_distribution<double> noise(0, 0.002);
  PointCloud cloud;
  double x = 0;
  for (int profile = 0; profile < count; ++profile) {
    x += gap * (1 + (speeds - 1) * profile / count);
    for (int step = 0; step < around; ++step) {
      const double angle = 2 * M_PI * step / around;
      const double r = std::min(3.0, std::sin(angle) < 0 ? -1.7 / std::sin(angle) : 9.0) + noise(random);
      cloud.positions.push_back(vec3(x, r * std::cos(angle), r * std::sin(angle)));
    }
  }
  return cloud;
}

PointCloud every(int n, PointCloud cloud) {
  std::vector<vec3> kept;
  for (std::size_t i = 0; i < cloud.size(); i += std::size_t(n)) kept.push_back(cloud.positions[i]);
  cloud.positions = std::move(kept);
  return cloud;
}

/// Cylinders of a mesh have vertices on their rims only.
PointCloud rims() {
  std::mt19937 random(9);
  std::uniform_real_distribution<float> unit(0, 1);
  PointCloud cloud;
  for (int cylinder = 0; cylinder < 40; ++cylinder) {
    const vec3 foot(4 * unit(random), 2 * unit(random), 2 * unit(random));
    const float radius = 0.1f + 0.3f * unit(random), height = 0.2f + unit(random);
    for (int k = 0; k < 48; ++k)
      for (float z : {0.0f, height}) {
        const float angle = 6.2832f * float(k) / 48;
        cloud.positions.push_back(foot + vec3(radius * std::cos(angle), radius * std::sin(angle), z));
      }
  }
  return cloud;
}

/// A sphere with noise of so many spacings.
PointCloud noisy_sphere(float spacings) {
  std::mt19937 random(5);
  std::normal_distribution<float> normal(0, 1);
  PointCloud cloud;
  const int count = 10'000;
  const float spacing = std::sqrt(4 * float(M_PI) / count);
  for (int i = 0; i < count; ++i) {
    const vec3 out = glm::normalize(vec3(normal(random), normal(random), normal(random)));
    cloud.positions.push_back(out * (1 + spacings * spacing * normal(random)));
  }
  return cloud;
}

TEST(Choose, EveryKindOfScanHasItsTechnique) {
  struct Case {
    const char* kind;
    PointCloud cloud;
    const char* technique;
    const char* reason;
  };
  const std::vector<Case> cases = {
      {"object", scan("spheres", synth::Sampling::area, 60'000), "splats", "surfaces"},
      {"place", scan("courtyard", synth::Sampling::scanners, 200'000), "splats", "surfaces"},
      {"room", scan("room", synth::Sampling::area, 100'000), "splats", "surfaces"},
      {"forest from the air", scan("forest", synth::Sampling::airborne, 100'000), "splats", "scattered"},
      {"depth pictures", scan("room", synth::Sampling::cameras, 100'000), "splats", "surfaces"},
      {"street sweep", street_sweep(), "points", "lines"},
      {"street sweep of 16 rings", street_sweep(16), "points", "lines"},
      {"street sweep of 64 rings", street_sweep(64), "points", "lines"},
      {"profiles along a tunnel", profiles(0.1), "splats", "surfaces"},
      {"profiles of 1.6 times the speed", profiles(0.1, 1.6), "splats", "surfaces"},
      {"profiles far apart", profiles(0.5), "points", "lines"},
      {"vertices of a machine's mesh", rims(), "points", "lines"},
      {"sparse sweep", every(10, street_sweep()), "splats", "scattered"},
      {"sparse object", scan("spheres", synth::Sampling::area, 6'000), "splats", "surfaces"},
      {"noise of half a spacing", noisy_sphere(0.6f), "splats", "surfaces"},
      {"noise of three spacings", noisy_sphere(3), "points", "scattered"},
      {"a few points", scan("spheres", synth::Sampling::area, 500), "points", "500"},
  };
  for (const Case& one : cases) {
    PointCloud twice = one.cloud;  // merged from overlapping files
    append(twice, one.cloud);
    EXPECT_EQ(choice_for(twice).technique, one.technique) << one.kind << ", every point twice";
    const TechniqueChoice choice = choice_for(one.cloud);
    EXPECT_EQ(choice.technique, one.technique) << one.kind << ": " << choice.reason;
    EXPECT_NE(choice.reason.find(one.reason), std::string::npos) << one.kind << ": " << choice.reason;
  }
}

/// Leaves at any height, of 300 m a side; of little height, a field.
PointCloud wood(int points, double height) {
  std::mt19937 random(23);
  std::uniform_real_distribution<double> unit(0, 1);
  PointCloud cloud;
  for (int i = 0; i < points; ++i) {
    const double x = 300 * unit(random), y = 300 * unit(random);
    cloud.positions.push_back(vec3(x, y, height * unit(random)));
  }
  return cloud;
}

// Seen from far enough a forest is flat: discs as wide as the spacing show that no better than a few points.
TEST(Choose, AForestIsNoSurfaceHoweverFewItsPointsAre) {
  for (const int points : {3000, 5000, 12'000, 16'000, 60'000}) {
    const TechniqueChoice forest = choice_for(wood(points, 25));
    EXPECT_LT(forest.surface_share, 0.6f) << points;
    EXPECT_EQ(choice_for(wood(points, 0.1)).technique, "splats") << points;
  }
}

// Of a far wall as noisy as its pixels are wide neighbours in space see no surface, those in the picture do:
// in whatever order the file has them, and with the grid in it or not.
TEST(Choose, NoisyDepthPicturesAreSurfaces) {
  constexpr int width = 160, height = 120;
  std::mt19937 random(3);
  std::normal_distribution<float> noise(0, 1);
  PointCloud cloud;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float depth = x < width / 4 ? 0.8f : 4;
      const vec3 ray((float(x) + 0.5f - width / 2) / 140, (float(y) + 0.5f - height / 2) / 140, 1);
      cloud.positions.push_back((depth + 0.003f * depth * depth * noise(random)) * ray);
    }
  const SortedCloud in_space = sort_cloud(
      [&] {
        PointCloud moved = cloud;  // the origin is no sensor any more
        for (vec3& p : moved.positions) p += vec3(3, 9, 40);
        return moved;
      }(),
      {});
  EXPECT_LT(choose_technique(in_space.cloud, in_space.tree.get()).surface_share, 0.75f);
  std::shuffle(cloud.positions.begin(), cloud.positions.end(), random);
  const TechniqueChoice choice = choice_for(cloud);
  EXPECT_EQ(choice.technique, "splats");
  EXPECT_GT(choice.surface_share, 0.9f);
}

// 2048 places with 22 ratios of distances each: a deviation of .01 where they are apart. Ends and sides,
// where a ball is cut, make it a little less.
TEST(Choose, TheDimensionIsThatOfWhatPointsLieOn) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> unit(0, 1);
  const auto at = [&](auto place) {
    PointCloud cloud;
    for (int i = 0; i < 40'000; ++i)
      cloud.positions.push_back(place(unit(random), unit(random), unit(random)));
    const SortedCloud sorted = sort_cloud(std::move(cloud), {});
    return surface_share(*sorted.tree).dimension;
  };
  EXPECT_NEAR(at([](float x, float y, float) { return vec3(100 * x, std::floor(10 * y), 0); }), 1, 0.03);
  EXPECT_NEAR(at([](float x, float y, float) { return vec3(x, y, 0.3f * x); }), 2, 0.05);
  EXPECT_NEAR(at([](float x, float y, float z) { return vec3(x, y, z); }), 3, 0.15);
}

TEST(Choose, PointsOnFacesAreOnSurfacesAndNobodyMeasures) {
  PointCloud leaves = wood(16'000, 25);
  leaves.normals.assign(leaves.size(), vec3(0, 0, 1));
  leaves.radii.assign(leaves.size(), 0.1f);
  const TechniqueChoice choice = choice_for(leaves);
  EXPECT_EQ(choice.technique, "splats");
  EXPECT_EQ(choice.surface_share, 1);
}

TEST(Choose, IsMeasuredOnce) {
  const auto [prepared, tree] = sort_cloud(scan("courtyard", synth::Sampling::scanners, 20'000), {});
  EXPECT_FALSE(prepared.surface_share.is_made());
  const float share = choose_technique(prepared, tree.get()).surface_share;
  EXPECT_TRUE(prepared.surface_share.is_made());
  PreparedCloud other = prepared;  // a copy reads what is kept
  EXPECT_EQ(other.surface_share.get([] { return SurfaceShare(); }).surface, share);
  other.surface_share = {};
  other.surface_share.get([] { return SurfaceShare{0.8125f, 2}; });
  EXPECT_EQ(choose_technique(other, nullptr).surface_share, 0.8125f);
}

// Nobody should wait for the neighbours of tens of millions of points at every view.
TEST(Choose, WhatIsReadByLevelsIsNotMeasured) {
  EXPECT_EQ(choice_for(scan("courtyard", synth::Sampling::scanners, 200'000), true).technique, "surface");
  EXPECT_EQ(choice_for(scan("room", synth::Sampling::cameras, 100'000), true).technique, "surface");
  EXPECT_EQ(choice_for(scan("forest", synth::Sampling::airborne, 100'000), true).technique, "points");
}

TEST(Choose, IsTheSameForAnyOrderAndScale) {
  PointCloud cloud = scan("forest", synth::Sampling::airborne, 60'000);
  const TechniqueChoice choice = choice_for(cloud);
  std::reverse(cloud.positions.begin(), cloud.positions.end());
  for (vec3& p : cloud.positions) p *= 1e-3f;
  const TechniqueChoice small = choice_for(cloud);
  EXPECT_EQ(choice.technique, small.technique);
  EXPECT_NEAR(choice.surface_share, small.surface_share, 0.03);  // three deviations of 2048 places
}

}  // namespace

// Few points of a closed surface are drawn as one, as long as their neighbours say so.
TEST(Choose, FewPointsOfASurfaceAreOne) {
  const auto ball = [](int count, float thick) {
    std::mt19937 random(8);
    std::normal_distribution<float> normal;
    std::uniform_real_distribution<float> unit(0, 1);
    PointCloud cloud;
    for (int i = 0; i < count; ++i) {
      const vec3 way = glm::normalize(vec3(normal(random), normal(random), normal(random)));
      cloud.positions.push_back(way * (1 - thick * unit(random)));
    }
    return cloud;
  };
  EXPECT_EQ(choice_for(ball(1000, 0)).technique, "splats");
  EXPECT_EQ(choice_for(ball(600, 0)).technique, "splats");
  EXPECT_EQ(choice_for(ball(200, 0)).reason, "only 200 points");
  EXPECT_EQ(choice_for(ball(1000, 1)).reason, "only 1000 points");
}

// Points that share their places are not said to be fewer than they are.
TEST(Choose, FewPlacesAreNoFewPoints) {
  PointCloud cloud;
  for (int k = 0; k < 4000; ++k) {
    const int at = k % 1000;
    cloud.positions.push_back(vec3(at * 37 % 101, at * 53 % 97, at * 71 % 89));
  }
  EXPECT_EQ(choice_for(cloud).reason, "only 1000 places");
  cloud.positions.resize(1000);
  EXPECT_EQ(choice_for(std::move(cloud)).reason, "only 1000 points");
}
