// Normals and radii of RGB-D views against planes whose answer is known.
#include "analysis/range_image.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "analysis/prepare.h"

using namespace sfumato;
using namespace sfumato::analysis;

namespace {

constexpr int width = 80, height = 60;
constexpr float focal = 70;
const dvec3 eye(5, -3, 2);

/// What a pinhole camera at `eye` that looks along +Y sees of the planes n . (p - eye) = n . base: the left
/// half of the picture sees the first, the right half the second. Depths have noise of `sigma` times the
/// depth squared.
PointCloud view_of(vec3 normal_left, vec3 base_left, vec3 normal_right, vec3 base_right, float sigma) {
  std::mt19937 random(5);
  std::normal_distribution<float> noise(0, 1);
  PointCloud cloud;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const vec3 ray((x + 0.5f - width / 2) / focal, 1, -(y + 0.5f - height / 2) / focal);
      const bool left = x < width / 2;
      const vec3 n = left ? normal_left : normal_right, base = left ? base_left : base_right;
      float depth = glm::dot(n, base) / glm::dot(n, ray);
      depth += sigma * depth * depth * noise(random);
      cloud.positions.push_back(vec3(eye) + depth * ray);
      cloud.grid_index.push_back(std::uint32_t(y * width + x));
    }
  cloud.grids = {{0, cloud.size(), width, height, eye}};
  return cloud;
}

/// Depths in steps of `step` times their square.
void count_depths(PointCloud& cloud, float step) {
  for (vec3& p : cloud.positions) {
    const vec3 way = p - vec3(eye);
    const float steps = std::round(1 / (step * way.y));
    p = vec3(eye) + way * (1 / (step * steps) / way.y);
  }
}

double worst_degrees(const PointCloud& cloud, vec3 left, vec3 right, double share) {
  std::vector<double> errors;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const vec3 expected = int(i) % width < width / 2 ? left : right;
    errors.push_back(glm::degrees(std::acos(std::min(1.0f, glm::dot(cloud.normals[i], expected)))));
  }
  std::sort(errors.begin(), errors.end());
  return errors[std::size_t(share * double(errors.size() - 1))];
}

TEST(RangeImage, PlanesWithAnEdgeBetweenThem) {
  // A wall two metres away and a slanted one a metre behind it.
  const vec3 left(0, -1, 0), right = glm::normalize(vec3(-0.5f, -1, 0.3f));
  PointCloud cloud = view_of(left, {0, 2, 0}, right, {0, 3, 0}, 0);
  const std::vector<vec3> positions = cloud.positions;
  complete_from_grids(cloud, Attribute::normal | Attribute::radius);
  EXPECT_EQ(cloud.positions, positions) << "positions stay raw";
  // Exact planes still bend a little under the filter (measured: 2.9 degrees), most where the border of the
  // picture or the edge cuts its window (15.5). Without a stop at the edge, a jump of 1 m over 4 cm would be
  // off by 80.
  EXPECT_LT(worst_degrees(cloud, left, right, 0.9), 4);
  EXPECT_LT(worst_degrees(cloud, left, right, 1.0), 20) << "the edge does not bend normals";
  // The angle of a pixel is the median over the picture: cos^2 of the way off the axis below 1 / focal.
  const std::size_t middle = height / 2 * width + width / 4;
  EXPECT_NEAR(cloud.radii[middle], std::sqrt(4 / M_PI) * glm::length(positions[middle] - vec3(eye)) / focal,
              0.2 * cloud.radii[middle]);
}

TEST(RangeImage, TerracesOfCountedDepthsAreNoShape) {
  // Depths in steps of 0.003 z^2, as a Kinect counts them: 1.2 cm at 2 m, on a wall that turns by 10 degrees
  // and so has terraces a few pixels wide.
  const vec3 wall = glm::normalize(vec3(-0.17f, -1, 0.1f));
  PointCloud cloud = view_of(wall, {0, 2, 0}, wall, {0, 2, 0}, 0);
  count_depths(cloud, 0.003f);
  complete_from_grids(cloud, Attribute::normal | Attribute::radius);
  EXPECT_LT(worst_degrees(cloud, wall, wall, 0.9), 6) << "raw slopes are 0 or 25 degrees";
}

TEST(RangeImage, SlantedSurfacesGetLargerDiscs) {
  const vec3 wall = glm::normalize(vec3(-1, -1, 0));
  PointCloud cloud = view_of(wall, {0, 2, 0}, wall, {0, 2, 0}, 0),
             frontal = view_of({0, -1, 0}, {0, 2, 0}, {0, -1, 0}, {0, 2, 0}, 0);
  for (PointCloud* each : {&cloud, &frontal}) complete_from_grids(*each, Attribute::radius);
  const std::size_t middle = height / 2 * width + width / 2;
  // At 45 degrees a point stands for an area sqrt(2) as large.
  EXPECT_NEAR(cloud.radii[middle] / frontal.radii[middle], std::pow(2.0, 0.25), 0.05);
  // At the rim nobody knows.
  auto angle = [](const PointCloud& c) { return c.radii[0] / glm::length(c.positions[0] - vec3(eye)); };
  EXPECT_NEAR(angle(cloud), angle(frontal), 0.03f * angle(frontal));  // noise filters bend the corner
}

