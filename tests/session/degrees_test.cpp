// Points in degrees are drawn in metres: distances are those of the ellipsoid, and a file whose steps leave
// no plan says so.
#include "scene/degrees.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

using namespace sfumato;

namespace {

/// Some hundred metres at 48.005 N 11.005 E, on steps of so many degrees.
PointCloud in_degrees(double step) {
  PointCloud cloud;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> offset(-0.005, 0.005), height(300, 320);
  const auto rounded = [&](double degrees) { return std::round(degrees / step) * step; };
  cloud.origin = {11, 48, 0};
  for (int i = 0; i < 10'000; ++i)
    cloud.positions.push_back(
        vec3(dvec3(rounded(11.005 + offset(random)), rounded(48.005 + offset(random)), height(random)) -
             cloud.origin));
  cloud.crs = "EPSG:4326";
  cloud.las.emplace().scale = {step, step, 0.01};
  return cloud;
}

/// On the ellipsoid of WGS 84, by places around the centre of the Earth.
dvec3 place(double longitude, double latitude) {
  constexpr double a = 6378137, f = 1 / 298.257223563, e2 = f * (2 - f),
                   degree = 3.14159265358979323846 / 180;
  const double n = a / std::sqrt(1 - e2 * std::pow(std::sin(latitude * degree), 2));
  return {n * std::cos(latitude * degree) * std::cos(longitude * degree),
          n * std::cos(latitude * degree) * std::sin(longitude * degree),
          n * (1 - e2) * std::sin(latitude * degree)};
}

TEST(Degrees, DistancesAreThoseOfTheEllipsoid) {
  PointCloud cloud = in_degrees(1e-7);
  const auto metres = scene::local_metres_of(cloud);
  ASSERT_TRUE(metres);
  const auto degrees_at = [&](std::size_t i) { return cloud.origin + dvec3(cloud.positions[i]); };
  const dvec3 a = degrees_at(0), b = degrees_at(1);
  metres->apply(cloud);
  const double drawn = glm::length(glm::dvec2(cloud.positions[1] - cloud.positions[0]));
  const double real = glm::length(place(a.x, a.y) - place(b.x, b.y));
  // One scale for all of it: off by what the parallels shrink over half of its 1.1 km.
  EXPECT_NEAR(drawn, real, 2e-4 * real);
}

TEST(Degrees, LongitudesMayGoOnTo360) {
  PointCloud west = in_degrees(1e-7), on = west, unknown;
  west.origin.x = -59, on.origin.x = 301;
  unknown = on, unknown.crs.clear();
  const auto a = scene::local_metres_of(west), b = scene::local_metres_of(on);
  ASSERT_TRUE(a && b);
  a->apply(west), b->apply(on);
  for (std::size_t i = 0; i < 100; ++i)
    EXPECT_LT(glm::distance(west.positions[i], on.positions[i]), 1e-3) << "m, of some 1000";
  EXPECT_FALSE(scene::local_metres_of(unknown)) << "only where they are said to be degrees";
}

TEST(Degrees, PlacesFromTheCentreOfTheEarthAreNone) {
  // What some writers of LAS call EPSG:4326.
  PointCloud cloud;
  cloud.origin = place(-120, 38);
  const dvec3 east(std::sin(2 * M_PI / 3), -0.5, 0);
  for (int i = 0; i < 100; ++i) cloud.positions.push_back(vec3(double(i) * east));
  cloud.crs = "EPSG:4326";
  const auto metres = scene::local_metres_of(cloud);
  ASSERT_TRUE(metres);
  EXPECT_TRUE(metres->geocentric);
  EXPECT_NE(metres->note(cloud).find("by their values, which are no degrees"), std::string::npos);
  metres->apply(cloud);
  const dvec3 way = dvec3(cloud.positions[99] - cloud.positions[0]);
  EXPECT_NEAR(way.x, 99, 1e-2);
  EXPECT_NEAR(way.z, 0, 1e-2);
}

TEST(Degrees, WhereStepsLeaveNoPlanTheNoteSaysSo) {
  const auto note = [](double step) {
    const PointCloud cloud = in_degrees(step);
    return scene::local_metres_of(cloud)->note(cloud);
  };
  EXPECT_EQ(note(1e-7).find("steps"), std::string::npos) << note(1e-7);
  // 0.01 degrees of a meridian at 48 N: 1112 m.
  EXPECT_NE(note(0.01).find("steps of 0.01 degrees, 1112 m, which leave 2 x 2 places"), std::string::npos)
      << note(0.01);
}

}  // namespace
