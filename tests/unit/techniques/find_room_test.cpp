// What is cut open as a room, and what is not.
#include "analysis/find_room.h"

#include <gtest/gtest.h>

#include "scans.h"

using namespace sfumato;
using namespace sfumato::analysis;

namespace {

void turn(PointCloud& cloud, double degrees) {
  const glm::dmat3 by(glm::rotate(dmat4(1), glm::radians(degrees), dvec3(0, 0, 1)));
  for (vec3& p : cloud.positions) p = vec3(by * dvec3(p));
}

PointCloud thinned(const PointCloud& cloud, std::size_t nth) {
  PointCloud few;
  for (std::size_t i = 0; i < cloud.size(); i += nth) few.positions.push_back(cloud.positions[i]);
  return few;
}

TEST(FindRoom, RoomsHoweverTheyAreTurnedAndSampled) {
  for (const vec3& size : {vec3(6.4f, 4.8f, 2.7f), vec3(9, 7, 2.5f), vec3(5, 5, 3)})
    for (const double degrees : {0.0, 20.0, 45.0, 100.0})
      for (const std::size_t nth : {1, 4}) {
        PointCloud cloud = thinned(closed_room(size, 0), nth);
        turn(cloud, degrees);
        EXPECT_TRUE(find_room(cloud)) << size.x << " by " << size.y << ", " << degrees << ", 1 of " << nth;
      }
}

TEST(FindRoom, TheCeilingIsLeftOutAndWhatIsBelowItIsNot) {
  const std::optional<Room> room = find_room(closed_room({6.4f, 4.8f, 2.7f}, 0));
  ASSERT_TRUE(room);
  EXPECT_GE(room->outside.size(), 3u) << "and walls";
  EXPECT_FALSE(is_behind(room->outside, {3, 2, 1}));
  EXPECT_TRUE(is_behind(room->outside, {3, 2, 2.7}));
}

/// A body on level ground of its own, hollow, with a flap inside, as the ear of an animal: `bent` is how much
/// of its height its back falls towards the sides.
PointCloud body(double bent) {
  std::mt19937 random(51);
  std::uniform_real_distribution<double> unit(-1, 1);
  PointCloud cloud;
  for (int i = 0; i < 60'000; ++i) {
    const double x = unit(random), y = unit(random), r2 = x * x + y * y;
    if (r2 > 1) continue;
    const double top = 1 - bent * r2, side = std::sqrt(r2);
    const int part = i % 10;
    if (part < 4)
      cloud.positions.push_back(vec3(x, y, top));
    else if (part < 7)
      cloud.positions.push_back(vec3(x, y, 0));
    else if (part < 9)
      cloud.positions.push_back(vec3(x / side, y / side, (1 - bent) * std::abs(unit(random))));
    else
      cloud.positions.push_back(vec3(0.3 * x, 0.1 * y, 0.4));
  }
  return cloud;
}

TEST(FindRoom, ABodyWhoseBackBendsIsNone) {
  EXPECT_TRUE(find_room(body(0))) << "a round room";
  for (const double bent : {0.3, 0.5, 0.7, 0.9}) EXPECT_FALSE(find_room(body(bent))) << bent;
}

}  // namespace
