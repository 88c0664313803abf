// What is cut open as a room, and what is not.
#include "analysis/find_room.h"

#include <gtest/gtest.h>

#include <random>

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
  EXPECT_GE(room->outside.size(), 2u) << "and walls";
  const Cut all{room->outside, room->ceiling};
  EXPECT_FALSE(is_cut(all, {3, 2, 1}));
  EXPECT_TRUE(is_cut(all, {3, 2, 2.7}));
}

// Normals tell whether a ceiling was seen from below or is the lid of a closed body.
TEST(FindRoom, ACeilingThatFacesUpIsNone) {
  PointCloud room = closed_room({6.4f, 4.8f, 2.7f}, 0);
  for (const vec3& p : room.positions) room.normals.push_back({0, 0, p.z > 2.6f ? -1 : 1});
  EXPECT_TRUE(find_room(room));
  for (std::size_t i = 0; i < room.size(); ++i)
    if (i % 4 != 0) room.normals[i] = {0, 0, 1};
  EXPECT_FALSE(find_room(room));
  for (std::size_t i = 0; i < room.size(); ++i)
    if (i % 3 != 0) room.normals[i] = vec3(0);  // of most nobody knows
  EXPECT_TRUE(find_room(room));
}

/// Level and plumb rectangles with noise, as a map of SLAM has them.
class Map {
 public:
  explicit Map(double noise = 0.03, double per_area = 150) : noise_(noise), per_area_(per_area) {}

  void face(const dvec3& corner, const dvec3& u, const dvec3& v) {
    for (int i = 0; i < per_area_ * glm::length(u) * glm::length(v); ++i)
      cloud.positions.push_back(vec3(corner + unit_(random_) * u + unit_(random_) * v +
                                     noise_ * dvec3(normal_(random_), normal_(random_), normal_(random_))));
  }
  void walls(const dvec3& low, const dvec3& high) {
    const dvec3 s = high - low, up(0, 0, s.z);
    face(low, {s.x, 0, 0}, up), face(low, {0, s.y, 0}, up);
    face({high.x, high.y, low.z}, {-s.x, 0, 0}, up), face({high.x, high.y, low.z}, {0, -s.y, 0}, up);
  }
  void level(const dvec3& low, const dvec3& high, double z) {
    face({low.x, low.y, z}, {high.x - low.x, 0, 0}, {0, high.y - low.y, 0});
  }
  void thing(const dvec3& low, const dvec3& high) { walls(low, high), level(low, high, high.z); }
  void table(double x, double y) { thing({x, y, 0}, {x + 1.4, y + 0.8, 0.75}); }
  void room(const dvec3& low, const dvec3& high) {
    walls(low, high), level(low, high, low.z), level(low, high, high.z);
  }

  PointCloud cloud;

 private:
  double noise_, per_area_;
  std::mt19937 random_{7};
  std::uniform_real_distribution<double> unit_{0, 1};
  std::normal_distribution<double> normal_{0, 1};
};

/// Two rooms of 2.5 and 4 m beside each other, with tables, and a hall of 3 m behind both.
Map three_rooms() {
  Map map;
  map.room({0, 0, 0}, {6, 5, 2.5}), map.room({6, 0, 0}, {14, 5, 4}), map.room({0, 5, 0}, {14, 14, 3});
  for (const auto& [x, y] :
       {std::pair(2.0, 2.0), {8.5, 1.5}, {11.0, 3.0}, {2.0, 8.0}, {6.0, 9.0}, {10.0, 11.0}})
    map.table(x, y);
  return map;
}

TEST(FindRoom, EachRoomOfAMapLosesItsOwnCeiling) {
  for (const double lean : {0.0, 0.03})     // a drifting map; 2 degrees
    for (const double hole : {0.0, 2.0}) {  // nothing was measured of a part of each ceiling
      Map map = three_rooms();
      const auto ceiling_at = [](const vec3& p) { return p.y > 5 ? 3.f : p.x < 6 ? 2.5f : 4.f; };
      std::erase_if(map.cloud.positions, [&](const vec3& p) {
        return p.z > 2 && std::abs(p.z - ceiling_at(p)) < 0.2 && std::fmod(p.x + 9, 6) < hole;
      });
      PointCloud leaning = map.cloud;
      for (vec3& p : leaning.positions) p.z += float(lean) * p.x;
      const std::optional<Room> room = find_room(leaning);
      ASSERT_TRUE(room && room->ceiling) << lean << ", " << hole;
      int ceiling = 0, kept = 0, low = 0, lost = 0;
      for (std::size_t i = 0; i < leaning.size(); ++i) {
        const vec3& p = map.cloud.positions[i];
        const bool is_left_out = room->ceiling->is_below(leaning.world(i));
        if (std::abs(p.z - ceiling_at(p)) < 0.06 && std::fmod(p.x, 6) > 0.5 && std::fmod(p.y, 5) > 0.5)
          ++ceiling, kept += !is_left_out;
        if (p.z < 1.8) ++low, lost += is_left_out;
      }
      EXPECT_LT(kept, 0.02 * ceiling) << lean << ", " << hole;
      EXPECT_EQ(lost, 0) << "of " << low << ": the floor, the tables and most of the walls; " << lean << ", "
                         << hole;
    }
}

