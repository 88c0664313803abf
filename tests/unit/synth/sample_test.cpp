#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <set>

#include "core/error.h"
#include "synth/synth.h"

using namespace sfumato;
using namespace sfumato::synth;

namespace {

SampleOptions options_for(Sampling sampling, int points) {
  SampleOptions options;
  options.sampling = sampling;
  options.points = points;
  return options;
}

/// Distance from a point to the nearest surface along the point's normal.
double distance_to_surface(const Scene& scene, dvec3 point, dvec3 normal) {
  const double reach = 0.01;
  const Ray ray{point - reach * normal, normal};
  double nearest = 1e9;
  for (const Hit& hit : scene.intersect_all(ray)) nearest = std::min(nearest, std::abs(hit.t - reach));
  return nearest;
}

TEST(Sample, EveryNoiseFreePointLiesOnTheTrueSurface) {
  for (const std::string& name : scene_names()) {
    const Scene scene = make_scene(name);
    const PointCloud cloud = sample(scene, options_for(Sampling::area, 2000));
    ASSERT_EQ(cloud.size(), 2000u);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      // Positions are float: half a unit in the last place of 16 m is 1e-6, a rim may be missed by as much.
      const double distance =
          distance_to_surface(scene, cloud.world(i), glm::normalize(dvec3(cloud.normals[i])));
      EXPECT_LT(distance, 1e-5) << name << " point " << i;
    }
  }
}

bool equal(const PointCloud& a, const PointCloud& b) {
  if (a.positions != b.positions || a.normals != b.normals || a.colors != b.colors) return false;
  if (a.grid_index != b.grid_index || a.scalars.size() != b.scalars.size()) return false;
  for (std::size_t i = 0; i < a.scalars.size(); ++i)
    if (a.scalars[i].values != b.scalars[i].values) return false;
  return true;
}

TEST(Sample, EqualSeedsGiveEqualBytesOnAnyNumberOfThreads) {
  for (const char* name : {"tori", "courtyard", "room", "forest"})
    for (Sampling sampling : {Sampling::area, Sampling::automatic}) {
      const Scene scene = make_scene(name);
      SampleOptions options = options_for(sampling, 40000);
      options.sigma = 0.01f;
      options.outliers = 100;
      const bool from_ground = scene.natural == Sampling::scanners || scene.natural == Sampling::cameras;
      if (sampling == Sampling::automatic && from_ground) options.flying_pixels = 0.5f;
      const PointCloud many = sample(scene, options);
      const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
      EXPECT_TRUE(equal(many, sample(scene, options))) << name;
      options.seed = 2;
      EXPECT_FALSE(equal(many, sample(scene, options))) << name;
    }
}

TEST(Sample, PointsArePlacedByArea) {
  const Scene scene = make_scene("spheres");
  const int count = 50000;
  const PointCloud cloud = sample(scene, options_for(Sampling::area, count));
  double total = 0, chi_square = 0;
  for (const Primitive& p : scene.primitives) total += area(p);
  for (const Primitive& p : scene.primitives) {
    int here = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i)
      here += std::abs(glm::length(cloud.world(i) - p.center) - p.a) < 1e-5;
    const double expected = count * area(p) / total;
    chi_square += (here - expected) * (here - expected) / expected;
  }
  EXPECT_LT(chi_square, 6 + 5 * std::sqrt(12.0));  // 7 cells: mean 6, deviation sqrt(12); five deviations
}

TEST(Sample, ToriHaveEqualCountsAndTheirColours) {
  const PointCloud cloud = sample(make_scene("tori"), options_for(Sampling::automatic, 3000));
  const ScalarField* layer = cloud.scalar("layer");
  ASSERT_TRUE(layer);
  const double tubes[] = {0.45, 0.30, 0.15};
  const Rgba8 colors[] = {{60, 90, 220, 77}, {60, 190, 80, 128}, {150, 100, 50, 255}};
  int counts[3] = {};
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const std::size_t which = std::size_t(layer->value(i));
    ASSERT_LT(which, 3u);
    ++counts[which];
    const dvec3 p = cloud.world(i);
    EXPECT_NEAR(std::hypot(std::hypot(p.x, p.y) - 1, p.z), tubes[which], 1e-6);
    EXPECT_EQ(cloud.colors[i], colors[which]);
  }
  for (int count : counts) EXPECT_EQ(count, 1000);
}

