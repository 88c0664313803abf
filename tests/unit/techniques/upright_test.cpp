// The axis that is up, of every kind of scan in every orientation that formats have.
#include "analysis/upright.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "scans.h"

using namespace sfumato;
using namespace sfumato::analysis;

namespace {

void turn(PointCloud& cloud, const glm::dmat3& by) {
  for (vec3& p : cloud.positions) p = vec3(by * (cloud.origin + dvec3(p)));
  for (vec3& n : cloud.normals) n = vec3(by * dvec3(n));
  cloud.origin = dvec3(0);
  cloud.grids.clear(), cloud.scanners.clear();
}

PointCloud every(int n, PointCloud cloud) {
  std::vector<vec3> kept;
  for (std::size_t i = 0; i < cloud.size(); i += std::size_t(n)) kept.push_back(cloud.positions[i]);
  cloud.positions = std::move(kept);
  return cloud;
}

const glm::dmat3 y_up(1, 0, 0, 0, 0, -1, 0, 1, 0);  // columns: x stays, y goes to -z, z to y

TEST(Upright, RightForScenesAndPicturesOfThem) {
  int cases = 0, right = 0;
  std::string wrong;
  const auto expect = [&](const PointCloud& cloud, UpAxis up, const std::string& name) {
    const Upright guess = guess_upright(cloud);
    ++cases;
    right += guess.up == up;
    if (guess.up != up) wrong += name + " became " + to_string(guess.up) + " (" + guess.reason + "); ";
  };
  for (const char* name : {"courtyard", "room", "forest", "spheres", "plane"}) {
    PointCloud cloud = scan(name, synth::Sampling::automatic, 60'000);
    PointCloud turned = cloud;
    turn(turned, y_up);
    for (UpAxis custom : {UpAxis::pos_z, UpAxis::pos_y}) {
      cloud.up = turned.up = custom;
      expect(cloud, UpAxis::pos_z, std::string(name) + " on z");
      // Where Z is the convention, what is thin along y is a wall.
      if (std::string(name) != "forest" || custom == UpAxis::pos_y)
        expect(turned, UpAxis::pos_y, std::string(name) + " on y");
    }
  }
  // Pictures of depth cameras, as they see them: y down; and as renderers do: y up, looking along -z.
  for (const char* name : {"room", "courtyard"}) {
    const synth::Scene scene = synth::make_scene(name);
    std::vector<Camera> cameras = scene.cameras;
    if (scene.held_out) cameras.push_back(*scene.held_out);
    for (const Camera& camera : cameras) {
      // Of who looks up at a ceiling nothing tells that from a floor.
      if (camera.direction().z > 0.2) continue;
      PointCloud view = synth::sample_by_camera(scene, {camera.resized(320, 240)}, 2);
      const dmat4 eye = camera.view(view.origin);
      for (vec3& p : view.positions) p = vec3(eye * glm::dvec4(dvec3(p), 1));
      for (vec3& n : view.normals) n = vec3(glm::dmat3(eye) * dvec3(n));
      view.origin = dvec3(0);
      for (UpAxis custom : {UpAxis::pos_z, UpAxis::pos_y}) {
        view.up = custom;
        expect(view, UpAxis::pos_y, std::string(name) + " seen along -z");
      }
      turn(view, glm::dmat3(1, 0, 0, 0, -1, 0, 0, 0, -1));
      view.up = UpAxis::pos_z;
      expect(view, UpAxis::neg_y, std::string(name) + " seen along z");
    }
  }
  EXPECT_GE(cases, 20);
  EXPECT_EQ(right, cases) << right << " of " << cases << ": " << wrong;
  RecordProperty("right", std::to_string(right) + " of " + std::to_string(cases));
}

bool is_camera_view(const PointCloud& cloud) {
  return up_candidates(cloud)[0].evidence[std::size_t(UpEvidence::camera)] > 0.5;
}

TEST(Upright, MapCoordinatesAreNoCamerasView) {
  PointCloud tile = scan("forest", synth::Sampling::automatic, 60'000);
  turn(tile, y_up);
  tile.up = UpAxis::pos_y;
  for (const dvec3& place : {dvec3(636e3, 400, -849e3), dvec3(636e3, 400, 849e3)}) {
    tile.origin = place;
    const Upright guess = guess_upright(tile);
    EXPECT_EQ(guess.up, UpAxis::pos_y);
    EXPECT_FALSE(is_camera_view(tile)) << guess.reason;
  }
}

TEST(Upright, PylonsDoNotMakeLandStand) {
  std::mt19937 random(10);
  std::uniform_real_distribution<float> unit(0, 1);
  PointCloud cloud;
  cloud.up = UpAxis::pos_y;
  for (int i = 0; i < 100'000; ++i) {  // rolling ground, and for one in thirty a pylon or its lines
    const float x = 200 * unit(random), y = 60 * unit(random);
    const bool stands = i % 30 == 0;
    cloud.positions.push_back({x, stands ? 30 : y, stands ? 30 * unit(random) : 3 * std::sin(x / 30)});
  }
  EXPECT_EQ(guess_upright(cloud).up, UpAxis::pos_z);
}

/// Both sheets of a figure of ellipsoids: body, head, arms, legs; 1.8 high along y, 0.9 wide, 0.3 deep.
PointCloud figure() {
  struct Part {
    vec3 middle, half;
  };
  const Part parts[] = {{{0, 1.15f, 0}, {0.2f, 0.35f, 0.15f}},     {{0, 1.65f, 0}, {0.1f, 0.15f, 0.12f}},
                        {{-0.35f, 1.1f, 0}, {0.1f, 0.4f, 0.06f}},  {{0.35f, 1.1f, 0}, {0.1f, 0.4f, 0.06f}},
                        {{-0.12f, 0.45f, 0}, {0.1f, 0.45f, 0.1f}}, {{0.12f, 0.45f, 0}, {0.1f, 0.45f, 0.1f}}};
  std::mt19937 random(11);
  std::normal_distribution<float> normal;
  PointCloud cloud;
  cloud.up = UpAxis::pos_y;
  for (int i = 0; i < 60'000; ++i) {
    const Part& part = parts[i % 6];
    cloud.positions.push_back(
        part.middle + part.half * glm::normalize(vec3(normal(random), normal(random), normal(random))));
  }
  return cloud;
}

// What a depth camera saw of a figure, cut out, or several did, joined: without colours and the sides of an
// image only the place tells.
TEST(Upright, WhatIsAfarIsInTheAxesOfACamera) {
  PointCloud cloud = figure();
  for (vec3& p : cloud.positions) p = {p.x + 0.2f, 0.8f - p.y, p.z + 2.5f};
  for (UpAxis custom : {UpAxis::pos_z, UpAxis::neg_y}) {
    cloud.up = custom;
    EXPECT_EQ(guess_upright(cloud).up, UpAxis::neg_y) << to_string(custom);
  }
  const auto camera_of = [](const PointCloud& seen) {
    double most = 0;
    for (const UpCandidate& each : up_candidates(seen))
      most = std::max(most, each.evidence[std::size_t(UpEvidence::camera)]);
    return most;
  };
  EXPECT_GT(camera_of(cloud), 0.4);
  for (vec3& p : cloud.positions) p.z -= 2.3f;  // its back at the origin
  EXPECT_LT(camera_of(cloud), 0.1);
}

TEST(Upright, AFigureIsFlatButStands) {
  EXPECT_EQ(guess_upright(figure()).up, UpAxis::pos_y);
  // Its front alone, as land along y would be: one sheet.
  PointCloud land = figure();
  for (vec3& p : land.positions) p.z = std::abs(p.z);
  EXPECT_EQ(guess_upright(land).up, UpAxis::pos_z);
}

/// A house and a tower, z up, on ground that reaches farther.
PointCloud house() {
  std::mt19937 random(12);
  std::uniform_real_distribution<float> unit(0, 1);
  PointCloud cloud;
  for (int i = 0; i < 60'000; ++i) {
    const float a = unit(random), b = unit(random);
    const int side = i % 4;
    const vec3 foot = i % 3 == 1 ? vec3(0, 0, 0) : vec3(-5, 2, 0),
               size = i % 3 == 1 ? vec3(20, 10, 9) : vec3(5, 6, 22);
    if (i % 3 == 0)
      cloud.positions.push_back({-20 + 55 * a, -15 + 40 * b, 0});
    else if (side < 2)
      cloud.positions.push_back(foot + size * vec3(a, float(side), b));
    else
      cloud.positions.push_back(foot + size * vec3(float(side - 2), a, b));
  }
  return cloud;
}

TEST(Upright, GroundTellsHoweverItIsTilted) {
  for (double tilt : {0.0, 15.0, 30.0}) {
    const glm::dmat3 by(glm::rotate(dmat4(1), glm::radians(tilt), glm::normalize(dvec3(1, 0.3, 0))));
    PointCloud cloud = house();
    turn(cloud, by);
    cloud.up = UpAxis::pos_y;
    EXPECT_EQ(guess_upright(cloud).up, UpAxis::pos_z) << tilt;
    // As photographs are put together: y down.
    cloud = house();
    turn(cloud, glm::dmat3(1, 0, 0, 0, 0, 1, 0, -1, 0) * by);
    cloud.up = UpAxis::pos_y;
    EXPECT_EQ(guess_upright(cloud).up, UpAxis::neg_y) << tilt;
  }
}

// A statue without its ground stands along its length; what lies or is as wide as high has none.
TEST(Upright, AStatueInTheAxesOfACameraStandsUp) {
  std::mt19937 random(6);
  std::normal_distribution<double> normal;
  for (const double tilt : {0.0, 20.0, 33.0, 80.0})
    for (const double height : {0.55, 0.2}) {
      const glm::dmat3 by(glm::rotate(dmat4(1), glm::radians(tilt), glm::normalize(dvec3(1, 0, 0.3))));
      PointCloud cloud;
      for (int i = 0; i < 8000; ++i) {
        const double wide = i % 20 == 0 ? 0.6 : 0.15;  // and what stood around
        cloud.positions.push_back(
            vec3(by * dvec3(wide * normal(random), -height * normal(random), wide * normal(random))));
      }
      const dvec3 vertical = up_from_ground(cloud, UpAxis::neg_y);
      if (tilt > 45 || height < 0.3)
        EXPECT_EQ(vertical, dvec3(0)) << tilt << ", " << height;
      else
        EXPECT_GT(glm::dot(vertical, by * dvec3(0, -1, 0)), std::cos(glm::radians(5.0))) << tilt;
    }
}

// The axes of COLMAP are those of its first camera, which looked down; those of a survey are plumb, and a
// slope is one.
TEST(Upright, GroundIsLevelOnlyInTheAxesOfACamera) {
  const glm::dmat3 y_down(1, 0, 0, 0, 0, 1, 0, -1, 0);
  for (double tilt : {12.0, 30.0}) {
    const glm::dmat3 by(glm::rotate(dmat4(1), glm::radians(tilt), glm::normalize(dvec3(1, 0.3, 0))));
    PointCloud cloud = house();
    turn(cloud, y_down * by);
    cloud.up = UpAxis::neg_y;
    const Upright guess = guess_upright(cloud);
    EXPECT_EQ(guess.up, UpAxis::neg_y) << tilt;
    EXPECT_GT(glm::dot(guess.vertical, y_down * by * dvec3(0, 0, 1)), std::cos(glm::radians(3.0))) << tilt;
    cloud = house();
    turn(cloud, by);
    cloud.up = UpAxis::pos_z;
    EXPECT_EQ(guess_upright(cloud).vertical, dvec3(0)) << tilt;
  }
  // Most is no ground and lies every way.
  std::mt19937 random(48);
  std::normal_distribution<float> normal;
  PointCloud cloud;
  cloud.up = UpAxis::neg_y;
  for (int i = 0; i < 20'000; ++i)
    cloud.positions.push_back({normal(random), normal(random), normal(random)});
  EXPECT_EQ(guess_upright(cloud).vertical, dvec3(0));
}

/// A body that narrows upwards, with a head that leans forward, z up, scanned from all sides but below.
PointCloud statue() {
  std::mt19937 random(21);
  std::uniform_real_distribution<double> unit(0, 1);
  PointCloud cloud;
  for (int i = 0; i < 40'000; ++i) {
    const double angle = 2 * M_PI * unit(random), height = 1.6 * unit(random), radius = 0.5 - 0.22 * height;
    const double rise = std::acos(1 - 2 * unit(random));
    cloud.positions.push_back(i % 4 != 0 ? vec3(radius * std::cos(angle), radius * std::sin(angle), height)
                                         : vec3(0.3 * std::sin(rise) * std::cos(angle),
                                                0.25 + 0.3 * std::sin(rise) * std::sin(angle),
                                                1.7 + 0.3 * std::cos(rise)));
  }
  return cloud;
}

TEST(Upright, StatuesStandOnTheRimOfTheirBase) {
  PointCloud cloud = statue();
  for (const UpAxis custom : {UpAxis::pos_y, UpAxis::pos_z}) {
    cloud.up = custom;
    EXPECT_EQ(guess_upright(cloud).up, UpAxis::pos_z);
  }
  turn(cloud, y_up);
  for (const UpAxis custom : {UpAxis::pos_y, UpAxis::pos_z}) {
    cloud.up = custom;
    EXPECT_EQ(guess_upright(cloud).up, UpAxis::pos_y);
  }
}

TEST(Upright, WhereNothingTellsTheCustomIsNamed) {
  std::mt19937 random(22);
  std::normal_distribution<float> normal;
  PointCloud ball;
  for (int i = 0; i < 20'000; ++i)
    ball.positions.push_back(glm::normalize(vec3(normal(random), normal(random), normal(random))));
  for (const auto& [custom, other] :
       {std::pair(UpAxis::pos_y, UpAxis::pos_z), {UpAxis::pos_z, UpAxis::pos_y}}) {
    ball.up = custom;
    EXPECT_EQ(guess_upright(ball).up, custom);
    EXPECT_EQ(guess_upright(ball).other, other);
  }
  // Of 39 reconstructions whose cameras are beside them 37 have -Y up.
  ball.up = UpAxis::neg_y;
  EXPECT_EQ(up_candidates(ball)[0].up, UpAxis::neg_y);
  EXPECT_GT(up_candidates(ball)[0].probability, 0.85);
  ball.up = UpAxis::pos_z;
  ball.las.emplace();
  EXPECT_FALSE(guess_upright(ball).other) << "surveys have a vertical";
}

TEST(Upright, RoomsHaveTheirFloorBelow) {
  for (float turned : {0.0f, 0.4f})
    for (UpAxis custom : {UpAxis::pos_y, UpAxis::pos_z}) {
      PointCloud cloud = closed_room({6.4f, 4.8f, 2.7f}, turned);
      cloud.up = custom;
      EXPECT_EQ(guess_upright(cloud).up, UpAxis::pos_z) << turned;
      turn(cloud, y_up);
      EXPECT_EQ(guess_upright(cloud).up, UpAxis::pos_y) << turned;
      if (turned != 0) continue;
      turn(cloud, glm::dmat3(1, 0, 0, 0, -1, 0, 0, 0, -1));  // as a camera that looks ahead has it
      EXPECT_EQ(guess_upright(cloud).up, UpAxis::neg_y) << turned;
    }
  // Higher than wide: here the custom is all that tells.
  PointCloud corridor = closed_room({9, 1.6f, 2.7f}, 0);
  corridor.up = UpAxis::pos_z;
  EXPECT_EQ(guess_upright(corridor).up, UpAxis::pos_z);
  turn(corridor, y_up);
  corridor.up = UpAxis::pos_y;
  EXPECT_EQ(guess_upright(corridor).up, UpAxis::pos_y);
}

// The walls of a tunnel are flatter than its floor; seen from its end it is a ring.
TEST(Upright, TunnelsLieAsTheirSurveyHasThem) {
  std::mt19937 random(32);
  std::uniform_real_distribution<float> unit(0, 1);
  for (bool along_y : {false, true}) {
    PointCloud tunnel;
    tunnel.up = UpAxis::pos_z;
    tunnel.las.emplace();
    for (int i = 0; i < 60'000; ++i) {  // walls 2 m high, a vault on them, a floor that is a gutter
      const float along = 60 * unit(random), at = unit(random), angle = float(M_PI) * unit(random);
      const float side = i % 2 == 0 ? -3.0f : 3.0f;
      const glm::vec2 p = i % 4 == 0   ? glm::vec2(6 * at - 3, -0.8f * (1 - std::abs(2 * at - 1)))
                          : i % 4 == 1 ? glm::vec2(3 * std::cos(angle), 2 + 3 * std::sin(angle))
                                       : glm::vec2(side, 2 * at);
      tunnel.positions.push_back(along_y ? vec3(p.x, along, p.y) : vec3(along, p.x, p.y));
    }
    EXPECT_EQ(guess_upright(tunnel).up, UpAxis::pos_z) << along_y;
  }
}

/// A crown that leans to one side on a trunk, z up.
PointCloud tree() {
  std::mt19937 random(41);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> unit(0, 1);
  PointCloud cloud;
  for (int i = 0; i < 30'000; ++i) {
    const vec3 way =
        std::cbrt(unit(random)) * glm::normalize(vec3(normal(random), normal(random), normal(random)));
    cloud.positions.push_back(
        i % 20 == 0 ? vec3(0.15f * std::cos(float(i)), 0.15f * std::sin(float(i)), 4 * unit(random))
                    : vec3(1, 0.2f, 6) + vec3(2.5f, 2.2f, 3) * way);
  }
  return cloud;
}

/// Rolling ground with trees on it, z up.
PointCloud land() {
  std::mt19937 random(42);
  std::uniform_real_distribution<float> unit(0, 1);
  PointCloud cloud;
  for (int i = 0; i < 40'000; ++i) {
    const float x = 200 * unit(random), y = 150 * unit(random);
    cloud.positions.push_back({x, y, 8 * std::sin(x / 40) + (i % 4 == 0 ? 12 * unit(random) : 0)});
  }
  return cloud;
}

/// Arms stretched out: as wide as high, and thin.
PointCloud stretched_figure() {
  PointCloud cloud = figure();
  for (vec3& p : cloud.positions) {
    const float aside = std::abs(p.x);
    if (aside > 0.24f && p.y > 0.7f) p = {std::copysign(0.1f + 1.5f - p.y, p.x), 1.4f + (aside - 0.35f), p.z};
  }
  turn(cloud, glm::dmat3(1, 0, 0, 0, 0, 1, 0, -1, 0));  // z up
  return cloud;
}

// The convention of the format is right for most files: it takes more than a shape that is doubtful to leave
// it.
TEST(Upright, EveryKindKeepsAConventionThatIsRight) {
  const std::pair<const char*, PointCloud> kinds[] = {{"statue", statue()},
                                                      {"house", house()},
                                                      {"tree", tree()},
                                                      {"land", land()},
                                                      {"room", closed_room({6.4f, 4.8f, 2.7f}, 0)},
                                                      {"figure", stretched_figure()}};
  for (const auto& [name, kind] : kinds)
    for (const double turned_deg : {0.0, 30.0, 45.0, 200.0})
      for (const int nth : {1, 10}) {
        PointCloud cloud = every(nth, kind);
        turn(cloud, glm::dmat3(glm::rotate(dmat4(1), glm::radians(turned_deg), dvec3(0, 0, 1))));
        cloud.up = UpAxis::pos_z;
        EXPECT_EQ(guess_upright(cloud).up, UpAxis::pos_z) << name << ", " << turned_deg << ", 1 of " << nth;
        turn(cloud, y_up);
        cloud.up = UpAxis::pos_y;
        EXPECT_EQ(guess_upright(cloud).up, UpAxis::pos_y) << name << ", " << turned_deg << ", 1 of " << nth;
      }
}

TEST(Upright, HeightsOfSurveysAreAlongZ) {
  PointCloud georeferenced = statue();
  turn(georeferenced, y_up);
  georeferenced.up = UpAxis::pos_y;
  ASSERT_EQ(guess_upright(georeferenced).up, UpAxis::pos_y);
  georeferenced.crs = "EPSG:25832";
  EXPECT_EQ(guess_upright(georeferenced).up, UpAxis::pos_z);
  georeferenced.crs.clear(), georeferenced.up = UpAxis::pos_z;
  ASSERT_EQ(guess_upright(georeferenced).up, UpAxis::pos_y);
  georeferenced.las.emplace();
  EXPECT_EQ(guess_upright(georeferenced).up, UpAxis::pos_z);
  EXPECT_FALSE(guess_upright(georeferenced).other);
}

TEST(Upright, HeightsOfMapsWithoutASystemAreTheSmallCoordinate) {
  PointCloud tree = statue();
  turn(tree, y_up);
  tree.up = UpAxis::pos_y;
  ASSERT_EQ(guess_upright(tree).up, UpAxis::pos_y);
  tree.origin = {551'152, 5'249'119, 1829};  // of UTM, as text and PLY exports have them
  EXPECT_EQ(guess_upright(tree).up, UpAxis::pos_z);
  EXPECT_EQ(guess_upright(tree).reason, "heights of map coordinates");
  tree.origin = {551'152, 1829, -5'249'119};  // the same where y is up
  EXPECT_EQ(guess_upright(tree).up, UpAxis::pos_y);
  tree.origin = {551, 249, 1829};  // a scanner's own
  EXPECT_EQ(guess_upright(tree).up, UpAxis::pos_y);
}

// Handles and spouts are alike left and right of a pot, in the middle of its sides: nothing is below as
// above.
TEST(Upright, ThingsAreAlikeLeftAndRightNotAboveAndBelow) {
  std::mt19937 random(51);
  std::uniform_real_distribution<double> unit(0, 1);
  PointCloud pot;  // y up, a body that is round about y, spout and handle along x: alike across z
  for (int i = 0; i < 2000; ++i) {
    const double height = unit(random), angle = 2 * M_PI * unit(random);
    const double radius = i % 5 == 0 ? 0.25 : 1 - 0.5 * height;
    pot.positions.push_back(i % 5 == 0
                                ? vec3((1 + height) * (i % 2 == 0 ? 1 : -1),
                                       0.3 + 0.4 * height + 0.1 * std::sin(angle), 0.1 * std::cos(angle))
                                : vec3(radius * std::cos(angle), 1.2 * height, radius * std::sin(angle)));
  }
  const std::vector<UpCandidate> candidates = up_candidates(pot);
  const auto alike = [&](UpAxis up) {
    for (const UpCandidate& candidate : candidates)
      if (candidate.up == up) return candidate.evidence[std::size_t(UpEvidence::mirrored)];
    ADD_FAILURE() << to_string(up) << " is no candidate";
    return 0.0;
  };
  EXPECT_GT(alike(UpAxis::pos_z), alike(UpAxis::pos_y) + 0.2);
  EXPECT_EQ(alike(UpAxis::neg_x), alike(UpAxis::pos_x));
  EXPECT_EQ(guess_upright(pot).up, UpAxis::pos_y);
}

// Ground, however few stand on it, tells above from below: reconstructions of photographs have y down.
TEST(Upright, WhatStandsOnGroundTellsWhichEndIsUp) {
  for (const double turned_deg : {0.0, 30.0, 200.0})
    for (const int nth : {1, 10}) {
      PointCloud cloud = every(nth, house());
      turn(cloud, glm::dmat3(glm::rotate(dmat4(1), glm::radians(turned_deg), dvec3(0, 0, 1))));
      turn(cloud, glm::dmat3(1, 0, 0, 0, 0, 1, 0, -1, 0));
      cloud.up = UpAxis::pos_y;
      EXPECT_EQ(guess_upright(cloud).up, UpAxis::neg_y) << turned_deg << ", 1 of " << nth;
    }
}

// One side of a small thing, a few degrees wide, in the axes of the camera that saw it.
TEST(Upright, WhatOneCameraSawIsInItsAxes) {
  std::mt19937 random(43);
  std::normal_distribution<float> normal;
  PointCloud seen, whole;
  for (int i = 0; i < 40'000; ++i) {
    const vec3 way = glm::normalize(vec3(normal(random), normal(random), normal(random)));
    const vec3 at = vec3(0.02f, -0.03f, 1) + vec3(0.08f, 0.12f, 0.09f) * way;
    whole.positions.push_back(at);
    if (glm::dot(way / vec3(0.08f, 0.12f, 0.09f), at) < 0) seen.positions.push_back(at);
  }
  EXPECT_EQ(guess_upright(seen).up, UpAxis::neg_y);
  EXPECT_TRUE(is_camera_view(seen));
  turn(seen, glm::dmat3(1, 0, 0, 0, -1, 0, 0, 0, -1));  // as renderers have it
  EXPECT_EQ(guess_upright(seen).up, UpAxis::pos_y);
  turn(whole, glm::dmat3(1, 0, 0, 0, -1, 0, 0, 0, -1));
  EXPECT_FALSE(is_camera_view(whole)) << "both of its sides were seen";
}

// Photographs see all sides of a thing, in the axes of the first, and give it colours.
TEST(Upright, WhatPhotographsSawIsInTheAxesOfTheFirst) {
  std::mt19937 random(48);
  std::normal_distribution<float> normal;
  PointCloud ball;
  for (int i = 0; i < 20'000; ++i) {
    const vec3 way = glm::normalize(vec3(normal(random), normal(random), normal(random)));
    ball.positions.push_back(way + 0.03f * vec3(normal(random), normal(random), normal(random)));
  }
  const auto placed = [&](const vec3& at, bool colored) {
    PointCloud cloud = ball;
    for (vec3& p : cloud.positions) p += at;
    if (colored) cloud.colors.assign(cloud.size(), Rgba8{90, 120, 60, 255});
    cloud.up = UpAxis::pos_z;
    return cloud;
  };
  const Upright before = guess_upright(placed({0.3f, -0.2f, 4}, true));
  EXPECT_EQ(before.up, UpAxis::neg_y);
  EXPECT_EQ(before.reason, "guessed: a camera's view: all lies before the origin");
  PointCloud unseen = placed({0.3f, -0.2f, 4}, true);
  unseen.positions.insert(unseen.positions.end(), unseen.size() / 20, vec3(0));
  unseen.colors.resize(unseen.size());
  EXPECT_EQ(guess_upright(unseen).up, UpAxis::neg_y) << "0 0 0 where the camera saw nothing";
  EXPECT_EQ(guess_upright(placed({0.3f, -0.2f, -4}, true)).up, UpAxis::pos_y) << "as renderers look";
  EXPECT_EQ(guess_upright(placed({0.3f, -0.2f, -4}, false)).up, UpAxis::pos_z) << "scanned";
  EXPECT_EQ(guess_upright(placed({3, 0, 4}, true)).up, UpAxis::pos_z) << "beside where the camera looked";
  PointCloud pole = placed(vec3(0), true);  // on the origin, as wide as a man
  for (vec3& p : pole.positions) p = vec3(0.1f * p.x, 0.1f * p.y, 1 + p.z);
  for (const UpCandidate& each : up_candidates(pole))
    EXPECT_EQ(each.evidence[std::size_t(UpEvidence::camera)], 0) << to_string(each.up);
}

// Cameras that moved along a street in the axes of the first: no one picture holds it, but all lies before
// them.
TEST(Upright, WhatSeveralCamerasSawLiesBeforeTheFirst) {
  std::mt19937 random(59);
  std::uniform_real_distribution<float> unit(0, 1);
  PointCloud street;
  for (int i = 0; i < 20'000; ++i) {
    street.positions.push_back(
        {-4 + 23 * unit(random) * unit(random), -5 + 8 * unit(random), 4 + 6 * unit(random)});
    street.colors.push_back({std::uint8_t(random()), std::uint8_t(random()), 90, 255});
  }
  street.up = UpAxis::pos_z;
  const auto evidence = [](const PointCloud& cloud) {
    for (const UpCandidate& each : up_candidates(cloud))
      if (each.up == UpAxis::neg_y) return each.evidence[std::size_t(UpEvidence::camera)];
    return -1.0;
  };
  EXPECT_GT(evidence(street), 0.4);
  EXPECT_EQ(guess_upright(street).up, UpAxis::neg_y);
  PointCloud labels = street, around = street, elsewhere = street;
  labels.colors.assign(labels.size(), Rgba8{90, 120, 60, 255});
  for (vec3& p : around.positions) p.z -= 7;
  for (vec3& p : elsewhere.positions) p.x += 60;
  for (const PointCloud& none : {labels, around, elsewhere}) {
    EXPECT_EQ(evidence(none), 0);
    EXPECT_NE(guess_upright(none).up, UpAxis::neg_y);
  }
}

// Whoever shifts the plan of a tile to its middle and keeps its heights has the origin below it, as before a
// camera that looks up; photographs coloured it.
TEST(Upright, ATileOverTheOriginIsNoPicture) {
  std::mt19937 random(49);
  std::uniform_real_distribution<float> unit(0, 1);
  for (const float height : {120.0f, 300.0f, -80.0f})
    for (const bool is_colored : {true, false}) {
      const float top = is_colored ? 0 : 30;  // of a hill
      PointCloud tile;
      for (int i = 0; i < 20'000; ++i) {
        const float x = 200 * unit(random) - 100, y = 160 * unit(random) - 80;
        const float hill = top * std::exp(-(x * x + y * y) / 2000);
        tile.positions.push_back({x, y, height + hill + 0.02f * x + (i % 5 == 0 ? 15 * unit(random) : 0)});
      }
      if (is_colored) tile.colors.assign(tile.size(), Rgba8{90, 120, 60, 255});
      tile.up = UpAxis::pos_z;
      EXPECT_EQ(guess_upright(tile).up, UpAxis::pos_z) << height << " " << is_colored;
      EXPECT_FALSE(is_camera_view(tile)) << height << " " << is_colored;
    }
}

// A toy cut out of a picture is as thin as land; that its points come in columns and rows tells that a camera
// saw it. Without them a picture's y may be up or down, which is said.
TEST(Upright, ThePixelsOfACutOutTellThatItIsAPicture) {
  std::mt19937 random(44);
  std::uniform_real_distribution<double> unit(-0.5, 0.5);
  for (const bool has_pixels : {true, false}) {
    PointCloud seen;
    for (int x = -90; x <= 90; ++x)
      for (int y = -10; y <= 160; ++y) {
        const double a = has_pixels ? x : x + unit(random), b = has_pixels ? y : y + unit(random);
        const double limb = std::max(0.0, 1 - std::pow((std::abs(a) - 45) / 40, 2));
        if (limb == 0 && std::abs(b - 60) > 40) continue;
        seen.positions.push_back(vec3((1.3 - 0.17 * limb) * dvec3(a / 525, b / 525, 1)));
      }
    seen.up = UpAxis::pos_z;
    const Upright guess = guess_upright(seen);
    EXPECT_EQ(guess.reason.rfind("guessed: ", 0), has_pixels ? std::string::npos : 0u) << guess.reason;
    if (has_pixels) EXPECT_EQ(guess.up, UpAxis::neg_y) << guess.reason;
  }
}

// Models of photographs have y down, as the first camera has: a few points below decide nothing.
TEST(Upright, ModelsOfPhotographsAreNotTurnedOver) {
  PointCloud cloud = every(4, house());
  turn(cloud, y_up);
  std::mt19937 random(45);
  std::normal_distribution<float> far(0, 6);
  for (int i = 0; i < 4'000; ++i) cloud.positions.push_back({far(random), far(random), far(random)});
  cloud.up = UpAxis::neg_y;
  const UpCandidate down = up_candidates(cloud)[0];
  EXPECT_EQ(down.up, UpAxis::neg_y);
  EXPECT_LT(down.probability, 0.95);
}

// The fingers and the wrist of a hand are no floor and ceiling.
TEST(Upright, AShaftIsNoRoom) {
  std::mt19937 random(46);
  std::uniform_real_distribution<float> unit(0, 1);
  PointCloud cloud;
  cloud.up = UpAxis::pos_y;
  for (int i = 0; i < 20'000; ++i) {
    const float angle = 6.2832f * unit(random), radius = i % 3 ? std::sqrt(unit(random)) : 1;
    cloud.positions.push_back({0.06f * radius * std::cos(angle),
                               i % 3 == 0 ? 0.3f * unit(random) : (i % 3 == 1 ? 0 : 0.3f),
                               0.05f * radius * std::sin(angle)});
  }
  for (const UpCandidate& each : up_candidates(cloud))
    EXPECT_EQ(each.evidence[std::size_t(UpEvidence::room)], 0) << to_string(each.up);
}

double aside(const PointCloud& cloud, UpAxis up) {
  for (const UpCandidate& each : up_candidates(cloud))
    if (each.up == up) return each.evidence[std::size_t(UpEvidence::aside)];
  return -1;
}

/// A stem 8 high, z up, of which a few leaves rise, arch outwards and droop: to one side longer ones.
PointCloud seedling() {
  std::mt19937 random(46);
  std::uniform_real_distribution<float> unit(0, 1);
  PointCloud cloud;
  cloud.up = UpAxis::pos_y;
  for (int i = 0; i < 20'000; ++i) {
    const float angle = 6.2832f * unit(random), along = unit(random);
    if (i % 8 == 0) {
      cloud.positions.push_back({0.2f * std::cos(angle), 0.2f * std::sin(angle), 8 * along});
      continue;
    }
    const int leaf = i % 5;
    const float turn = 1.2566f * float(leaf), length = leaf == 0 ? 12.0f : 6.0f;
    const float out = length * along, side = 0.8f * (unit(random) - 0.5f);
    cloud.positions.push_back({out * std::cos(turn) - side * std::sin(turn),
                               out * std::sin(turn) + side * std::cos(turn),
                               4 + 0.8f * float(leaf) + 8 * along * (1 - along) - 1.5f * along});
  }
  return cloud;
}

// By construction: the foot of the stem is nearer to below the middle of the crown than the tip of any leaf.
TEST(Upright, WhatGrowsIsOverItsStem) {
  PointCloud plant = seedling();
  EXPECT_EQ(guess_upright(plant).up, UpAxis::pos_z);
  for (UpAxis other : {UpAxis::pos_x, UpAxis::neg_x, UpAxis::pos_y, UpAxis::neg_y})
    EXPECT_LT(aside(plant, UpAxis::pos_z), 0.7 * aside(plant, other)) << to_string(other);
  turn(plant, y_up);
  plant.up = UpAxis::pos_z;
  EXPECT_EQ(guess_upright(plant).up, UpAxis::pos_y);
}

// Of a column and a ball on it that has two thirds of all: the middle is twice as far from the column as from
// the ball's top, on which it stands upside down.
TEST(Upright, AFootIsAsFarAsideAsMeasured) {
  std::mt19937 random(47);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (float a : {0.0f, 1.0f}) {
    PointCloud cloud;
    cloud.up = UpAxis::pos_z;
    while (cloud.size() < 60'000) {
      const vec3 ball(unit(random), unit(random), unit(random));
      if (glm::length(ball) > 1) continue;
      cloud.positions.push_back(vec3(a, 0, 10) + 2.0f * ball);
      if (cloud.size() % 3 == 2)
        cloud.positions.push_back({0.01f * unit(random), 0.01f * unit(random), 5 + 5 * unit(random)});
    }
    const double below = aside(cloud, UpAxis::pos_z), above = aside(cloud, UpAxis::neg_z);
    // The cap of the ball is some 3,700 points within 1.6: their middle is known to .02 of the spread of 1.
    if (a == 0)
      EXPECT_LT(std::max(below, above), 0.05);
    else
      EXPECT_NEAR(below / above, 2, 0.3);
  }
}

// Shelves are level whichever way they are turned: their back is in line with no axis.
TEST(Upright, LevelSurfacesTellWithoutAFloor) {
  std::mt19937 random(47);
  std::uniform_real_distribution<float> unit(0, 1);
  for (const bool with_normals : {false, true}) {
    PointCloud shelves;  // y up: six boards, seen from above where there are normals, and their back
    for (int i = 0; i < 40'000; ++i) {
      const int board = i % 7;
      const float aside = 2 * unit(random) - 1, depth = 0.8f * unit(random);
      shelves.positions.push_back(board == 6 ? vec3(aside, 2 * unit(random), 0)
                                             : vec3(aside, 0.15f + 0.3f * float(board), depth));
      if (with_normals) shelves.normals.push_back(board == 6 ? vec3(0, 0, 1) : vec3(0, 1, 0));
    }
    turn(shelves, glm::dmat3(glm::rotate(dmat4(1), 0.6, dvec3(0, 1, 0))));
    shelves.up = UpAxis::pos_z;
    const Upright guess = guess_upright(shelves);
    EXPECT_EQ(guess.up, UpAxis::pos_y) << guess.reason;
  }
}

// LOAM has y up, whatever the format's convention; a facade of that shape is lower.
TEST(Upright, NoWallIsAsHighAsAMapIsWide) {
  PointCloud map;  // streets and blocks
  for (int x = -100; x < 100; ++x)
    for (int z = -75; z < 75; ++z)
      map.positions.push_back({float(x), x % 20 < 6 && z % 20 < 6 ? 18 + 0.1f * float(x % 7) : -2, float(z)});
  map.up = UpAxis::pos_z;
  EXPECT_EQ(guess_upright(map).up, UpAxis::pos_y);
  for (vec3& p : map.positions) p *= 0.1f;
  EXPECT_EQ(guess_upright(map).up, UpAxis::pos_z);
}

// Some depth cameras have y up: what is level is seen from above.
TEST(Upright, OfACameraTheFloorIsSeenFromAbove) {
  PointCloud seen;  // a floor 1 m below the camera, and a wall 4 m before it
  for (int i = -100; i <= 100; ++i)
    for (int j = -75; j <= 75; ++j) {
      const dvec3 ray(0.005 * i, 0.005 * j, 1);
      seen.positions.push_back(vec3(ray * (ray.y < -0.25 ? -1 / ray.y : 4.0)));
    }
  seen.up = UpAxis::pos_y;
  EXPECT_EQ(guess_upright(seen).up, UpAxis::pos_y);
  seen.up = UpAxis::pos_z;  // whatever the format's convention
  EXPECT_EQ(guess_upright(seen).up, UpAxis::pos_y);
  turn(seen, glm::dmat3(-1, 0, 0, 0, -1, 0, 0, 0, 1));
  EXPECT_EQ(guess_upright(seen).up, UpAxis::neg_y);
  EXPECT_EQ(guess_upright(seen).reason.rfind("guessed: ", 0), std::string::npos);
}

// A table, a near and a far wall by stereo, whose depths scatter by a tenth, and of which points were drawn
// at random: no pixel is left, and lines of sight meet several depths, but the picture still ends at its
// sides.
TEST(Upright, ANoisyPictureEndsAtItsSides) {
  std::mt19937 random(12);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::normal_distribution<double> noise(1, 0.1);
  for (const bool is_picture : {true, false}) {
    PointCloud seen;
    for (int i = 0; i < 30'000; ++i) {
      const dvec3 ray(0.6 * unit(random), 0.45 * unit(random), 1);
      const double depth = (ray.y > 0.2 ? 0.4 / ray.y : ray.x < 0 ? 2 : 4) * noise(random);
      // The same shape without a frame: as wide far off as near.
      seen.positions.push_back(vec3(is_picture ? depth * ray : dvec3(1.5 * ray.x, 1.5 * ray.y, depth)));
    }
    seen.up = UpAxis::pos_z;
    EXPECT_EQ(is_camera_view(seen), is_picture) << guess_upright(seen).reason;
    if (is_picture) EXPECT_EQ(guess_upright(seen).up, UpAxis::neg_y);
  }
}

// A bumpy wall in an organised file: its rows run from top to bottom, whatever the custom of the axes and the
// order of the points. Without rows the custom decides.
TEST(Upright, RowsOfAPictureRunDownwards) {
  for (const float along : {1.0f, -1.0f})
    for (const float down : {1.0f, -1.0f})
      for (const UpAxis convention : {UpAxis::pos_y, UpAxis::pos_z}) {
        PointCloud seen;
        seen.up = convention;
        for (int row = -60; row <= 60; ++row)
          for (int column = -80; column <= 80; ++column) {
            const float depth = 3 + 0.1f * std::sin(0.1f * float(column)) * std::cos(0.1f * float(row));
            seen.positions.push_back(depth * vec3(0.005f * float(column), down * 0.005f * float(row), along));
            seen.grid_index.push_back(std::uint32_t(seen.grid_index.size()));
          }
        seen.grids = {{0, seen.size(), 161, 121, {}}};
        const auto shuffle = [](auto& values) {
          std::shuffle(values.begin(), values.end(), std::mt19937(3));
        };
        for (const bool is_shuffled : {false, true}) {
          if (is_shuffled) shuffle(seen.positions), shuffle(seen.grid_index);
          EXPECT_EQ(guess_upright(seen).up, down > 0 ? UpAxis::neg_y : UpAxis::pos_y) << along << " " << down;
        }
        seen.grids.clear(), seen.grid_index.clear();
        EXPECT_EQ(guess_upright(seen).up, along > 0 ? UpAxis::neg_y : UpAxis::pos_y) << along << " " << down;
      }
}

// Rows that run down and a ceiling that looks like a floor: one is wrong, and the other a guess.
TEST(Upright, RowsAndFloorsThatDisagreeMakeAGuess) {
  for (const float floor : {1.0f, -1.0f}) {
    PointCloud seen;
    seen.up = UpAxis::pos_z;
    for (int row = -60; row <= 60; ++row)
      for (int column = -80; column <= 80; ++column) {
        const float down = 0.008f * float(row), far = 4;
        // A wall 4 m away, and what is level 1 m below, or above, the camera.
        const float depth = down * floor > 0 ? std::min(far, 1 / std::abs(down)) : far;
        seen.positions.push_back(depth * vec3(0.006f * float(column), down, 1));
        seen.grid_index.push_back(std::uint32_t(seen.grid_index.size()));
      }
    seen.grids = {{0, seen.size(), 161, 121, {}}};
    const Upright guess = guess_upright(seen);
    EXPECT_EQ(guess.reason.rfind("guessed: ", 0) == 0, floor < 0) << guess.reason;
    if (floor > 0) EXPECT_EQ(guess.up, UpAxis::neg_y);
  }
}

TEST(Upright, TablesStayOnTheirFeet) {
  std::mt19937 random(13);
  std::uniform_real_distribution<float> unit(0, 1);
  PointCloud cloud;
  cloud.up = UpAxis::pos_z;
  for (int i = 0; i < 40'000; ++i) {  // half of the points on four legs
    const vec3 leg(i % 8 < 4 ? 0.0f : 1.55f, i % 4 < 2 ? 0.0f : 0.75f, 0);
    const float a = unit(random), b = unit(random), c = unit(random);
    cloud.positions.push_back(i % 2 == 0 ? vec3(1.6f * a, 0.8f * b, 0.75f)
                                         : leg + vec3(0.05f * a, 0.05f * b, 0.75f * c));
  }
  EXPECT_EQ(guess_upright(cloud).up, UpAxis::pos_z);
  turn(cloud, y_up);
  cloud.up = UpAxis::pos_y;
  EXPECT_EQ(guess_upright(cloud).up, UpAxis::pos_y);
}

TEST(Upright, FewPointsStandAsManyDo) {
  // A dome on its base, which lies on its side by the custom of its format. Every tenth point is of the base.
  std::mt19937 random(14);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int points : {800, 3000, 40'000}) {
    PointCloud cloud;
    cloud.up = UpAxis::pos_z;
    for (int i = 0; i < points; ++i) {
      const double angle = 2 * M_PI * unit(random), share = unit(random);
      const double radius = i % 10 == 0 ? std::sqrt(share) : std::sqrt(1 - share * share);
      cloud.positions.push_back(
          vec3(radius * std::cos(angle), i % 10 == 0 ? 0 : share, radius * std::sin(angle)));
    }
    EXPECT_EQ(guess_upright(cloud).up, UpAxis::pos_y) << points;
  }
}

TEST(Upright, RobotsLookAlongX) {
  PointCloud cloud = street_sweep(64);
  std::erase_if(cloud.positions, [](const vec3& p) { return !(p.x > 1 && std::abs(p.y) < 0.6f * p.x); });
  cloud.up = UpAxis::pos_z;
  const Upright guess = guess_upright(cloud);
  EXPECT_EQ(guess.up, UpAxis::pos_z);
  EXPECT_TRUE(is_camera_view(cloud)) << guess.reason;
  EXPECT_FALSE(is_camera_view(street_sweep(64)));
}

// A lidar is blind along the axis that it turns about, and what is level is the ground it stands over.
TEST(Upright, ALidarHasTheGroundBelowIt) {
  const glm::dmat3 over(1, 0, 0, 0, -1, 0, 0, 0, -1);
  for (const int rings : {16, 32, 64})
    for (const double turned_deg : {0.0, 30.0, 200.0}) {
      PointCloud cloud = street_sweep(rings);
      turn(cloud, glm::dmat3(glm::rotate(dmat4(1), glm::radians(turned_deg), dvec3(0, 0, 1))));
      const auto expect = [&](UpAxis up) {
        EXPECT_EQ(guess_upright(cloud).up, up) << rings << " rings, " << turned_deg;
      };
      expect(UpAxis::pos_z);
      turn(cloud, over);
      expect(UpAxis::neg_z);
      turn(cloud, y_up);
      expect(UpAxis::neg_y);
      turn(cloud, over);
      expect(UpAxis::pos_y);
    }
}

TEST(Upright, AStrayPointAboveALidarChangesNothing) {
  PointCloud cloud = street_sweep(32);
  turn(cloud, glm::dmat3(1, 0, 0, 0, -1, 0, 0, 0, -1));
  for (const std::ptrdiff_t at : {0, 1, 2}) {  // of which not all are in a sample
    PointCloud with = cloud;
    with.positions.insert(with.positions.begin() + at, vec3(0.02f, 0.01f, 3));
    EXPECT_EQ(guess_upright(with).up, UpAxis::neg_z) << at;
  }
}

// Walls without a floor tell only which axis it is, whichever of them the lidar is nearest to.
TEST(Upright, ALidarBetweenWallsStandsAsItsFormatHasIt) {
  const vec3 low(-4, -2, -9), high(2, 8, 9);
  PointCloud cloud;
  for (int ring = 0; ring < 32; ++ring)
    for (int step = 0; step < 900; ++step) {
      const double angle = glm::radians(0.4 * step), rise = glm::radians(-15.5 + ring);
      const vec3 way(std::cos(rise) * std::cos(angle), std::cos(rise) * std::sin(angle), std::sin(rise));
      float t = 1e9f;
      for (int k = 0; k < 3; ++k) t = std::min(t, (way[k] < 0 ? low[k] : high[k]) / way[k]);
      cloud.positions.push_back(t * way);
    }
  for (const UpAxis up : {UpAxis::pos_z, UpAxis::pos_y}) {
    cloud.up = up;
    EXPECT_EQ(guess_upright(cloud).up, up);
    turn(cloud, y_up);
  }
}

// Where the ground was removed, what is level may be above a lidar; one of a vehicle sees more below it.
TEST(Upright, ALidarThatLooksDownSaysWhatIsBelow) {
  PointCloud cloud;
  for (int ring = 0; ring < 64; ++ring)
    for (int step = 0; step < 900; ++step) {
      const double angle = glm::radians(0.4 * step), rise = glm::radians(-24.9 + 26.9 / 63 * ring);
      const double far = 12 + 4 * std::sin(3 * angle);
      cloud.positions.push_back(vec3(far * std::cos(angle), far * std::sin(angle), far * std::tan(rise)));
    }
  for (int i = 0; i < 100; ++i)
    for (int j = 0; j < 100; ++j)  // a canopy
      cloud.positions.push_back(vec3(9 + 0.04f * float(i), -2 + 0.04f * float(j), 0.4f));
  EXPECT_EQ(guess_upright(cloud).up, UpAxis::pos_z);
}

// What lies beyond a level cut above a lidar is no ground below one that hangs.
TEST(Upright, AboveACutIsNoGround) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> unit(0, 1);
  PointCloud cloud;
  for (int i = 0; i < 20'000; ++i) {  // walls and trees above 2 m, dense where they are cut
    const float angle = 6.2832f * unit(random), far = 5 + 40 * unit(random) * unit(random);
    const float height = 2 + (i % 4 == 0 ? 0.02f * unit(random) : 8 * unit(random) * unit(random));
    cloud.positions.push_back({far * std::cos(angle), far * std::sin(angle), height});
  }
  EXPECT_EQ(guess_upright(cloud).up, UpAxis::pos_z);
}

// Two levels of a map about its origin are no ground, and thinner than a figure that lies.
TEST(Upright, SlicesOfAMapLie) {
  PointCloud cloud;
  for (const float height : {0.05f, 0.5f})
    for (int i = 0; i < 4000; ++i) {
      const float along = 0.01f * float(i);
      cloud.positions.push_back({-12 + std::min(along, 20.0f), along < 20 ? -8 : 8, height});
      cloud.positions.push_back({along < 20 ? -12 : 8, -8 + 0.8f * std::min(along, 20.0f), height});
      cloud.positions.push_back({3 * std::cos(along), 3 * std::sin(along), height});
    }
  EXPECT_EQ(guess_upright(cloud).up, UpAxis::pos_z);
}

// Of public OBJ files 51 have Y up and 5 Z, of PLY 27 and 22: what is doubtful in PLY is Y in OBJ.
TEST(Upright, ObjKeepsItsConventionWherePlyDoesNot) {
  std::mt19937 random(47);
  std::normal_distribution<float> normal;
  PointCloud cloud;  // an egg on a base
  while (cloud.size() < 20'000) {
    vec3 p = vec3(1, 1.3f, 0.8f) * glm::normalize(vec3(normal(random), normal(random), normal(random)));
    p.z = std::max(p.z, -0.75f);
    cloud.positions.push_back(5.f + p);
  }
  cloud.up = UpAxis::pos_y;
  EXPECT_EQ(guess_upright(cloud).up, UpAxis::pos_z);
  cloud.provenance = Provenance::model;
  EXPECT_EQ(guess_upright(cloud).up, UpAxis::pos_y);
  PointCloud ground = street_sweep();
  ground.up = UpAxis::pos_y, ground.provenance = Provenance::model;
  EXPECT_EQ(guess_upright(ground).up, UpAxis::pos_z) << "what is clear stays so";
}

// An egg on its base, as somebody placed it: the base at 0, and 0 in the middle.
TEST(Upright, WhatBeginsAtZeroWasPlacedThere) {
  std::mt19937 random(53);
  std::normal_distribution<float> normal;
  PointCloud egg;
  while (egg.size() < 20'000)
    egg.positions.push_back(vec3(1, 1.3f, 0.8f) *
                            glm::normalize(vec3(normal(random), normal(random), normal(random))));
  for (const UpAxis up : {UpAxis::pos_y, UpAxis::pos_z}) {
    PointCloud placed = egg;
    const int axis = int(up) / 2;
    float lowest = 0;
    for (const vec3& p : egg.positions) lowest = std::min(lowest, p[axis]);
    for (vec3& p : placed.positions) p[axis] -= lowest;
    placed.up = UpAxis::pos_y;
    const Upright guess = guess_upright(placed);
    EXPECT_EQ(guess.up, up) << guess.reason;
    const auto evidence = [&](const PointCloud& cloud) {
      for (const UpCandidate& each : up_candidates(cloud))
        if (each.up == up) return each.evidence[std::size_t(UpEvidence::placed)];
      return -1.0;
    };
    EXPECT_EQ(evidence(placed), 1);
    PointCloud aside = placed;
    for (vec3& p : aside.positions) p[(axis + 1) % 3] += 2;
    EXPECT_EQ(evidence(aside), 0);
    EXPECT_EQ(evidence(egg), 0);
    // Strays and what sensors write where they see nothing are no place that it stands on.
    PointCloud above = placed;
    for (vec3& p : above.positions) p[axis] += 2;
    above.positions.insert(above.positions.end(), 500, vec3(0));
    for (const float at : {0.001f, -0.001f}) above.positions.push_back(vec3(0.1f, 0.1f, 0.1f) + vec3(at));
    above.positions.back()[axis] = above.positions[above.size() - 2][axis] = 0;
    EXPECT_EQ(evidence(above), 0);
  }
}

// A roof in a box from 0 to 1, as data sets have them, lies before the origin along every axis.
TEST(Upright, WhatLiesAsideIsSeldomAPicture) {
  std::mt19937 random(54);
  std::uniform_real_distribution<float> unit(0, 1);
  PointCloud roof;
  for (int i = 0; i < 4000; ++i) {
    const float x = unit(random), y = unit(random);
    roof.positions.push_back({0.9f * x, 0.28f + 0.63f * y, 0.77f + 0.23f * (1 - std::abs(2 * y - 1))});
  }
  roof.up = UpAxis::pos_y;  // by the convention of PLY
  EXPECT_EQ(guess_upright(roof).up, UpAxis::pos_z) << guess_upright(roof).reason;
  const auto as_seen = [&] {
    double sum = 0;
    for (const UpCandidate& each : up_candidates(roof))
      if (int(each.up) / 2 == 1) sum += each.evidence[std::size_t(UpEvidence::camera)];
    return sum;
  };
  const PointCloud afar = roof;
  const auto aside_over_around = [&](float rise) {
    roof = afar;
    for (vec3& p : roof.positions) p.z += rise * p.x;
    const double beside = as_seen();
    for (vec3& p : roof.positions) p -= vec3(0.45f, 0.6f, 0);
    return beside / as_seen();  // all around where a camera would look
  };
  EXPECT_NEAR(aside_over_around(0), 0.75, 0.05);
  EXPECT_NEAR(aside_over_around(0.9f), 0.4, 0.05) << "as deep as it is far away";
}

// The front of a head, open behind: its normals point to the viewer, which is no way up.
TEST(Upright, NormalsOfAShellPointToItsFront) {
  std::mt19937 random(48);
  std::normal_distribution<float> normal;
  PointCloud cloud;
  while (cloud.size() < 20'000) {
    const vec3 way = glm::normalize(vec3(normal(random), normal(random), normal(random)));
    if (way.z < 0) continue;
    const vec3 size(0.75f, way.y > 0 ? 1 : 1.3f, 0.9f);  // the chin is longer than the forehead
    cloud.positions.push_back(size * way + vec3(0, 0, 3));
    cloud.normals.push_back(glm::normalize(way / size));
  }
  for (const Provenance provenance : {Provenance::unknown, Provenance::model}) {
    cloud.up = UpAxis::pos_y, cloud.provenance = provenance;
    const std::vector<UpCandidate> all = up_candidates(cloud);
    for (const UpCandidate& each : all)
      EXPECT_EQ(each.evidence[std::size_t(UpEvidence::normals)], 0) << to_string(each.up);
    EXPECT_NE(all[0].up, UpAxis::pos_z);
  }
}

TEST(Upright, NothingToGuessFromKeepsTheCustom) {
  PointCloud cloud;
  cloud.positions.assign(50, vec3(1, 2, 3));
  cloud.up = UpAxis::pos_y;
  EXPECT_EQ(guess_upright(cloud).up, UpAxis::pos_y);
  cloud.positions.assign(5000, vec3(3, -2, 1));  // no extent at all
  EXPECT_EQ(guess_upright(cloud).up, UpAxis::pos_y);
}

}  // namespace
