// From where a scan is looked at first, and what of it fills the picture.
#include "session/first_view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <set>

#include "session/pose.h"
#include "session/standpoint.h"
#include "session/camera_request.h"
#include "synth/synth.h"

using namespace sfumato;

namespace {

Pose pose_of(PointCloud cloud) {
  scene::Scene scene;
  scene.cloud = std::move(cloud);
  return stand_upright(scene, UpAxis::pos_z);
}

PointCloud box_of(const dvec3& size, int points = 20'000) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  PointCloud cloud;
  cloud.up = UpAxis::pos_z;
  std::discrete_distribution<int> face({size.y * size.z, size.z * size.x, size.x * size.y});
  for (int i = 0; i < points; ++i) {
    dvec3 p(unit(random), unit(random), unit(random));
    p[face(random)] = i % 2;
    cloud.positions.push_back(vec3(p * size));
  }
  return cloud;
}

TEST(Standpoint, InsideIsWhereAScannerIsKnownToHaveStood) {
  PointCloud cloud = box_of({4, 2, 2});
  cloud.scanners.assign(1, dvec3(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_LT(glm::distance(place_inside(cloud), dvec3(2, 1, 1)), 1e-6) << "the middle";
  cloud.scanners.push_back({1, 1, 1});
  EXPECT_EQ(place_inside(cloud), dvec3(1, 1, 1));
}

/// The range of the points' places in the picture: -1 to 1 is its edges.
std::pair<dvec3, dvec3> extent(const std::vector<dvec3>& points, const Camera& camera) {
  const dmat4 clip = camera.projection_matrix() * camera.view();
  dvec3 low(1e9), high(-1e9);
  for (const dvec3& point : points) {
    const glm::dvec4 c = clip * glm::dvec4(point, 1);
    low = glm::min(low, dvec3(c) / c.w), high = glm::max(high, dvec3(c) / c.w);
  }
  return {low, high};
}

TEST(FirstView, MarginsAreEqualAndNothingIsCut) {
  for (const dvec3& size : {dvec3(1, 1, 2), dvec3(4, 9, 0.3), dvec3(9, 2, 1), dvec3(0.1, 0.1, 5)})
    for (const auto& [width, height] : {std::pair(1280, 720), {300, 900}}) {
      const Pose pose = pose_of(box_of(size));
      const auto [low, high] = extent(pose.subject.points, first_view(pose, width, height));
      EXPECT_NEAR(low.x, -high.x, 1e-3) << size.x;
      EXPECT_NEAR(low.y, -high.y, 1e-3) << size.x;
      EXPECT_NEAR(std::max(high.x, high.y), 0.92, 0.01) << size.x << ": as large as the margin allows";
    }
}

TEST(FirstView, OfAHandfulOfPointsEachIsShown) {
  PointCloud cloud;
  cloud.up = UpAxis::pos_z;
  cloud.positions = {{0, 0, 0}, {1, 0, 0}, {0.2f, 1, 0}, {0.5f, 0.5f, 3}, {9, 9, 9}};
  EXPECT_EQ(pose_of(cloud).subject.points.size(), 5u);
}

// A facade, or a profile cut out of a forest: surveys have a vertical, and so have the formats of scanners.
// Where Z is up by convention, what is thin along y is a wall; where Y is, it lies.
TEST(FirstView, WhatIsFlatStandsWhereUpIsZByCustom) {
  PointCloud facade = box_of({20, 0.5, 12});
  scene::Scene mesh, survey;
  mesh.cloud = facade;
  survey.cloud = facade;
  survey.cloud.las.emplace();
  EXPECT_EQ(stand_upright(mesh).upright.up, UpAxis::pos_z);
  EXPECT_EQ(stand_upright(survey).upright.up, UpAxis::pos_z);
  mesh.cloud.up = UpAxis::pos_y;
  EXPECT_EQ(stand_upright(mesh).upright.up, UpAxis::pos_y);
  // Ground lies in both.
  mesh.cloud = box_of({20, 12, 0.5});
  EXPECT_EQ(stand_upright(mesh).upright.up, UpAxis::pos_z);
}

TEST(FirstView, UpIsThatOfTheWholeNotOfAPart) {
  scene::Scene whole, part;
  whole.cloud = box_of({8, 8, 0.5});
  whole.cloud.up = UpAxis::pos_y;
  part = whole;
  EXPECT_EQ(stand_upright(whole).upright.up, UpAxis::pos_z);
  scene::SceneOptions options;
  options.selection.crop = Bounds{{0, 0, 0}, {1, 0.1, 1}};
  scene::narrow(part, scene::files_of({"a"}), options);
  EXPECT_LT(part.cloud.size(), whole.cloud.size() / 50);
  EXPECT_EQ(stand_upright(part).upright.up, UpAxis::pos_z);
}

// A dense plot, and far from it a sparse row, which the frame of the scan leaves out: in a box that somebody
// gave all of it belongs in the picture, also where it is selected from again, as Python does.
TEST(FirstView, ACropIsFramedWhole) {
  scene::Scene scan;
  scan.cloud = box_of({4, 4, 0.5});
  for (int i = 0; i < 1000; ++i) scan.cloud.positions.push_back({60 + 0.002f * float(i), 1, 0});
  scan.cloud.positions.push_back({100, 1, 0});
  const auto shown = [](scene::Scene scene) {
    std::vector<dvec3> points;
    for (std::size_t i = 0; i < scene.cloud.size(); ++i) points.push_back(scene.cloud.world(i));
    const auto [low, high] = extent(points, first_view(stand_upright(scene, UpAxis::pos_z), 1280, 720));
    return std::max({-low.x, -low.y, high.x, high.y});
  };
  EXPECT_GT(shown(scan), 1);
  scene::SceneOptions crop, share;
  crop.selection.crop = Bounds{{-1, -1, -1}, {90, 9, 9}};
  share.selection.crop_share = Bounds{{0, 0, 0}, {0.9, 1, 1}};
  for (const scene::SceneOptions& options : {crop, share}) {
    scene::Scene part = scan;
    scene::narrow(part, {}, options);
    EXPECT_LT(shown(part), 0.95);
    scene::narrow(part, {}, {});
    EXPECT_LT(shown(part), 0.95);
  }
}

TEST(FirstView, ATurnShowsAllFromEverySide) {
  const Pose pose = pose_of(box_of({20, 4, 3}));
  for (const bool parallel : {false, true}) {
    // From where it looks short.
    CameraRequest request;
    request.azimuth = 90;
    request.size = {320, 200};
    Camera camera = view_of(pose, request);
    if (parallel) make_orthographic(camera);
    const auto outside = [&](const Camera& start) {
      std::size_t most = 0;
      for (const Camera& side : orbit(start, dvec3(0, 0, 1), 12, 360)) {
        const dmat4 clip = side.projection_matrix() * side.view();
        std::size_t count = 0;
        for (const dvec3& p : pose.subject.points) {
          const glm::dvec4 at = clip * glm::dvec4(p, 1);
          count += std::max(std::abs(at.x), std::abs(at.y)) > at.w;
        }
        most = std::max(most, count);
      }
      return most;
    };
    EXPECT_GT(outside(camera), 1000u);
    step_back(camera, dvec3(0, 0, 1), pose.subject);
    EXPECT_EQ(outside(camera), 0u);
  }
}

TEST(FirstView, ATurnIsAboutTheMiddleOfThePlan) {
  PointCloud cloud;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> across(-5, 5);
  while (cloud.size() < 20'000) {  // a round plan, more of it on one side
    const vec3 p(across(random), across(random), 0);
    if (glm::length(p) < 5 && (p.x < 0 || cloud.size() % 4 == 0)) cloud.positions.push_back(p);
  }
  const Pose pose = pose_of(cloud);
  Camera camera = view_of(pose, {});
  step_back(camera, dvec3(0, 0, 1), pose.subject);
  for (const Camera& side : orbit(camera, dvec3(0, 0, 1), 12, 360)) {
    const auto [low, high] = slopes_of(pose.subject, side.position, side.direction(), side.up, 0);
    EXPECT_NEAR(low.x + high.x, 0, 0.02 * (high.x - low.x));
  }
}

TEST(FirstView, WhatStandsIsSeenFromItsHeightAndWhatLiesFromAbove) {
  EXPECT_NEAR(pose_of(box_of({1, 1, 2})).upright.elevation_deg, 14, 1e-9);
  EXPECT_NEAR(pose_of(box_of({8, 8, 0.5})).upright.elevation_deg, 45, 1e-9);
}

TEST(FirstView, StraysFarOffMoveNothingAndThinTopsStay) {
  PointCloud cloud = box_of({1, 1, 2});
  for (int i = 0; i < 20; ++i)
    cloud.positions.push_back(vec3(0.5f, 0.5f, 2 + 0.03f * float(i)));  // an aerial
  const Pose alone = pose_of(cloud);
  for (const vec3& stray : {vec3(300, 200, 40), vec3(0.5f, 0.5f, 5), vec3(-2, 0, 0)}) {
    PointCloud with = cloud;
    with.positions.push_back(stray);
    const Bounds box = pose_of(with).subject.box;
    EXPECT_EQ(box.min, alone.subject.box.min) << stray.x;
    EXPECT_EQ(box.max, alone.subject.box.max) << stray.x;
  }
  PointCloud two = cloud;  // a sixth of the points is no stray
  for (int i = 0; i < 4000; ++i) two.positions.push_back(vec3(0.5f, 1.6f, 0.0005f * float(i)));
  EXPECT_NEAR(pose_of(two).subject.box.max.y, 1.6, 1e-6);
}

// A wall along the diagonal, and strays in the corners of its box.
TEST(FirstView, StraysBesideWhatHangsTogetherMoveNothing) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(0, 1);
  PointCloud wall;
  wall.up = UpAxis::pos_z;
  for (int i = 0; i < 20'000; ++i) {
    const float along = 20 * unit(random);
    wall.positions.push_back({along, along, 3 * unit(random)});
  }
  PointCloud with = wall;
  for (int i = 0; i < 20; ++i) with.positions.push_back({17 + 0.1f * float(i), 1 + 0.1f * float(i), 1});
  const auto camera_of = [](const PointCloud& cloud) {
    Pose pose = pose_of(cloud);
    pose.upright.azimuth_deg = -45;
    return first_view(pose, 640, 360);
  };
  EXPECT_LT(glm::distance(camera_of(wall).position, camera_of(with).position), 0.5);
}

// Which is no stray, although the box of the rest is as large.
TEST(FirstView, TheCornerOfATileBeyondAGapIsNotCut) {
  PointCloud tile;
  tile.up = UpAxis::pos_z;
  for (int i = 0; i <= 200; ++i)
    for (int j = 0; j <= 200; ++j)
      if (i + j < 270 || i + j > 300) tile.positions.push_back({0.5f * float(i), 0.5f * float(j), 0});
  for (const double azimuth_deg : {0.0, 45.0, 90.0, 180.0, 270.0}) {
    Pose pose = pose_of(tile);
    pose.upright.azimuth_deg = azimuth_deg;
    std::vector<dvec3> points;
    for (std::size_t i = 0; i < tile.size(); ++i) points.push_back(tile.world(i));
    const auto [low, high] = extent(points, first_view(pose, 1280, 720));
    EXPECT_LT(std::max({-low.x, -low.y, high.x, high.y}), 0.93) << azimuth_deg;
  }
}

// Land and water, of which a fiftieth as much comes back: the frame of the land alone would cut it. What lies
// beyond a gap, or is much larger, stays outside.
TEST(FirstView, WhatThinsOutWithoutAGapIsNotCut) {
  std::mt19937 random(31);
  std::uniform_real_distribution<float> unit(0, 1);
  const auto tile_of = [&](int points, float first, float width) {
    PointCloud tile;
    tile.up = UpAxis::pos_z;
    for (int i = 0; i < 90'000; ++i) tile.positions.push_back({60 * unit(random), 60 * unit(random), 0});
    for (int i = 0; i < points; ++i)
      tile.positions.push_back({first + width * unit(random), 60 * unit(random), 0});
    return tile;
  };
  const auto farthest = [](const PointCloud& cloud) { return pose_of(cloud).subject.box.max.x; };
  EXPECT_NEAR(farthest(tile_of(2000, 60, 26)), 86, 0.5);
  for (const float gap : {3.0f, 6.0f})
    EXPECT_NEAR(farthest(tile_of(2000, 60 + gap, 26)), 60, 0.5) << "beyond a gap of " << gap;
  EXPECT_NEAR(farthest(tile_of(20'000, 60, 400)), 60, 5) << "much larger";
}

// A crown closes its picture far better than with the long trunk below, which is in one piece with it.
TEST(FirstView, TheTrunkBelowACrownIsNotCut) {
  std::mt19937 random(12);
  std::normal_distribution<float> normal;
  PointCloud tree;
  for (int i = 0; i < 12'000; ++i) {
    const vec3 way(normal(random), normal(random), normal(random));
    tree.positions.push_back(vec3(0, 0, 60) + 1.5f * std::cbrt(float(i) / 12'000) * glm::normalize(way));
  }
  for (int i = 0; i < 8000; ++i)
    tree.positions.push_back({0.02f * normal(random), 0.02f * normal(random), 58.2f / 8000 * float(i)});
  EXPECT_LT(pose_of(tree).subject.box.min.z, 1);
}

// Twigs at the top of a tree are few and loose, but not far.
TEST(FirstView, TheTopOfATreeIsNotCut) {
  std::mt19937 random(5);
  std::normal_distribution<float> normal;
  PointCloud tree;
  for (int i = 0; i < 10'000; ++i)
    tree.positions.push_back({0.1f * normal(random), 0.1f * normal(random), 20 / 10'000.f * float(i)});
  for (int i = 0; i < 10'000; ++i)
    tree.positions.push_back({normal(random), normal(random), 18 + 1.2f * normal(random)});
  for (int i = 0; i < 1000; ++i) {
    const float above = float(i % 6 + 1);
    tree.positions.push_back(vec3(0.2f * above, 0, 22 + 0.7f * above) +
                             0.1f * vec3(normal(random), normal(random), normal(random)));
  }
  EXPECT_GT(pose_of(tree).subject.box.max.z, 26);
}

/// The share of a picture of 16 to 9 in 32 x 18 cells that hold a point.
double filled(const Pose& pose) {
  const Camera camera = first_view(pose, 1280, 720);
  const dmat4 clip = camera.projection_matrix() * camera.view();
  std::set<int> cells;
  for (const dvec3& point : pose.subject.points) {
    const glm::dvec4 c = clip * glm::dvec4(point, 1);
    cells.insert(int((c.x / c.w + 1) * 16) * 18 + int((c.y / c.w + 1) * 9));
  }
  return double(cells.size()) / (32 * 18);
}

TEST(FirstView, LandIsSeenFromWhereItFillsThePicture) {
  for (const dvec3& size : {dvec3(12, 2, 0.2), dvec3(2, 12, 0.2), dvec3(8, 8, 0.2)}) {
    PointCloud wedge = box_of(size);
    std::erase_if(wedge.positions, [&](const vec3& p) { return p.x / size.x + p.y / size.y > 1.05; });
    Pose pose = pose_of(wedge);
    const double chosen = filled(pose);
    double most = 0;
    for (double azimuth : {-150, -120, -60, -30, 30, 60, 120, 150})
      pose.upright.azimuth_deg = azimuth, most = std::max(most, filled(pose));
    EXPECT_GT(chosen, 0.85 * most) << size.x << " by " << size.y;
  }
}

// Far returns do not make the street a strip; what is connected to it is in the frame.
TEST(FirstView, OfASweepTheConnectedPartIsFramed) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(0, 1);
  PointCloud sweep;
  sweep.up = UpAxis::pos_z;
  for (int ring = 0; ring < 48; ++ring)  // 1.7 m above the ground
    for (int i = 0; i < 1500; ++i) {
      const double r = 1.7 / std::tan(glm::radians(1 + 0.5 * ring)), angle = 2 * M_PI * i / 1500;
      sweep.positions.push_back(vec3(r * std::cos(angle), r * std::sin(angle), 0));
    }
  for (int i = 0; i < 3000; ++i) {  // here and there a trunk
    const double r = 100 + 50 * unit(random), angle = 0.1 * std::floor(10 * unit(random));
    sweep.positions.push_back(vec3(r * std::cos(angle), r * std::sin(angle), 8 * unit(random)));
  }
  const Subject subject = pose_of(sweep).subject;
  EXPECT_LT(subject.box.size().x, 120) << "of 250";
  EXPECT_GT(subject_of(sweep, true).box.size().x, 200) << "the whole";
  EXPECT_GT(subject.points.size(), 5000u);
  const PointCloud tile = box_of({50, 50, 1});
  EXPECT_GT(pose_of(tile).subject.box.size().x, 49.9);
}

// The scanner saw little of a crown's top, which is one with the rest for whoever looks.
TEST(FirstView, ASparseTopIsFramedWithItsTree) {
  std::mt19937 random(6);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (const float gap : {0.4f, 4.0f}) {
    PointCloud tree;
    tree.up = UpAxis::pos_z;
    for (int i = 0; i < 60'000; ++i) {
      const float z = 11 * (1 + unit(random)), width = 0.3f + 0.1f * (22 - z);
      tree.positions.push_back({width * unit(random), width * unit(random), z});
    }
    for (int tuft = 0; tuft < 15; ++tuft)  // of a fiftieth of the points
      for (int i = 0; i < 80; ++i)
        tree.positions.push_back(vec3(0.1f * unit(random), 0.1f * unit(random),
                                      22 + gap + (0.2f + gap) * float(tuft) + 0.1f * unit(random)));
    const double height = pose_of(tree).subject.box.size().z;
    if (gap < 1)
      EXPECT_GT(height, 30) << "of 31";
    else
      EXPECT_LT(height, 22.1) << "of 89";
  }
}

/// What a lidar of 64 lines, 1.73 m above a street along x, measures in a turn, `fov_deg` of it: ground,
/// walls 8 m to both sides, 6 m high, and a car 8 m ahead. About `sensor`, turned about it.
PointCloud street_sweep(const dvec3& sensor, double turned_deg, double fov_deg, double noise = 0.01) {
  std::mt19937 random(5);
  std::normal_distribution<double> error(0, noise);
  PointCloud cloud;
  cloud.up = UpAxis::pos_z;
  cloud.origin = sensor;
  const dmat4 turn = glm::rotate(dmat4(1), glm::radians(turned_deg), dvec3(0, 0, 1));
  for (int line = 0; line < 64; ++line)
    for (double azimuth_deg = -fov_deg / 2; azimuth_deg < fov_deg / 2; azimuth_deg += 0.2) {
      const double elevation = glm::radians(2 - 26.8 * line / 63), azimuth = glm::radians(azimuth_deg);
      const dvec3 way(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                      std::sin(elevation));
      double range = way.z < 0 ? -1.73 / way.z : 1e9;
      const double to_wall = 8 / std::max(std::abs(way.y), 1e-9);
      if (to_wall * way.z < 6 - 1.73) range = std::min(range, to_wall);
      const dvec3 low(6, -3, -1.73), high(10, -1, -0.23), a = low / way, b = high / way;  // the car
      const dvec3 in = glm::min(a, b), out = glm::max(a, b);
      const double enter = std::max({in.x, in.y, in.z}), leave = std::min({out.x, out.y, out.z});
      if (enter > 0 && enter < leave) range = std::min(range, enter);
      if (range < 80)
        cloud.positions.push_back(vec3(dvec3(turn * glm::dvec4(way, 0)) * (range + error(random))));
    }
  return cloud;
}

/// The share of the points on the page, and of the page's cells those that hold one.
std::pair<double, double> page_of(const PointCloud& cloud, const Camera& camera) {
  constexpr int columns = 40, rows = 20;
  const dmat4 clip = camera.projection_matrix() * camera.view();
  std::set<int> cells;
  double on = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const glm::dvec4 c = clip * glm::dvec4(cloud.world(i), 1);
    if (c.w <= 0 || std::max(std::abs(c.x), std::abs(c.y)) >= c.w) continue;
    ++on;
    cells.insert(int((c.y / c.w + 1) * rows / 2) * columns + int((c.x / c.w + 1) * columns / 2));
  }
  return {on / double(cloud.size()), double(cells.size()) / (columns * rows)};
}

TEST(FirstView, OfASweepWhatIsNearTheSensorFillsThePage) {
  struct Case {
    dvec3 sensor;
    double turned_deg, fov_deg;
    bool is_recorded;
  };
  for (const auto& [sensor, turned_deg, fov_deg, is_recorded] : {Case{dvec3(0), 0, 360, false},
                                                                 {dvec3(0), 33, 360, false},
                                                                 {dvec3(0), 33, 360, true},
                                                                 {dvec3(500, -70, 3), 33, 360, true},
                                                                 {dvec3(0), 33, 90, true},
                                                                 {dvec3(0), 200, 90, false}}) {
    PointCloud cloud = street_sweep(sensor, turned_deg, fov_deg);
    if (is_recorded) cloud.scanners.push_back(sensor);
    Pose pose = pose_of(cloud);
    const Camera camera = first_view(pose, 1280, 720);
    const auto [on, filled] = page_of(cloud, camera);
    // Far points are few and wide apart: a frame that is twice as wide would add less than a seventh.
    EXPECT_GT(on, 0.87) << fov_deg;
    EXPECT_GT(camera.position.z, sensor.z + 1) << "above the sensor";
    std::vector<double> heights;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const glm::dvec4 c = camera.projection_matrix() * camera.view() * glm::dvec4(cloud.world(i), 1);
      heights.push_back(c.y / c.w);
    }
    std::sort(heights.begin(), heights.end());
    EXPECT_GT(heights[heights.size() * 98 / 100] - heights[heights.size() / 50], 1.2)
        << "of 2: seen from the sensor, 90 degrees are 0.9 high";
    const dmat4 turn = glm::rotate(dmat4(1), glm::radians(turned_deg), dvec3(0, 0, 1));
    std::vector<dvec3> car;
    for (const dvec3& corner : {dvec3(6, -3, -1.73), dvec3(10, -1, -1.73), dvec3(10, -3, -0.23)})
      car.push_back(sensor + dvec3(turn * glm::dvec4(corner, 1)));
    const auto [low, high] = extent(car, camera);
    EXPECT_LT(std::max({high.x, high.y, -low.x, -low.y}), 1) << "the car is on the page";

    pose.around.reset();
    const Camera whole = first_view(pose, 1280, 720);
    if (fov_deg == 360) {
      const auto [low_before, high_before] = extent(car, whole);
      EXPECT_GT((high.x - low.x) * (high.y - low.y),
                1.5 * (high_before.x - low_before.x) * (high_before.y - low_before.y));
      EXPECT_GT(filled, 1.3 * page_of(cloud, whole).second);
    }
    CameraRequest request;
    request.azimuth = 60;
    EXPECT_GT(page_of(cloud, view_of(pose, request)).first, 0.95)
        << "who chooses a side sees all that is framed";
  }
}

TEST(FirstView, HeightsAreThoseOfWhatIsFramed) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> unit(0, 1);
  PointCloud land = box_of({50, 50, 4});
  EXPECT_TRUE(shown_heights(pose_of(land)).empty()) << "of all";
  for (std::size_t i = land.size() / 12; i > 0; --i)
    land.positions.push_back({900 + unit(random), unit(random), -200 + unit(random)});
  const std::vector<double> heights = shown_heights(pose_of(land));
  ASSERT_GT(heights.size(), 100u);
  EXPECT_GT(*std::min_element(heights.begin(), heights.end()), -1);
  EXPECT_GT(*std::max_element(heights.begin(), heights.end()), 3.5);
  PointCloud sweep = street_sweep(dvec3(0), 0, 360);
  const Pose pose = pose_of(sweep);
  ASSERT_TRUE(pose.around);
  for (std::size_t i = sweep.size() / 100; i > 0; --i)  // of a tower far off
    sweep.positions.push_back({300, unit(random), 40 + 10 * unit(random)});
  const std::vector<double> of_street = shown_heights(pose_of(sweep));
  EXPECT_GT(of_street.size(), 1000u);
  EXPECT_LT(*std::max_element(of_street.begin(), of_street.end()), 6);
}

// 2 % of the points behind the walls of the street: a page that is fitted to them is empty below.
TEST(FirstView, FewPointsAtTheRimOfASweepTakeNoPartOfThePage) {
  for (const double turned_deg : {0.0, 33.0, 140.0}) {
    PointCloud cloud = street_sweep(dvec3(0), turned_deg, 360);
    std::mt19937 random(9);
    std::uniform_real_distribution<double> along(-40, 40), aside(9, 40), height(-1.7, 1);
    const dmat4 turn = glm::rotate(dmat4(1), glm::radians(turned_deg), dvec3(0, 0, 1));
    for (std::size_t i = cloud.size() / 50; i > 0; --i)
      cloud.positions.push_back(
          vec3(turn * glm::dvec4(along(random), (i % 2 ? 1 : -1) * aside(random), height(random), 0)));
    Pose pose = pose_of(cloud);
    ASSERT_TRUE(pose.around);
    const auto [on, cells] = page_of(cloud, first_view(pose, 1280, 720));
    pose.around->move = dvec3(0);
    const auto [fitted_on, fitted_cells] = page_of(cloud, first_view(pose, 1280, 720));
    EXPECT_GT(on, fitted_on) << turned_deg;
    EXPECT_GT(cells, 1.02 * fitted_cells) << turned_deg << ": 5, 7 and 3 %";
    const Pose moved = pose_of(cloud);
    for (const auto& [across, down] : {std::pair(720, 1280), {1024, 1024}, {2400, 600}})
      EXPECT_GT(page_of(cloud, first_view(moved, across, down)).first,
                page_of(cloud, first_view(pose, across, down)).first - 0.03)
          << across << "x" << down;
  }
}

TEST(FirstView, WhatIsNoSweepIsFramedAsAWhole) {
  std::mt19937 random(8);
  std::uniform_real_distribution<float> unit(-1, 1);
  PointCloud tile = box_of({50, 50, 1}), grid = tile, shell = box_of({4, 5, 2.4}), displaced;
  grid.positions.clear();
  for (int i = -60; i < 60; ++i)
    for (int j = -60; j < 60; ++j) grid.positions.emplace_back(i, j, 0.3f * unit(random));
  for (vec3& p : tile.positions) p -= vec3(25, 25, 0.5f);
  for (vec3& p : shell.positions) p -= vec3(2, 2.5f, 1.2f);
  displaced = street_sweep(dvec3(0), 0, 360);
  for (vec3& p : displaced.positions) p += vec3(6, 2, 0);  // the origin is another place's
  for (PointCloud cloud : {tile, grid, shell, displaced}) {
    EXPECT_FALSE(pose_of(cloud).around) << cloud.size();
    cloud.scanners.assign(1, dvec3(0));
    EXPECT_FALSE(pose_of(cloud).around) << cloud.size() << ", though the file says so";
  }
  scene::Scene whole;
  whole.cloud = street_sweep(dvec3(0), 0, 360);
  EXPECT_TRUE(pose_of(whole.cloud).around);
  EXPECT_FALSE(stand_upright(whole, UpAxis::pos_z, false).around) << "--whole";
}

TEST(FirstView, ASweepIsSeenFromTheSameSideInAnyOrderOfItsPoints) {
  PointCloud cloud = street_sweep(dvec3(0), 0, 120);
  cloud.scanners.assign(1, dvec3(0));
  ASSERT_TRUE(pose_of(cloud).around);
  ASSERT_LT(cloud.size(), 50'000u) << "all of which the view is made for";
  const Camera camera = first_view(pose_of(cloud), 1280, 720);
  std::mt19937 random(8);
  std::shuffle(cloud.positions.begin(), cloud.positions.end(), random);
  const Camera shuffled = first_view(pose_of(cloud), 1280, 720);
  constexpr double rounding = 1e-4;  // m, of sums in another order; another candidate is metres away
  EXPECT_LT(glm::distance(camera.position, shuffled.position), rounding);
  EXPECT_LT(glm::distance(camera.target, shuffled.target), rounding);
}

// From the sensor nothing gapes that was hidden from it.
TEST(FirstView, DepthPicturesAreSeenFromTheirSensor) {
  struct Case {
    dvec3 sensor;
    double aside, turned_deg, step;  // of the rays to a side: 26 or 50 degrees
  };
  for (const auto& [sensor, aside, turned_deg, step] : {Case{dvec3(0), 0, 0, 0.004},
                                                        {dvec3(0), 0.3, 0, 0.004},
                                                        {dvec3(2, -7, 3), 0, 0, 0.004},
                                                        {dvec3(2, -7, 3), 0.3, 0, 0.004},
                                                        {dvec3(0), 0, -100, 0.004},
                                                        {dvec3(0), 0, -100, 0.01},
                                                        {dvec3(2, -7, 3), 0, 0, 0.01}}) {
    scene::Scene scene;
    PointCloud& cloud = scene.cloud;
    const dmat4 turn = glm::rotate(dmat4(1), glm::radians(turned_deg), dvec3(0, 0, 1));
    for (int i = -120; i <= 120; ++i)
      for (int j = -90; j <= 90; ++j) {  // a box before a wall, looked at along x
        const dvec3 ray(1, step * i + aside, 0.004 * j);
        const bool is_box = std::abs(ray.y - aside) < 0.2 && std::abs(ray.z) < 0.15;
        cloud.positions.push_back(vec3(sensor + dvec3(turn * glm::dvec4(ray, 0)) * (is_box ? 1.5 : 3.0)));
      }
    if (sensor != dvec3(0)) cloud.scanners.push_back(sensor);
    const Pose pose = stand_upright(scene, UpAxis::pos_z);
    const Camera camera = first_view(pose, 1280, 720);
    EXPECT_LT(glm::distance(camera.position, sensor), 1e-9) << aside << " " << turned_deg << " " << step;
    const auto [low, high] = extent(pose.subject.points, camera);
    if (aside == 0) EXPECT_NEAR(std::max(high.x, high.y), 0.92, 0.01);
    EXPECT_GT(std::max(high.x, high.y), 0.91);
    EXPECT_LT(std::max(high.x, high.y), 1) << "also the corners of what is seen aslant";
    EXPECT_NEAR(low.x, -high.x, 0.01);
    CameraRequest request;
    request.azimuth = 60;
    EXPECT_GT(glm::distance(view_of(pose, request).position, sensor), 1);
    // A ray in a hundred, far to a side: the rest is as large as before.
    for (int i = 0; i < 300; ++i)
      cloud.positions.push_back(
          vec3(sensor + dvec3(turn * glm::dvec4(1 + 0.001 * i, 6, 0.001 * (i - 150), 0)) * 0.5));
    const Camera with = first_view(stand_upright(scene, UpAxis::pos_z), 1280, 720);
    EXPECT_LT(glm::distance(with.position, sensor), 1e-9);
    EXPECT_LT(with.fov_y, camera.fov_y * 1.15);
    EXPECT_GT(glm::dot(with.direction(), camera.direction()), std::cos(glm::radians(3.0)));
  }
}

// However far a little of it is to one side: rays at 53 degrees from the axis are 80 from those opposite.
TEST(FirstView, AWideReconstructionIsInTheMiddleOfItsPicture) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  scene::Scene scene;
  for (int i = 0; i < 20'000; ++i) {
    const double aside = -0.5 + 1.2 * unit(random), depth = 3 + 2 * unit(random);
    const double down = unit(random) < 0.97 ? -0.6 + 1.3 * unit(random) : -1.33 + 0.73 * unit(random);
    scene.cloud.positions.push_back(vec3(depth * dvec3(aside, down, 1)));
  }
  scene.cloud.colors.assign(scene.cloud.size(), Rgba8{90, 120, 60, 255});
  const Pose pose = stand_upright(scene, UpAxis::neg_y);
  const Camera camera = first_view(pose, 1280, 720);
  ASSERT_LT(glm::length(camera.position), 1e-9);
  const auto [low, high] = extent(pose.subject.points, camera);
  EXPECT_NEAR(low.y, -high.y, 0.05);
  EXPECT_NEAR(high.y, 0.92, 0.05);
  EXPECT_NEAR(low.x, -high.x, 0.05);
}

// Of what one station sees, ground and a wall, the top of a stem before them has fewer points than one in a
// hundred.
TEST(FirstView, ASensorsPictureHoldsThinTops) {
  constexpr int on_stem = 180;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  scene::Scene scene;
  scene.cloud.scanners.emplace_back(0, 0, 1.5);
  for (int i = 0; i < 20'000; ++i) {
    const double turn = glm::radians(-25 + 50 * unit(random)),
                 down = std::tan(glm::radians(8 + 14 * unit(random)));
    const dvec3 along(std::sin(turn), std::cos(turn), 0);
    scene.cloud.positions.push_back(
        vec3(i % 2 == 0 ? 1.5 / down * along : 12.0 * along + dvec3(0, 0, 3 * unit(random))));
  }
  std::vector<dvec3> stem;
  for (int i = 0; i < on_stem; ++i) stem.emplace_back(0.1 * unit(random), 9, 4.5 * i / on_stem);
  for (const dvec3& p : stem) scene.cloud.positions.push_back(vec3(p));
  const Camera camera = first_view(stand_upright(scene, UpAxis::pos_z), 1280, 720);
  ASSERT_LT(glm::distance(camera.position, dvec3(0, 0, 1.5)), 1e-9);
  const double top = -extent(stem, camera).first.y;  // y points down
  EXPECT_LT(top, 0.95);
  EXPECT_GT(top, 0.5) << "and the page is not much larger";
}

// As of stereo, whose depths are noise where nothing matches: seen from a side it is a fan of rays.
TEST(FirstView, APictureOfPixelsIsSeenFromItsSensorHoweverNoisyItsDepths) {
  std::mt19937 random(12);
  std::uniform_real_distribution<double> depth(1, 8);
  for (const bool on_pixels : {true, false}) {
    std::uniform_real_distribution<double> aside(-0.5, on_pixels ? -0.5 : 0.5);
    scene::Scene scene;
    for (int i = -160; i < 160; ++i)
      for (int j = -90; j < 90; ++j)
        scene.cloud.positions.push_back(
            vec3(depth(random) * dvec3(0.004 * (i + aside(random)), 0.004 * (j + aside(random)), -1)));
    const Camera camera = first_view(stand_upright(scene, UpAxis::pos_y), 1280, 720);
    EXPECT_EQ(glm::length(camera.position) < 1e-9, on_pixels) << camera.position.z;
  }
}

// The first camera saw what many reconstructed.
TEST(FirstView, WhatPhotographsReconstructedIsSeenFromTheFirst) {
  for (const bool is_colored : {true, false}) {
    scene::Scene scene;
    scene.cloud = box_of({2, 2, 2});
    for (vec3& p : scene.cloud.positions) p += vec3(-0.8f, -1.3f, 5);
    if (is_colored) scene.cloud.colors.assign(scene.cloud.size(), Rgba8{90, 120, 60, 255});
    const Camera camera = first_view(stand_upright(scene, UpAxis::neg_y), 1280, 720);
    EXPECT_EQ(glm::length(camera.position) < 1e-9, is_colored) << camera.position.z;
  }
}

/// A square of ground and a block on it, in axes with y down that are turned by 25 degrees against it.
PointCloud tilted_block(const dvec3& up) {
  std::mt19937 random(13);
  std::uniform_real_distribution<double> unit(-1, 1);
  const dvec3 right = glm::normalize(glm::cross(up, dvec3(0, 0, 1))), ahead = glm::cross(right, up);
  PointCloud cloud;
  cloud.up = UpAxis::neg_y;
  const auto add = [&](const dvec3& p) {
    cloud.positions.push_back(vec3(p.x * right + p.y * ahead + p.z * up));
  };
  for (int i = 0; i < 30'000; ++i) {
    if (i % 2) add({6 * unit(random), 6 * unit(random), 0});
    dvec3 side(unit(random), unit(random), unit(random));
    side[i % 3] = i % 3 == 2 || i % 2 ? 1 : -1;
    add(side * dvec3(1, 2, 1.5) + dvec3(0, 0, 1.5));
  }
  return cloud;
}

// What a picture shows of the block's edges is as plumb as the camera: their slopes come from where they are.
TEST(FirstView, TiltedGroundIsLevelInIt) {
  const double tilt = glm::radians(25.0);
  const dvec3 up(std::sin(tilt), -std::cos(tilt), 0);
  scene::Scene scene;
  scene.cloud = tilted_block(up);
  const Pose pose = stand_upright(scene);
  EXPECT_EQ(pose.upright.up, UpAxis::neg_y);
  const auto leans = [&](const Camera& camera) {  // degrees
    const dvec3 seen = glm::dmat3(camera.view()) * up;
    return glm::degrees(std::atan2(seen.x, seen.y));
  };
  const Camera camera = view_of(pose, {});
  EXPECT_NEAR(leans(camera), 0, 3);  // a plane of three points within 1 % of the diagonal
  EXPECT_LT(glm::distance(first_view(pose, 1280, 720).position, camera.position), 1e-9);
  const auto [low, high] = extent(pose.subject.points, camera);
  EXPECT_NEAR(std::max(high.x, high.y), 0.92, 0.01);
  EXPECT_GT(glm::dot(-camera.direction(), up), 0.2) << "from above the ground";
  // Who names a side names it about the axis.
  CameraRequest request;
  request.azimuth = 0, request.elevation = 0;
  EXPECT_NEAR(std::abs(leans(view_of(pose, request))), 25, 1);
  EXPECT_EQ(view_of(pose, request).up, dvec3(0, -1, 0));
  EXPECT_EQ(stand_upright(scene, UpAxis::neg_y).vertical(), dvec3(0, -1, 0)) << "--up";
  // The pictures beside a model of COLMAP say only which axis is nearest; other files mean what they say.
  scene.cloud.set_up(UpAxis::neg_y);
  EXPECT_EQ(stand_upright(scene).vertical(), dvec3(0, -1, 0));
  scene.cloud.provenance = Provenance::photographs;
  EXPECT_GT(glm::dot(stand_upright(scene).vertical(), up), std::cos(glm::radians(3.0)));
}

TEST(FirstView, AShortTurnBringsOneDirectionToAnother) {
  const dvec3 from = glm::normalize(dvec3(1, 2, -2)), to = glm::normalize(dvec3(2, 1, 1));
  const glm::dmat3 turn = turn_between(from, to);
  EXPECT_LT(glm::distance(turn * from, to), 1e-12);
  const dvec3 still = glm::cross(from, to);
  EXPECT_LT(glm::distance(turn * still, still), 1e-12);
  EXPECT_NEAR(glm::determinant(turn), 1, 1e-12);
}

TEST(FirstView, TheOriginOfAMapIsNoSensor) {
  PointCloud wall = box_of({8, 0.02, 5});
  wall.normals.assign(wall.positions.size(), vec3(0, -1, 0));
  wall.origin = {500'000, 5'000'000, 100};
  const Camera camera = first_view(pose_of(wall), 1280, 720);
  EXPECT_LT(glm::distance(camera.position, wall.origin), 100);
}

TEST(FirstView, WhatFacesOneSideIsSeenFromThere) {
  for (const double turned_deg : {0.0, 90.0, 140.0, 250.0}) {
    PointCloud wall = box_of({8, 0.02, 5});
    const dmat4 turn = glm::rotate(dmat4(1), glm::radians(turned_deg), dvec3(0, 0, 1));
    const dvec3 front(turn * glm::dvec4(0, -1, 0, 0));
    for (vec3& p : wall.positions) p = vec3(turn * glm::dvec4(p, 1));
    wall.normals.assign(wall.positions.size(), vec3(front));
    const Camera camera = first_view(pose_of(wall), 1280, 720);
    EXPECT_GT(glm::dot(-camera.direction(), front), 0.8) << turned_deg;
  }
}

// The back of a head is smooth.
TEST(FirstView, AFaceIsSeenNotTheBackOfTheHead) {
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  for (const double face_deg : {90.0, 170.0, 260.0}) {
    PointCloud head;
    const dvec3 face(std::cos(glm::radians(face_deg)), std::sin(glm::radians(face_deg)), 0);
    const dvec3 aside(-face.y, face.x, 0);
    const auto bump = [&](const dvec3& way, double x, double z, double wide) {
      const double a = glm::dot(way, aside) - x, b = way.z - z;
      return glm::dot(way, face) > 0 ? std::exp(-(a * a + b * b) / (wide * wide)) : 0;
    };
    for (int i = 0; i < 60'000; ++i) {
      const dvec3 way = glm::normalize(dvec3(normal(random), normal(random), normal(random)));
      const double relief = 0.25 * bump(way, 0, -0.1, 0.15) - 0.12 * bump(way, 0.3, 0.2, 0.12) -
                            0.12 * bump(way, -0.3, 0.2, 0.12) + 0.06 * bump(way, 0, -0.5, 0.15);
      head.positions.push_back(vec3(way * dvec3(1, 1, 1.4) * (1 + relief)));
    }
    const dvec3 from = -first_view(pose_of(head), 1280, 720).direction();
    EXPECT_GT(glm::dot(from, face), 0.6) << face_deg;
  }
  EXPECT_NEAR(pose_of(box_of({1, 1, 2})).upright.azimuth_deg, -30, 1e-9) << "alike on all sides";
}

// A face as a mask, open behind: nobody looks at it from inside.
TEST(FirstView, AnOpenSurfaceIsSeenFromOutside) {
  std::mt19937 random(8);
  std::normal_distribution<double> normal;
  PointCloud mask;
  for (int i = 0; i < 40'000; ++i) {
    dvec3 way = glm::normalize(dvec3(normal(random), normal(random), normal(random)));
    if (way.y < -0.1) continue;  // beyond the temples
    mask.positions.push_back(vec3(way * dvec3(1, 1.2, 1.4)));
    mask.normals.push_back(vec3(glm::normalize(way / dvec3(1, 1.2, 1.4))));
  }
  EXPECT_GT(-first_view(pose_of(mask), 1280, 720).direction().y, 0.8);
}

TEST(FirstView, CornersOfTheGroundAroundATowerAreNotCut) {
  // Nearly all points crowd on the tower, as around a scanner, but the ground ends soon.
  PointCloud cloud = box_of({5, 5, 20}, 20'000);
  for (const vec3& p : box_of({40, 40, 0}, 10'000).positions)
    cloud.positions.push_back(p - vec3(17.5f, 17.5f, 0));
  const Pose pose = pose_of(cloud);

  const auto [low, high] = extent({{-17.4, -17.4, 0}, {22.4, -17.4, 0}, {22.4, 22.4, 0}, {-17.4, 22.4, 0}},
                                  first_view(pose, 1280, 720));
  EXPECT_LT(std::max({high.x, high.y, -low.x, -low.y}), 1);
}

/// What one scanner of equal angles sees, 1.7 m above level ground at `x`, 0: ground, and at `distance` along
/// y a wall of `nave` (width and height) and of a tower beside it, of `tower`.
PointCloud station(int steps, double distance, const glm::dvec2& nave, const glm::dvec2& tower,
                   double x = 0) {
  PointCloud cloud;
  cloud.up = UpAxis::pos_z;
  for (int i = 0; i < steps; ++i)
    for (int j = 0; j < steps * 2 / 5; ++j) {
      const double azimuth = 2 * M_PI * i / steps, elevation = glm::radians(-60 + 350.0 * j / steps);
      const dvec3 way(std::cos(elevation) * std::sin(azimuth), std::cos(elevation) * std::cos(azimuth),
                      std::sin(elevation));
      const double to_ground = way.z < 0 ? -1.7 / way.z : 1e9, to_wall = way.y > 0 ? distance / way.y : 1e9;
      const dvec3 scanner(x, 0, 1.7), wall = scanner + to_wall * way;
      const bool is_nave = wall.z < nave.y && std::abs(wall.x) < nave.x / 2,
                 is_tower = wall.z < tower.y && std::abs(wall.x + (nave.x + tower.x) / 2) < tower.x / 2;
      if (to_wall < to_ground && (is_nave || is_tower))
        cloud.positions.push_back(vec3(wall));
      else if (to_ground < 90)
        cloud.positions.push_back(vec3(scanner + to_ground * way));
    }
  return cloud;
}

TEST(FirstView, ATowerBeforeWhichTheScannerStandsIsNotCut) {
  // Most points lie beside the two stations, and some 90 m away.
  PointCloud cloud = station(2000, 14, {30, 10}, {6, 40}, -6);
  append(cloud, station(2000, 14, {30, 10}, {6, 40}, 20));
  ASSERT_LT(robust_bounds(cloud).max.z, 20) << "by points the tower is cut";
  const Pose pose = pose_of(cloud);

  EXPECT_GT(pose.subject.box.max.z, 39);
  const auto [low, high] =
      extent({{-21, 14, 39.5}, {-15, 14, 39.5}, {15, 14, 9}, {-21, 14, 0}}, first_view(pose, 1280, 720));
  EXPECT_LT(std::max({high.x, high.y, -low.x, -low.y}), 0.96) << "with headroom";
  EXPECT_LT(pose.subject.box.size().x, 100) << "of 180: the last rings are lines";
  EXPECT_GT(subject_of(cloud, true).box.size().x, 150) << "the whole";
}

TEST(FirstView, OfOneSparseStationTheTowerBeforeItIsNotCut) {
  for (const int steps : {300, 700}) {
    const PointCloud cloud = station(steps, 14, {30, 10}, {8, 40});
    const Pose pose = pose_of(cloud);

    const auto [low, high] =
        extent({{-23, 14, 39}, {-15, 14, 39}, {15, 14, 9}, {-23, 14, 0}}, first_view(pose, 1280, 720));
    EXPECT_LT(std::max({high.x, high.y, -low.x, -low.y}), 1) << steps;
    // Walls along a street are what the scanner happened to meet.
  }
}

TEST(FirstView, ARoomWithoutCeilingIsLookedIntoFromAbove) {
  // As telephones scan them: floor and walls, seen from both sides.
  std::mt19937 random(6);
  std::uniform_real_distribution<float> unit(0, 1);
  PointCloud cloud;
  cloud.up = UpAxis::pos_z;
  for (int i = 0; i < 60'000; ++i) {
    const float a = unit(random), b = unit(random);
    const vec3 sides[] = {{4 * a, 5 * b, 0},    {4 * a, 0, 2.4f * b}, {4 * a, 5, 2.4f * b},
                          {0, 5 * a, 2.4f * b}, {4, 5 * a, 2.4f * b}, {1 + a, 1 + b, 0.5f}};
    cloud.positions.push_back(sides[i % 6]);
  }
  const Pose room = pose_of(cloud);
  EXPECT_FALSE(room.subject.room);
  EXPECT_GT(room.upright.elevation_deg, 40);
  EXPECT_LT(pose_of(box_of({4, 5, 2.4})).upright.elevation_deg, 33)
      << "a closed box shows no more from above";
}

PointCloud scan(const std::string& scene, synth::Sampling sampling, int points) {
  synth::SampleOptions options;
  options.points = points;
  options.sampling = sampling;
  return synth::sample(synth::make_scene(scene), options);
}

TEST(FirstView, RoomsAreSeenThroughTheWallsBeforeThem) {
  for (synth::Sampling sampling : {synth::Sampling::area, synth::Sampling::cameras})
    for (double turn : {0.0, 33.0}) {
      PointCloud cloud = scan("room", sampling, 200'000);
      const dmat4 turned = glm::rotate(dmat4(1), glm::radians(turn), dvec3(0, 0, 1));
      for (vec3& p : cloud.positions) p = vec3(turned * glm::dvec4(p, 1));
      const Pose pose = pose_of(cloud);
      ASSERT_TRUE(pose.subject.room) << int(sampling);
      const Camera camera = first_view(pose, 1280, 720);
      const Cut cut = cut_before(*pose.subject.room, camera);
      EXPECT_TRUE(cut.ceiling);
      EXPECT_GE(cut.walls.size(), 1u);
      // What is left out is the shell: most of the scan is still there, and the floor in the middle is not
      // hidden.
      const auto drawn = std::count_if(pose.subject.points.begin(), pose.subject.points.end(),
                                       [&](const dvec3& p) { return !is_cut(cut, p); });
      EXPECT_GT(double(drawn), 0.4 * double(pose.subject.points.size()));
      EXPECT_LT(double(drawn), 0.9 * double(pose.subject.points.size()));
      Camera inside = camera;
      inside.position = pose.subject.box.center();
      EXPECT_TRUE(cut_before(*pose.subject.room, inside).empty());
    }
}

TEST(FirstView, BehindAnInnerWallTheScanGoesOn) {
  // A hall of 16 x 6 m, and a corridor of 6 x 2 m that leads on beside its end wall.
  std::mt19937 random(9);
  std::uniform_real_distribution<double> unit(0, 1);
  struct Face {
    dvec3 corner, u, v;
  };
  std::vector<Face> faces = {{{0, 0, 0}, {0, 6, 0}, {0, 0, 3}},   {{0, 0, 0}, {22, 0, 0}, {0, 0, 3}},
                             {{0, 6, 0}, {16, 0, 0}, {0, 0, 3}},  {{16, 2, 0}, {0, 4, 0}, {0, 0, 3}},
                             {{16, 2, 0}, {6, 0, 0}, {0, 0, 3}},  {{22, 0, 0}, {0, 2, 0}, {0, 0, 3}},
                             {{4, 2, 0.8}, {4, 0, 0}, {0, 2, 0}}, {{4, 2, 0}, {4, 0, 0}, {0, 0, 0.8}}};
  for (double z : {0.0, 3.0})
    faces.push_back({{0, 0, z}, {16, 0, 0}, {0, 6, 0}}), faces.push_back({{16, 0, z}, {6, 0, 0}, {0, 2, 0}});
  PointCloud cloud;
  for (const Face& face : faces)
    for (int i = 0; i < 600 * glm::length(face.u) * glm::length(face.v); ++i)
      cloud.positions.push_back(vec3(face.corner + unit(random) * face.u + unit(random) * face.v));
  const Pose pose = pose_of(cloud);
  ASSERT_TRUE(pose.subject.room);
  const Cut sides{pose.subject.room->outside};
  EXPECT_GE(sides.walls.size(), 2u);
  for (double x = 17; x < 21; x += 0.5) EXPECT_FALSE(is_cut(sides, {x, 1, 0.1})) << x;
}

// Of noisy ground the upper half may look like a ceiling, but nothing is hidden below.
TEST(FirstView, ACutawayThatShowsNoMoreIsNone) {
  for (const double high : {0.02, 0.6}) {
    Pose body = pose_of(box_of({2, 2, high}, 60'000));
    body.subject.room = Room{{{0, 0, 1, -0.9 * high}}};
    standpoint_for(body.subject, UpAxis::pos_z);
    EXPECT_EQ(body.subject.room.has_value(), high > 0.1);
  }
}

TEST(FirstView, WhatIsNoRoomKeepsItsWalls) {
  for (const char* name : {"courtyard", "forest", "spheres", "tori"})
    EXPECT_FALSE(pose_of(scan(name, synth::Sampling::automatic, 200'000)).subject.room) << name;
  EXPECT_FALSE(pose_of(box_of({2, 3, 1}, 100'000)).subject.room) << "a box that holds nothing";
  // Crowns of one height, two metres thick, over level ground with bushes.
  std::mt19937 random(8);
  std::uniform_real_distribution<double> unit(0, 1);
  PointCloud planted;
  planted.up = UpAxis::pos_z;
  for (int i = 0; i < 200'000; ++i) {
    const double which = unit(random), z = which < 0.6    ? 10 - 2 * unit(random)
                                           : which < 0.62 ? 2 * unit(random)
                                                          : 0;
    planted.positions.push_back(vec3(40 * unit(random), 40 * unit(random), z));
  }
  EXPECT_FALSE(pose_of(planted).subject.room) << "a planted forest";
  PointCloud sheets;  // a floor and a ceiling, and between them no furniture but another floor
  for (int i = 0; i < 120'000; ++i)
    sheets.positions.push_back({float(i % 200) / 200, float(i / 200 % 200) / 200, 0.3f * float(i / 40'000)});
  EXPECT_FALSE(pose_of(sheets).subject.room) << "three sheets";
  scene::Scene whole;
  whole.cloud = scan("room", synth::Sampling::area, 100'000);
  EXPECT_FALSE(stand_upright(whole, UpAxis::pos_z, false).subject.room);
}

}  // namespace