TEST(Sample, NoiseOfAnAreaHasItsSigma) {
  SampleOptions options = options_for(Sampling::area, 20000);
  options.sigma = 0.01f;
  const PointCloud cloud = sample(make_scene("plane"), options);
  double sum = 0, squares = 0;
  for (const vec3& p : cloud.positions) sum += p.z, squares += double(p.z) * p.z;
  const double n = double(cloud.size());
  EXPECT_NEAR(sum / n, 0, 5 * 0.01 / std::sqrt(n));  // five standard errors of a mean, and of a deviation
  EXPECT_NEAR(std::sqrt(squares / n), 0.01, 5 * 0.01 / std::sqrt(2 * n));
}

TEST(Sample, OutliersAreCountedMarkedAndInTheBox) {
  for (Sampling sampling : {Sampling::area, Sampling::cameras}) {
    const Scene scene = make_scene("spheres");
    SampleOptions options = options_for(sampling, 5000);
    options.outliers = 777;
    const PointCloud cloud = sample(scene, options);
    const ScalarField* outlier = cloud.scalar("outlier");
    ASSERT_TRUE(outlier);
    std::size_t marked = 0, below_middle = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (outlier->value(i) == 0) continue;
      ++marked;
      const dvec3 p = cloud.world(i);
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GE(p[axis], scene.box.min[axis] - 1e-6);
        EXPECT_LE(p[axis], scene.box.max[axis] + 1e-6);
      }
      below_middle += p.z < scene.box.center().z;
    }
    EXPECT_EQ(marked, 777u);
    EXPECT_NEAR(double(below_middle), 388.5, 5 * std::sqrt(777 * 0.25));
    if (sampling == Sampling::area) EXPECT_EQ(cloud.size(), 5777u);
  }
}

/// Depths of the second camera of `plane`, which looks straight down from 2.6 m, in metres.
std::vector<double> depths_from_above(SampleOptions options) {
  Scene scene = make_scene("plane");
  scene.cameras.erase(scene.cameras.begin());
  options.sampling = Sampling::cameras;
  options.points = 20000;
  const PointCloud cloud = sample(scene, options);
  std::vector<double> depths;
  for (std::size_t i = 0; i < cloud.size(); ++i) depths.push_back(2.6 - cloud.world(i).z);
  return depths;
}

double deviation(const std::vector<double>& values, double mean) {
  double squares = 0;
  for (double v : values) squares += (v - mean) * (v - mean);
  return std::sqrt(squares / double(values.size()));
}

TEST(Devices, PoissonNoiseGrowsWithTheSquareOfDepth) {
  for (float level : {1.0f, 4.0f}) {
    SampleOptions options;
    options.noise = NoiseModel::poisson;
    options.noise_level = level;
    const std::vector<double> depths = depths_from_above(options);
    ASSERT_NEAR(double(depths.size()), 20000, 1000);  // the plane fills a known share of the picture
    const double sigma = level * 2.6 * 2.6 / 1000;
    EXPECT_NEAR(deviation(depths, 2.6), sigma, 5 * sigma / std::sqrt(2 * double(depths.size())));
  }
}

TEST(Devices, StructuredLightQuantisesDisparity) {
  SampleOptions options;
  options.noise = NoiseModel::structured_light;
  options.noise_level = 2;
  std::set<long> steps;
  for (double depth : depths_from_above(options)) {
    const double step = 525 * 0.075 / depth * 8 / 2;
    EXPECT_NEAR(step, std::round(step), 1e-4);  // float positions: 1e-7 of 60 steps, times the depth's share
    steps.insert(std::lround(step));
  }
  EXPECT_GE(steps.size(), 3u);  // noise of 0.2 px over steps of 0.25 px
  EXPECT_LE(steps.size(), 12u);
}

