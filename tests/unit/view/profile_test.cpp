// Profiles and histograms of clouds whose answers are known.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "view/histogram.h"
#include "view/profile.h"

namespace sfumato::view {
namespace {

using ::testing::ElementsAre;
using ::testing::StartsWith;

/// x and y from 0 to 10, a unit apart; heights 100 + x.
PointCloud plane() {
  PointCloud cloud;
  cloud.origin = {500'000, 4'000'000, 100};
  for (int x = 0; x <= 10; ++x)
    for (int y = 0; y <= 10; ++y) cloud.positions.push_back({float(x), float(y), float(x)});
  return cloud;
}

Profile profile_along(const PointCloud& cloud, std::vector<dvec3> line, double width) {
  Profile profile;
  for (dvec3& place : line) place += cloud.origin;
  profile.line = std::move(line);
  profile.width = width;
  add_to_profile(profile, cloud, {}, UpAxis::pos_z, [](std::size_t i) { return 1000 + i; });
  return profile;
}

TEST(Profile, HoldsThePointsOfItsCorridor) {
  const PointCloud cloud = plane();
  // From x = 2 to x = 8 at y = 5, reaching one unit to each side: three rows of seven.
  const Profile profile = profile_along(cloud, {{2, 5, 0}, {8, 5, 50}}, 2.1);
  EXPECT_DOUBLE_EQ(profile.length, 6);  // heights of picked points do not count
  ASSERT_EQ(profile.points.size(), 21u);
  for (const ProfilePoint& each : profile.points) {
    EXPECT_DOUBLE_EQ(each.height, 100 + (each.world.x - cloud.origin.x));
    EXPECT_NEAR(each.along, each.world.x - cloud.origin.x - 2, 1e-9);
    EXPECT_EQ(cloud.world(each.source - 1000), each.world);
  }
}

TEST(Profile, FollowsCornersAndCountsEachPointOnce) {
  const PointCloud cloud = plane();
  const Profile profile = profile_along(cloud, {{0, 5, 0}, {5, 5, 0}, {5, 10, 0}}, 0.5);
  EXPECT_DOUBLE_EQ(profile.length, 10);
  ASSERT_EQ(profile.points.size(), 11u);
  for (const ProfilePoint& each : profile.points) {
    const dvec3 local = each.world - cloud.origin;
    EXPECT_NEAR(each.along, local.x + (local.y - 5), 1e-9);
  }
  // A line straight up has no length, and nothing along it.
  EXPECT_TRUE(profile_along(cloud, {{5, 5, 0}, {5, 5, 9}}, 3).points.empty());
}

TEST(Profile, TurnsWithTheUpAxis) {
  PointCloud cloud;
  cloud.positions = {{1, 7, 0}, {1, 8, 3}};
  Profile profile;
  profile.line = {{0, 0, 0}, {4, 0, 0}};
  profile.width = 1;
  add_to_profile(profile, cloud, {}, UpAxis::neg_y, [](std::size_t i) { return i; });
  ASSERT_EQ(profile.points.size(), 1u);
  EXPECT_DOUBLE_EQ(profile.points[0].height, -7);
}

TEST(Profile, IsWrittenAsATable) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("profile_" + std::to_string(getpid()) + ".csv");
  write_profile(file, profile_along(plane(), {{2, 5, 0}, {3, 5, 0}}, 0.5), 15);
  std::ifstream in(file);
  std::string header, first, second, third;
  std::getline(in, header), std::getline(in, first), std::getline(in, second);
  EXPECT_EQ(header, "distance,height,x,y,z,point");
  EXPECT_THAT(first, StartsWith("0.0000,102.0000,500002.0000,4000005.0000,102.0000,1027"));
  EXPECT_FALSE(std::getline(in, third));
  std::filesystem::remove(file);
}

TEST(Histogram, CountsFiniteValues) {
  PointCloud cloud;
  for (int i = 0; i < 5; ++i) cloud.positions.push_back({0, 0, float(i)});
  cloud.set_scalar({"intensity", 0, {10, 10, 20, NAN, 30}, StoredType::float32});
  const Histogram histogram = histogram_of(cloud, "intensity", 2);
  EXPECT_EQ(histogram.low, 10);
  EXPECT_EQ(histogram.high, 30);
  EXPECT_THAT(histogram.counts, ElementsAre(2, 2));
  EXPECT_TRUE(histogram_of(cloud, "nothing", 2).counts.empty());
  EXPECT_THAT(histogram_of(cloud, "x", 3).counts, ElementsAre(5, 0, 0));  // all alike
}

}  // namespace
}  // namespace sfumato::view