TEST(RangeImage, NoiseIsSmoothedAway) {
  const vec3 left(0, -1, 0), right = glm::normalize(vec3(-0.5f, -1, 0.3f));
  // 2 cm of noise at 2 m, where a pixel is 2.9 cm wide: raw cross products are off by some 30 degrees.
  PointCloud cloud = view_of(left, {0, 2, 0}, right, {0, 3, 0}, 0.005f);
  complete_from_grids(cloud, Attribute::normal);
  EXPECT_LT(worst_degrees(cloud, left, right, 0.5), 10);
  EXPECT_TRUE(cloud.radii.empty()) << "only what is needed";
}

// Of white noise its deviation; of counted depths at least that of rounding, step / sqrt(12), and at most
// what has second differences of a step, step / sqrt(6): of terraces a few pixels wide a third has.
TEST(RangeImage, TheNoiseOfASensorIsThatOfItsPicture) {
  const vec3 left(0, -1, 0), right = glm::normalize(vec3(-0.5f, -1, 0.3f));
  for (const float sigma : {0.001f, 0.004f, 0.016f}) {
    const auto pictures = depth_pictures(view_of(left, {0, 2, 0}, right, {0, 5, 0}, sigma));
    ASSERT_TRUE(pictures);
    EXPECT_NEAR(pictures->noise, sigma, 0.2f * sigma);
    EXPECT_EQ(pictures->sensor, vec3(eye));
  }
  const vec3 wall = glm::normalize(vec3(-0.17f, -1, 0.1f));
  PointCloud counted = view_of(wall, {0, 2, 0}, wall, {0, 2, 0}, 0);
  count_depths(counted, 0.003f);
  EXPECT_GT(depth_pictures(counted)->noise, 0.98f * 0.003f / std::sqrt(12.0f));
  EXPECT_LT(depth_pictures(counted)->noise, 1.02f * 0.003f / std::sqrt(6.0f));
}

// The noise of a sensor does not part what is one surface; depths of their own do.
TEST(RangeImage, SurfacesContinueInPictures) {
  const vec3 wall(0, -1, 0);
  const PointCloud view = view_of(wall, {0, 2, 0}, wall, {0, 3, 0}, 0.004f);
  EXPECT_GT(depth_pictures(view)->surface_share, 0.97f);
  PointCloud leaves = view;
  std::mt19937 random(7);
  std::uniform_real_distribution<float> depth(1, 4);
  for (vec3& p : leaves.positions) p = vec3(eye) + (p - vec3(eye)) * (depth(random) / (p - vec3(eye)).y);
  EXPECT_LT(depth_pictures(leaves)->surface_share, 0.2f);
  // Of two pictures the share of both, and no one sensor.
  PointCloud two = view;
  append(two, view_of(wall, {0, 4, 0}, wall, {0, 4, 0}, 0.004f));
  EXPECT_GT(depth_pictures(two)->surface_share, 0.97f);
  EXPECT_EQ(depth_pictures(two)->noise, 0);
  // Of points most of which are of no picture nothing is said.
  two.grids.pop_back();
  EXPECT_FALSE(depth_pictures(two));
}

// A technique that comes second, or a renderer that learns late which one is wanted, gets the same normals.
TEST(RangeImage, CompletesASortedCloudLater) {
  const vec3 left(0, -1, 0), right = glm::normalize(vec3(-0.5f, -1, 0.3f));
  PointCloud cloud = view_of(left, {0, 2, 0}, right, {0, 3, 0}, 0.002f);
  const PointCloud other = view_of(right, {0, 4, 0}, left, {0, 2.5f, 0}, 0.002f);
  cloud.positions.push_back({0, 0, 0});  // between the views, of none
  cloud.grid_index.push_back(0);
  append(cloud, other);
  const Attributes needs = Attribute::normal | Attribute::radius;
  const PreparedCloud at_once = prepare(cloud, needs, {});
  PreparedCloud later = prepare(cloud, {}, {});
  EXPECT_TRUE(later.cloud.normals.empty());
  EXPECT_FALSE(later.views.grids.empty());
  complete(later, Attribute::radius, {});
  complete(later, needs, {});
  EXPECT_EQ(later.cloud.normals, at_once.cloud.normals);
  EXPECT_EQ(later.cloud.radii, at_once.cloud.radii);
  EXPECT_TRUE(later.views.grids.empty()) << "nothing is left to be computed from them";
}