TEST(Devices, TimeOfFlightIsNoisierOnDarkSurfaces) {
  Scene scene = make_scene("plane");
  scene.cameras.erase(scene.cameras.begin());
  SampleOptions options = options_for(Sampling::cameras, 40000);
  options.noise = NoiseModel::tof;
  const PointCloud cloud = sample(scene, options);
  const ScalarField* amplitude = cloud.scalar("amplitude");
  ASSERT_TRUE(amplitude);
  // Each error divided by its own sigma is a standard normal.
  std::vector<double> normalised;
  double darkest = 1, brightest = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    normalised.push_back(cloud.world(i).z / (0.0005 / amplitude->value(i)));
    darkest = std::min(darkest, amplitude->value(i));
    brightest = std::max(brightest, amplitude->value(i));
  }
  EXPECT_NEAR(deviation(normalised, 0), 1, 5 / std::sqrt(2 * double(normalised.size())));
  EXPECT_GT(brightest, 2 * darkest);
}

TEST(Devices, MissingReturnsAreTheirShare) {
  SampleOptions options;
  options.view_width.user = 200;
  const double all = double(depths_from_above(options).size());
  options.missing = 0.3f;
  EXPECT_NEAR(double(depths_from_above(options).size()), 0.7 * all, 5 * std::sqrt(0.21 * all));
}

TEST(Devices, OnlyMarkedFlyingPixelsLeaveTheSurface) {
  const Scene scene = make_scene("spheres");
  SampleOptions options = options_for(Sampling::cameras, 40000);
  options.normals.user = true;
  options.flying_pixels = 1;
  const PointCloud cloud = sample(scene, options);
  const ScalarField* outlier = cloud.scalar("outlier");
  std::size_t flying = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    double nearest = 1e9;
    for (const Primitive& p : scene.primitives)
      nearest = std::min(nearest, std::abs(glm::length(cloud.world(i) - p.center) - p.a));
    if (outlier->value(i) == 0) EXPECT_LT(nearest, 1e-5);
    flying += outlier->value(i) == 2 && nearest > 0.01;
  }
  EXPECT_GT(flying, 30u);
  EXPECT_LT(flying, cloud.size() / 20);
}

TEST(Devices, GridsOfScannersNameTheCellOfEveryPoint) {
  const Scene scene = make_scene("courtyard");
  const PointCloud cloud = sample(scene, options_for(Sampling::scanners, 30000));
  EXPECT_NEAR(double(cloud.size()), 30000, 1500);  // from a coarse look at 21,600 rays: 5 %
  ASSERT_EQ(cloud.grids.size(), 3u);
  ASSERT_EQ(cloud.grid_index.size(), cloud.size());
  const ScalarField* scanner = cloud.scalar("scanner");
  std::size_t next = 0;
  for (std::size_t g = 0; g < 3; ++g) {
    const Grid& grid = cloud.grids[g];
    EXPECT_EQ(grid.first, next);
    next += grid.count;
    EXPECT_EQ(*grid.viewpoint, cloud.scanners[g]);
    const double step = 2 * M_PI / grid.width;
    for (std::size_t i = grid.first; i < next; ++i) {
      ASSERT_LT(cloud.grid_index[i], grid.width * grid.height);
      if (i > grid.first) ASSERT_GT(cloud.grid_index[i], cloud.grid_index[i - 1]);
      EXPECT_EQ(scanner->value(i), double(g));
      const dvec3 d = glm::normalize(cloud.world(i) - *grid.viewpoint);
      const double elevation = 0.5 * M_PI - (cloud.grid_index[i] / grid.width + 0.5) * step;
      const double azimuth = -(cloud.grid_index[i] % grid.width + 0.5) * step;
      const dvec3 expected(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                           std::sin(elevation));
      EXPECT_LT(glm::length(d - expected), 1e-5);             // float positions seen from half a metre
      EXPECT_LT(glm::dot(dvec3(cloud.normals[i]), d), 1e-6);  // normals face the scanner
    }
  }
  EXPECT_EQ(next, cloud.size());
}