// A floor of offices, 53 m long: of columns a metre wide most hold a wall.
TEST(FindRoom, ManySmallRoomsLoseTheirCeilings) {
  for (const double per_area : {40.0, 90.0}) {
    Map map(0.01, per_area);
    constexpr double wide = 3.5, high = 2.7;
    for (int x = 0; x < 15; ++x)
      for (int y = 0; y < 3; ++y) {
        map.room({x * wide, y * wide, 0}, {(x + 1) * wide, (y + 1) * wide, high});
        map.table(x * wide + 1, y * wide + 1);
      }
    const std::optional<Room> room = find_room(map.cloud);
    ASSERT_TRUE(room && room->ceiling) << per_area;
    int ceiling = 0, kept = 0, low = 0, lost = 0;
    for (std::size_t i = 0; i < map.cloud.size(); ++i) {
      const vec3& p = map.cloud.positions[i];
      const bool is_left_out = room->ceiling->is_below(map.cloud.world(i));
      if (p.z > high - 0.05) ++ceiling, kept += !is_left_out;
      if (p.z < 2) ++low, lost += is_left_out;
    }
    EXPECT_LT(kept, 0.02 * ceiling) << per_area;
    EXPECT_EQ(lost, 0) << per_area << ", of " << low;
  }
}

// A room whose two sides of glass a scanner did not see, and part of a third: its level floor makes up for
// them.
TEST(FindRoom, AFloorMakesUpForOpenSides) {
  const auto room_of = [](double open) {
    Map map;
    map.room({0, 0, 0}, {10, 6, 2.6});
    map.table(3, 2), map.table(6, 3.5);
    std::erase_if(map.cloud.positions, [&](const vec3& p) {
      const bool is_open = p.x > 9.8f || p.y > 5.8f || (p.x < 0.2f && double(p.y) < open);
      return is_open && p.z > 0.2f && p.z < 2.4f;
    });
    return map.cloud;
  };
  EXPECT_TRUE(find_room(room_of(1)));
  EXPECT_FALSE(find_room(room_of(6)));  // one wall of four
}

TEST(FindRoom, CeilingsGoOnWhereNothingWasMeasuredBelow) {
  Map map = three_rooms();  // of the hall no floor, but a ceiling, and a raised floor beside the lowest room
  std::erase_if(map.cloud.positions, [](const vec3& p) { return p.y > 9 && p.x > 5 && p.z < 2.5; });
  map.level({-6, 0, 0}, {-0.5, 5, 0}, 2.5), map.level({-6, 0, 0}, {-0.5, 5, 0}, 5);
  const std::optional<Room> room = find_room(map.cloud);
  ASSERT_TRUE(room && room->ceiling);
  for (double x = 6; x < 13; x += 0.7)
    for (double y = 9.5; y < 13.5; y += 0.7)
      EXPECT_TRUE(room->ceiling->is_below({x, y, 3})) << x << ", " << y;
  for (double x = -5; x < -1; x += 0.7) EXPECT_FALSE(room->ceiling->is_below({x, 2, 2.5})) << x;
}

TEST(FindRoom, AHallWithColumnsIsOne) {
  Map map(0.03, 60);
  map.room({0, 0, 0}, {30, 20, 4});
  for (int x = 6; x < 30; x += 6)
    for (int y = 5; y < 20; y += 5) map.walls({x, y, 0}, {x + 0.5, y + 0.5, 4});
  for (int x = 2; x < 28; x += 4) map.table(x, 8);
  EXPECT_TRUE(find_room(map.cloud));
}