TEST(RangeImage, LeavesOtherCloudsAlone) {
  PointCloud cloud = view_of({0, -1, 0}, {0, 2, 0}, {0, -1, 0}, {0, 2, 0}, 0);
  cloud.grids[0].viewpoint.reset();
  complete_from_grids(cloud, Attribute::normal | Attribute::radius);
  EXPECT_TRUE(cloud.normals.empty());
  // All around, as terrestrial scanners see: no picture.
  cloud.grids[0].viewpoint = dvec3(eye) + dvec3(0, 2, 0);
  complete_from_grids(cloud, Attribute::normal | Attribute::radius);
  EXPECT_TRUE(cloud.normals.empty());
}

TEST(RangeImage, PreparationCompletesPointsOfNoGrid) {
  PointCloud cloud = view_of({0, -1, 0}, {0, 2, 0}, {0, -1, 0}, {0, 2, 0}, 0);
  for (int i = 0; i < 50; ++i) {
    cloud.positions.push_back(vec3(eye) + vec3(0.02f * float(i % 7), 1.5f, 0.02f * float(i / 7)));
    cloud.grid_index.push_back(UINT32_MAX);
  }
  const PreparedCloud prepared = prepare(cloud, Attribute::normal | Attribute::radius, {});
  EXPECT_TRUE(prepared.available.has(Attribute::normal));
  EXPECT_TRUE(prepared.available.has(Attribute::radius));
  for (std::size_t i = 0; i < prepared.cloud.size(); ++i) {
    const float y = prepared.cloud.normals[i].y;
    if (prepared.cloud.source_index[i] < std::uint32_t(width * height))
      ASSERT_LT(y, -0.9f) << "towards the viewpoint";
    else
      ASSERT_GT(std::abs(y), 0.9f) << "nobody knows who saw it";
  }
}

/// What a file without grids keeps of a view that looks along z, or along -z: its points, here in another
/// order.
PointCloud loose(double along, float step, std::vector<std::uint32_t>& cells) {
  std::mt19937 random(6);
  PointCloud cloud;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (std::hypot(x - 50, y - 20) < 9 || x == 33) continue;  // nothing was measured there
      const float depth = std::round((2 + 0.01f * float(x + y)) / step) * step;
      const vec3 p((float(x) + 0.3f - width / 2) / focal * depth,
                   (float(y) + 0.3f - height / 2) / focal * depth, float(along) * depth);
      cloud.positions.push_back(p);
      cells.push_back(std::uint32_t(y * width + x));
    }
  std::vector<std::size_t> order(cloud.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::shuffle(order.begin(), order.end(), random);
  PointCloud shuffled;
  std::vector<std::uint32_t> shuffled_cells;
  for (std::size_t i : order)
    shuffled.positions.push_back(cloud.positions[i]), shuffled_cells.push_back(cells[i]);
  cells = shuffled_cells;
  return shuffled;
}

TEST(RangeImage, PixelsAreFoundAgainInFilesWithoutThem) {
  for (double along : {1.0, -1.0}) {
    std::vector<std::uint32_t> cells;
    PointCloud cloud = loose(along, 0.001f, cells);
    cloud.positions.push_back(vec3(300, 200, -40));  // a stray
    ASSERT_TRUE(recover_grid(cloud));
    ASSERT_EQ(cloud.grids.size(), 1u);
    EXPECT_EQ(cloud.grids[0].width, std::uint32_t(width));
    EXPECT_EQ(cloud.grids[0].height, std::uint32_t(height));
    EXPECT_EQ(cloud.grids[0].viewpoint, dvec3(0));
    for (std::size_t i = 0; i < cells.size(); ++i) ASSERT_EQ(cloud.grid_index[i], cells[i]) << i;
    complete_from_grids(cloud, Attribute::normal | Attribute::radius);
    EXPECT_EQ(cloud.normals.back(), vec3(0)) << "in no pixel";
    const auto known =
        std::count_if(cloud.normals.begin(), cloud.normals.end(), [](const vec3& n) { return n != vec3(0); });
    EXPECT_GT(double(known), 0.98 * double(cloud.size()));
  }
}

TEST(RangeImage, WhatIsNoPictureGetsNoPixels) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(0, 1);
  PointCloud scattered, grid;
  for (int i = 0; i < 20'000; ++i) {
    const float depth = 2 + unit(random);
    scattered.positions.push_back(depth * vec3(unit(random) - 0.5f, unit(random) - 0.5f, 1));
    grid.positions.push_back(vec3(float(i % 100), float(i / 100), 150) +
                             vec3(0, 0, 40 * unit(random)));  // even in space
  }
  EXPECT_FALSE(recover_grid(scattered));
  EXPECT_FALSE(recover_grid(grid));
  std::vector<std::uint32_t> cells;
  PointCloud half = loose(1, 0.001f, cells);
  half.positions.resize(half.size() / 2);  // in no order
  EXPECT_FALSE(recover_grid(half));
  PointCloud sparse = loose(1, 0.001f, cells);
  sparse.positions.resize(sparse.size() / 8);
  EXPECT_FALSE(recover_grid(sparse));
  EXPECT_TRUE(sparse.grids.empty() && sparse.grid_index.empty());
}

}  // namespace