TEST(Devices, CameraScansAreTheTruthOfTheirPixels) {
  const Scene scene = make_scene("room");
  SampleOptions options = options_for(Sampling::automatic, 6000);
  options.views = 2;
  const PointCloud cloud = sample(scene, options);
  ASSERT_EQ(cloud.grids.size(), 2u);
  EXPECT_TRUE(cloud.normals.empty());
  for (std::size_t g = 0; g < 2; ++g) {
    const Grid& grid = cloud.grids[g];
    const Camera camera = scene.cameras[g].resized(int(grid.width), int(grid.height));
    const Truth image = truth(scene, camera);
    const dmat4 view = camera.view();
    EXPECT_EQ(grid.count, std::size_t(grid.width) * grid.height);  // the room is closed
    for (std::size_t i = grid.first; i < grid.first + grid.count; ++i) {
      const double depth = -(view * glm::dvec4(cloud.world(i), 1)).z;
      EXPECT_NEAR(depth, image.depth.data()[cloud.grid_index[i]], 2e-6);  // both float
      EXPECT_EQ(cloud.colors[i], to_srgb(image.color.data()[cloud.grid_index[i]]));
      EXPECT_EQ(cloud.scalar("classification")->value(i), image.class_id.data()[cloud.grid_index[i]]);
    }
  }
}

TEST(Devices, OnePointPerBlockOfPixels) {
  const Scene scene = make_scene("plane");
  const Camera camera = scene.cameras[1].resized(61, 40);
  const Truth image = truth(scene, camera);
  const Intrinsics k = camera.intrinsics();
  const dmat4 view = camera.view();
  const PointCloud cloud = sample_by_camera(scene, {camera}, 3);
  std::set<std::pair<int, int>> blocks;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const dvec3 eye(view * glm::dvec4(cloud.world(i), 1));
    EXPECT_NEAR(cloud.world(i).z, 0, 1e-6);
    blocks.emplace(int(std::floor((k.fx * eye.x / -eye.z + k.cx) / 3)),
                   int(std::floor((-k.fy * eye.y / -eye.z + k.cy) / 3)));
  }
  EXPECT_EQ(blocks.size(), cloud.size());
  std::size_t covered = 0;
  for (float depth : image.depth) covered += std::isfinite(depth);
  // Blocks cut by the outline or the picture's border may go either way: one row of them around.
  EXPECT_NEAR(double(cloud.size()), double(covered) / 9, 2 * (21 + 14) * 0.5);
}

TEST(Sample, MeshIsSampledByAreaWithOutliers) {
  Mesh mesh;  // two squares, one of four times the area
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {2, 0, 1}, {2, 2, 1}, {0, 2, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
  mesh.colors.assign(8, Rgba8{200, 100, 50, 255});
  SampleOptions options = options_for(Sampling::automatic, 10000);
  options.outliers = 500;
  const PointCloud cloud = sample(make_mesh_scene(mesh), options);
  ASSERT_EQ(cloud.size(), 10500u);
  EXPECT_EQ(cloud.up, UpAxis::pos_y);
  EXPECT_FALSE(cloud.scalar("classification"));
  double small = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (cloud.scalar("outlier")->value(i) != 0) continue;
    small += cloud.positions[i].z == 0;
    EXPECT_EQ(cloud.colors[i], (Rgba8{200, 100, 50, 255}));
    EXPECT_EQ(cloud.normals[i], vec3(0, 0, 1));
  }
  EXPECT_NEAR(small, 2000, 5 * std::sqrt(10000 * 0.2 * 0.8));
}

TEST(Sample, OptionsThatDoNotGoTogetherAreUsageErrors) {
  const Scene tori = make_scene("tori");
  EXPECT_THROW(sample(tori, options_for(Sampling::scanners, 100)), Error);
  EXPECT_THROW(sample(tori, options_for(Sampling::cameras, 100)), Error);
  SampleOptions options = options_for(Sampling::area, 100);
  options.noise = NoiseModel::tof;
  EXPECT_THROW(sample(tori, options), Error);
  options = options_for(Sampling::automatic, 1000);
  options.scanner_position = {0, 0};
  EXPECT_THROW(sample(tori, options), Error);
  options.scanner_position = {0, -3, 1, 0, 3, 1};
  const PointCloud cloud = sample(tori, options);
  EXPECT_EQ(cloud.grids.size(), 2u);
  EXPECT_NEAR(double(cloud.size()), 1000, 250);  // few coarse rays meet the tori, so the step is rough
}