TEST(FindRoom, WhatHasACoverIsNoRoom) {
  Map box(0.002, 2000), shelf(0.005, 20'000), bridge(0.03, 30), facade(0.02, 100), base(0.003, 6000);
  box.room({0, 0, 0}, {2, 3, 0.8});
  EXPECT_FALSE(find_room(box.cloud)) << "a closed box";

  shelf.level({0, 0, 0}, {1.6, 0.8, 0}, 0.7), shelf.level({0.1, 0.1, 0}, {1.5, 0.7, 0}, 1.1);
  for (const double x : {0.2, 0.7, 1.2}) shelf.thing({x, 0.3, 0.7}, {x + 0.2, 0.5, 0.85});
  EXPECT_FALSE(find_room(shelf.cloud)) << "a table with a shelf above it";

  bridge.level({0, 0, 0}, {60, 40, 0}, 0), bridge.level({0, 10, 0}, {60, 30, 0}, 8);
  for (int x = 10; x < 60; x += 20) bridge.walls({x, 18, 0}, {x + 2, 22, 8});
  for (int x = 3; x < 60; x += 12) bridge.thing({x, 12, 0}, {x + 6, 15, 3});
  EXPECT_FALSE(find_room(bridge.cloud)) << "a wide bridge";

  facade.face({0, 0, 0}, {30, 0, 0}, {0, 0, 12}), facade.level({0, -10, 0}, {30, 0, 0}, 0);
  for (double z = 3; z < 12; z += 3)
    facade.level({0, 0, 0}, {30, 1.5, 0}, z), facade.level({0, 0, 0}, {30, 1.5, 0}, z - 0.3);
  EXPECT_FALSE(find_room(facade.cloud)) << "a house seen through its windows";

  base.walls({0, 0, 0}, {1, 1, 0.4}), base.level({0, 0, 0}, {1, 1, 0}, 0.4),
      base.level({-1, -1, 0}, {2, 2, 0}, 0);
  base.walls({0.3, 0.3, 0.4}, {0.7, 0.7, 2}), base.level({0.3, 0.3, 0}, {0.7, 0.7, 0}, 2);
  EXPECT_FALSE(find_room(base.cloud)) << "a statue on its base";
}

TEST(FindRoom, CrownsAboveGroundAreNoCeiling) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const double thick : {0.1, 0.2, 0.4})
    for (const double walled : {0.0, 1.0}) {  // beside a wall of trees, as at a forest's edge
      PointCloud forest;
      for (int i = 0; i < 150'000; ++i) {
        const double x = 80 * unit(random), y = 80 * unit(random), which = unit(random);
        // Each crown, of 6 m, has a height of its own.
        const double crown = 18 + 4 * std::sin(1.7 * std::floor(x / 6) + 2.3 * std::floor(y / 6));
        const bool is_edge = walled > 0 && (x < 2 || y < 2 || x > 78 || y > 78);
        forest.positions.push_back(vec3(x, y,
                                        is_edge        ? crown * unit(random)
                                        : which < 0.6  ? crown * (1 - thick * unit(random))
                                        : which < 0.65 ? 3 * unit(random)
                                                       : 0.2 * unit(random)));
      }
      EXPECT_FALSE(find_room(forest)) << thick << ", " << walled;
    }
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

// Whoever stands below a hole in the ceiling stands in the room; whoever looks through it does not.
TEST(FindRoom, NothingIsLeftOutBelowAHoleInTheCeiling) {
  Room room;
  Ceiling& ceiling = room.ceiling.emplace();
  ceiling.up = {0, 0, 1}, ceiling.u = {1, 0, 0, 0}, ceiling.v = {0, 1, 0, 0}, ceiling.across = 3;
  ceiling.heights.assign(9, 2.5);
  ceiling.heights[4] = std::numeric_limits<double>::infinity();
  Camera camera;
  camera.target = {0.5, 1.5, 0.2}, camera.up = {0, 0, 1};
  for (const dvec3& inside : {dvec3(1.5, 1.5, 1.6), dvec3(2.5, 1.5, 1.6)}) {
    camera.position = inside;
    EXPECT_TRUE(cut_before(room, camera).empty()) << inside.x;
  }
  for (const dvec3& outside : {dvec3(1.5, 1.5, 3), dvec3(2.5, 1.5, 3), dvec3(6, 1.5, 1.6)}) {
    camera.position = outside;
    EXPECT_FALSE(cut_before(room, camera).empty()) << outside.x;
  }
}

TEST(FindRoom, ABodyWhoseBackBendsIsNone) {
  EXPECT_TRUE(find_room(body(0))) << "a round room";
  for (const double bent : {0.3, 0.5, 0.7, 0.9}) EXPECT_FALSE(find_room(body(bent))) << bent;
}

TEST(FindRoom, ABodyWithoutALevelFloorIsNone) {
  for (const double bent : {0.3, 0.5}) {
    PointCloud bowl = body(bent);  // turned over, a bowl with a lid
    for (vec3& p : bowl.positions) p.z = 1 - p.z;
    EXPECT_FALSE(find_room(bowl)) << bent;
  }
}

}  // namespace