TEST(Sample, ParametersCanBeSetByName) {
  SampleOptions options;
  ParamList list;
  options.describe(list);
  list.find("noise")->set("structured_light");
  list.find("flying-pixels")->set("0.25");
  list.find("view_width")->set("320");
  EXPECT_EQ(options.noise, NoiseModel::structured_light);
  EXPECT_EQ(options.flying_pixels, 0.25f);
  EXPECT_EQ(options.view_width.value(), 320);
  EXPECT_THROW(list.find("missing")->set("1.5"), Error);
}

TEST(Sample, UnknownSceneNamesTheKnownOnes) {
  try {
    make_scene("castle");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    EXPECT_NE(std::string(error.what()).find("courtyard"), std::string::npos);
  }
}

TEST(Airborne, PulsesComeBackSeveralTimesAndEndAtTheGround) {
  const Scene scene = make_scene("forest");
  const PointCloud cloud = sample(scene, options_for(Sampling::automatic, 40000));
  // Five deviations: returns of a pulse vary by less than two, over 20,000 of each of two looks.
  EXPECT_NEAR(double(cloud.size()), 40000, 40000 * 5 * 2 * std::sqrt(2 / 20000.0));
  EXPECT_EQ(cloud.up, UpAxis::pos_z);
  const ScalarField *number = cloud.scalar("return_number"), *total = cloud.scalar("number_of_returns");
  const ScalarField* classes = cloud.scalar("classification");
  ASSERT_TRUE(number && total && classes);
  std::size_t ground = 0, behind_leaves = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double n = number->value(i), of = total->value(i);
    ASSERT_GE(n, 1);
    ASSERT_LE(n, of);
    ASSERT_LE(of, 5);
    if (n > 1) {  // the next return of a pulse is farther down
      ASSERT_EQ(number->value(i - 1), n - 1);
      ASSERT_EQ(total->value(i - 1), of);
      EXPECT_LE(cloud.positions[i].z, cloud.positions[i - 1].z);
    }
    // Normals face one of the two strips, each in the plane across its line.
    const dvec3 p = cloud.world(i), normal(cloud.normals[i]);
    double facing = -1;
    for (double y : {-40.0, 40.0})
      facing = std::max(facing, glm::dot(normal, glm::normalize(dvec3(p.x, y, 150) - p)));
    if (std::abs(p.x) < 24) EXPECT_GT(facing, -1e-6);
    if (classes->value(i) != int(class_ground)) continue;
    ++ground;
    behind_leaves += n > 1;
    EXPECT_EQ(n, of);  // nothing comes back from below the ground
  }
  EXPECT_GT(ground, cloud.size() / 20);
  EXPECT_GT(behind_leaves, ground / 10);
}

TEST(Airborne, NoiseIsAlongThePulse) {
  const Scene scene = make_scene("forest");
  SampleOptions options = options_for(Sampling::automatic, 20000);
  const PointCloud exact = sample(scene, options);
  options.missing = 0.4f;
  const double kept = double(sample(scene, options).size());
  EXPECT_NEAR(kept, 20000, 2000);  // `points` are what comes back, whatever was lost
  options.missing = 0;
  options.flying_pixels = 0.5f;
  EXPECT_THROW(sample(scene, options), Error);
  options.flying_pixels = 0;
  options.sigma = 0.02f;
  const PointCloud noisy = sample(scene, options);
  ASSERT_EQ(noisy.size(), exact.size());
  double squares = 0;
  for (std::size_t i = 0; i < noisy.size(); ++i) {
    const dvec3 moved = noisy.world(i) - exact.world(i);
    // Down a pulse that leans by 24 degrees at most, (40 + 24 + 4) m aside on 150 m.
    EXPECT_GE(std::abs(moved.z), std::cos(glm::radians(25.0)) * glm::length(moved) - 1e-5);
    squares += glm::dot(moved, moved);
  }
  const double n = double(noisy.size());
  EXPECT_NEAR(std::sqrt(squares / n), 0.02, 5 * 0.02 / std::sqrt(2 * n));
  EXPECT_THROW(sample(make_scene("room"), options_for(Sampling::airborne, 100)), Error);
}

}  // namespace
