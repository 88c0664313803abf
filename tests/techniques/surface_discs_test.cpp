// The default way of `surface`, operator by operator, against the definitions in double precision over plain
// arrays; then its pictures where others had blocks.
#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "reference/gl_fixture.h"
#include "reference/screen_oracle.h"
#include "reference/surface_scenes.h"
#include "techniques/surface/discs.h"

using namespace sfumato;
using namespace sfumato::testing;
using surface::Discs;
using surface::HiddenPoints;

namespace {

class SurfaceDiscs : public GlTest {};

struct Scene {
  Camera camera = front_camera(128, 128);
  Image<float> depth{128, 128, INFINITY};
  Image<vec4> colors{128, 128, vec4(0, 0, 0, 1)};
  float spacing = 0;

  explicit Scene(double px) {
    camera.near_plane = 1, camera.far_plane = 12;
    spacing = float(px * 4 / camera.pixels_per_unit());
  }
  /// At most one point in each 2x2 pixels, about one on px x px pixels, at random.
  template <class F>
  void scatter(double px, F depth_of, unsigned seed = 2) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int y = 0; y < 128; y += 2)
      for (int x = 0; x < 128; x += 2) {
        const double chance = uniform(random);
        const int i = x + int(random() % 2), j = y + int(random() % 2);
        const double z = depth_of(i + 0.5, j + 0.5);
        if (chance > 4 / (px * px) || !(z < 1e9)) continue;
        depth.at(i, j) = float(z);
        colors.at(i, j) = vec4(float(uniform(random)), float(uniform(random)), float(uniform(random)), 1);
      }
  }
};

/// The operators up to discs, and what they left.
struct Operators {
  View view;
  NearestPyramid pyramid;
  HiddenPoints squares;
  Discs discs;
  gl::Texture colors{"colours", GL_RGBA32F, 128, 128};
  Discs::Options options;

  explicit Operators(const Scene& scene, const Discs::Options& with = {})
      : view(scene.camera, dvec3(0)), options(with) {
    pyramid.points(128, 128).upload(eye_positions(scene.camera, scene.depth, scene.spacing));
    pyramid.build();
    colors.upload(scene.colors);
    view.bind();
    HiddenPoints::Options removal;
    removal.method = surface::Removal::none;
    squares.run_squares(pyramid, removal);
    discs.find(pyramid, squares, colors, options);
  }
};

// Removal on squares is that on pixels of a picture of half the size: its points are the nearest of each 2x2
// px.
TEST_F(SurfaceDiscs, RemovalOnSquaresIsThatOfTheirNearestPoints) {
  Scene scene(5);
  scene.scatter(
      5, [](double x, double y) { return (x < 60 ? 3.0 : 4.0) + x / 1000 + y / 1700; });  // no two alike
  scene.scatter(
      4, [](double x, double y) { return y < 70 ? 4.5 + x / 900 + y / 1300 : INFINITY; }, 7);
  NearestPyramid pyramid;
  pyramid.points(128, 128).upload(eye_positions(scene.camera, scene.depth, scene.spacing));
  pyramid.build();
  const View view(scene.camera, dvec3(0));
  view.bind();
  HiddenPoints squares;
  HiddenPoints::Options options;
  options.removal_scale = 6;
  squares.run_squares(pyramid, options);
  const Image<float> mean = squares.mean().download<float>(), levels = squares.levels().download<float>();
  int checked = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const auto own = nearest_in_square(scene.camera, scene.depth, x, y, 1);
      if (!own) {
        ASSERT_EQ(mean.at(x, y), 2);  // left out
        continue;
      }
      // The level of Eq. 1 between the squares of the coarse map, 16 px wide; rings begin at squares of 2 px.
      const double sx = (x + 0.5) / 8 - 0.5, sy = (y + 0.5) / 8 - 0.5, tx = sx - std::floor(sx),
                   ty = sy - std::floor(sy);
      const auto at = [&](int i, int j) {
        return double(levels.at(std::clamp(i, 0, 7), std::clamp(j, 0, 7)));
      };
      const int ix = int(std::floor(sx)), iy = int(std::floor(sy));
      const double level = (1 - ty) * ((1 - tx) * at(ix, iy) + tx * at(ix + 1, iy)) +
                           ty * ((1 - tx) * at(ix, iy + 1) + tx * at(ix + 1, iy + 1));
      if (std::abs(level - std::round(level)) < 1e-5) continue;
      double expected = 0;
      for (auto [last, share] : {std::pair{int(std::floor(level)), 1 - (level - std::floor(level))},
                                 {int(std::ceil(level)), level - std::floor(level)}}) {
        std::array<double, 8> least;
        least.fill(2);
        for (int l = 0; l <= last; ++l)
          for (int k = 0; k < 8; ++k) {
            const int dx = int(std::lround(std::cos(k * M_PI / 4))),
                      dy = int(std::lround(std::sin(k * M_PI / 4)));
            const auto other =
                nearest_in_square(scene.camera, scene.depth, (x >> l) + dx, (y >> l) + dy, l + 1);
            if (other)
              least[std::size_t(k)] =
                  std::min(least[std::size_t(k)], occlusion_value(scene.camera, *own, *other));
          }
        for (double o : least) expected += share * o / 8;
      }
      ASSERT_NEAR(mean.at(x, y), expected, 1e-3)
          << x << " " << y;  // cosines of float differences, as in surface_test
      ++checked;
    }
  EXPECT_GT(checked, 500);
}

TEST_F(SurfaceDiscs, ClustersAreCentroidsOfTheNearSide) {
  Scene scene(3);
  scene.scatter(3, [](double x, double y) { return std::hypot(x - 60, y - 60) < 35 ? 4 : 6.0 + x / 100; });
  Operators run(scene);
  for (int l = 0; l < 3; ++l) {
    const Image<vec4> clusters = run.discs.clusters(l).download<vec4>();
    int several = 0;
    for (int y = 0; y < clusters.height(); ++y)
      for (int x = 0; x < clusters.width(); ++x) {
        // Where all points of a square are within an edge of each other, the order of merging does not
        // matter.
        std::vector<dvec3> points;
        double nearest = -1e30, farthest = 1e30;
        const int side = 2 << l;
        for (int j = y * side; j < (y + 1) * side; ++j)
          for (int i = x * side; i < (x + 1) * side; ++i)
            if (!std::isinf(scene.depth.at(i, j))) {
              points.push_back(unproject(scene.camera, i + 0.5, j + 0.5, scene.depth.at(i, j)));
              nearest = std::max(nearest, points.back().z), farthest = std::min(farthest, points.back().z);
            }
        if (points.empty()) {
          ASSERT_EQ(clusters.at(x, y).w, 0);
          continue;
        }
        const double edge =
            4 * std::max(double(scene.spacing), -side * nearest / scene.camera.pixels_per_unit());
        if (farthest < nearest - 1.001 * edge) {  // two sides: nothing far is left
          ASSERT_GE(clusters.at(x, y).z, nearest - 1.001 * edge);
          continue;
        }
        if (farthest < nearest - 0.5 * edge) continue;
        dvec3 mean(0);
        for (const dvec3& p : points) mean += p / double(points.size());
        several += points.size() > 1;
        ASSERT_EQ(clusters.at(x, y).w, float(points.size()));
        for (int k = 0; k < 3; ++k)
          ASSERT_NEAR(clusters.at(x, y)[k], mean[k], 2e-6);  // some roundings of numbers to 8
      }
    if (l > 0) EXPECT_GT(several, 50);
  }
}

/// Smallest eigenvector of the symmetric matrix by Jacobi rotations.
dvec3 least_axis(glm::dmat3 a, dvec3& values) {
  glm::dmat3 v(1.0);
  for (int sweep = 0; sweep < 30; ++sweep)
    for (auto [p, q] : {std::pair{0, 1}, {0, 2}, {1, 2}}) {
      if (std::abs(a[q][p]) < 1e-300) continue;
      const double theta = 0.5 * std::atan2(2 * a[q][p], a[q][q] - a[p][p]), c = std::cos(theta),
                   s = std::sin(theta);
      glm::dmat3 r(1.0);
      r[p][p] = c, r[q][q] = c, r[q][p] = s, r[p][q] = -s;
      a = glm::transpose(r) * a * r;
      v = v * r;
    }
  values = {a[0][0], a[1][1], a[2][2]};
  const int least = values.x < values.y ? (values.x < values.z ? 0 : 2) : (values.y < values.z ? 1 : 2);
  return v[least];
}

TEST_F(SurfaceDiscs, PlanesAreThoseOfTheBallAroundAPoint) {
  // Facing enough to be found at once, and points so near to each other that the squares of 2 px are asked.
  Scene scene(3.5);
  scene.scatter(3.5,
                [](double x, double y) { return 4 + 0.003 * x + 0.1 * std::sin(x / 17) * std::cos(y / 13); });
  Operators run(scene);
  const Image<vec4> orientations = run.discs.orientations().download<vec4>();
  const double reach = run.options.normal_scale * scene.spacing, k = scene.camera.pixels_per_unit();
  int checked = 0;
  for (int y = 12; y < 52; ++y)
    for (int x = 12; x < 52; ++x) {
      const auto own = nearest_in_square(scene.camera, scene.depth, x, y, 1);
      if (!own) continue;
      ASSERT_LT(std::log2(reach * k / -own->z / 4.5), 1.5);  // squares of 2 px
      glm::dmat3 moments(0.0);
      dvec3 mean(0);
      double support = 0;
      for (int j = 0; j < 128; ++j)
        for (int i = 0; i < 128; ++i) {
          if (std::isinf(scene.depth.at(i, j))) continue;
          const dvec3 d = (unproject(scene.camera, i + 0.5, j + 0.5, scene.depth.at(i, j)) - *own) / reach;
          const double w = std::pow(std::max(0.0, 1 - glm::dot(d, d)), 2);
          moments += w * glm::outerProduct(d, d);
          mean += w * d;
          support += w;
        }
      mean /= support;
      dvec3 values;
      dvec3 normal = least_axis(moments / support - glm::outerProduct(mean, mean), values);
      if (glm::dot(normal, *own) > 0) normal = -normal;
      const vec4 found = orientations.at(x, y);
      // Squares of several points would be merged; here none has. 0.1 degrees: float moments of offsets up
      // to 1.
      ASSERT_GT(glm::dot(dvec3(found), normal), std::cos(glm::radians(0.1))) << x << " " << y;
      // As many points as there are under (1 - d^2)^2, whose mean over a disc is a third.
      const double measured =
          std::clamp(reach * std::sqrt(M_PI / 3 / support), 0.5 * scene.spacing, 2.0 * scene.spacing);
      ASSERT_GE(found.w, 0.6 * run.options.disc_scale * measured);
      ASSERT_LE(
          found.w,
          std::max(run.options.disc_scale * measured, 0.52 * run.options.gap_scale * scene.spacing) * 1.001);
      ++checked;
    }
  EXPECT_GT(checked, 300);
}

TEST_F(SurfaceDiscs, SumsAreThoseOfAllDiscs) {
  Scene scene(4);
  const auto depth_of = [](double x, double y) {
    return std::hypot(x - 64, y - 64) < 40 ? 4 + x / 200 : 5.5 + y / 300;
  };
  for (unsigned seed : {2u, 3u, 4u}) scene.scatter(4, depth_of, seed);  // squares with one to three points
  Operators run(scene);
  run.discs.draw(run.view, run.options);
  const auto clusters = run.discs.clusters(0).download<vec4>(),
             orientations = run.discs.orientations().download<vec4>();
  const auto ends = run.discs.ends().download<vec4>(), disc_colors = run.discs.colors().download<vec4>();
  const auto colors = run.discs.color_sum().download<vec4>(),
             normals = run.discs.normal_sum().download<vec4>();
  const Intrinsics k = scene.camera.intrinsics();
  int covered = 0, off = 0;
  for (int y = 1; y < 128; y += 3)
    for (int x = 1; x < 128; x += 3) {
      const dvec3 ray = unproject(scene.camera, x + 0.5, y + 0.5, 1);
      struct Hit {
        double t, rho, radius;
        dvec3 color, normal;
      };
      std::vector<Hit> hits;
      for (int j = 0; j < 64; ++j)
        for (int i = 0; i < 64; ++i) {
          if (clusters.at(i, j).w <= 0) continue;
          const dvec3 center(clusters.at(i, j)), normal(orientations.at(i, j));
          const double radius = orientations.at(i, j).w;
          const glm::dvec2 away(x + 0.5 - (k.cx - k.fx * center.x / center.z),
                                y + 0.5 - (k.cy + k.fy * center.y / center.z));
          const vec4 end = ends.at(i, j);
          if (away.x * end.x + away.y * end.y > end.z) continue;
          const double depth = glm::dot(center, normal) / glm::dot(ray, normal);
          Hit hit{depth * glm::length(ray), glm::length(ray * depth - center) / radius, radius,
                  dvec3(disc_colors.at(i, j)), normal};
          // At least a disc of that many px: half the diagonal of a pixel, or of the square when it is full.
          const double least = 0.71 + 0.7 * (clusters.at(i, j).w - 1) / 3;
          const double screen = glm::length(away) / least;
          if (!(hit.rho < 1))
            hit.t = -center.z * glm::length(ray), hit.rho = screen;
          else
            hit.rho = std::min(hit.rho, screen);
          if (hit.rho < 1) hits.push_back(hit);
        }
      double nearest = 1e30, weight = 0, depth = 0;
      dvec3 color(0);
      for (const Hit& h : hits) nearest = std::min(nearest, h.t);
      for (const Hit& h : hits) {
        if (h.t > nearest + 1.2 * h.radius) continue;
        const double w = std::pow(1 - h.rho, 4) * (4 * h.rho + 1);
        weight += w, depth += w * h.t, color += w * h.color;
      }
      covered += weight > 0;
      // Rims and ends fall to one side or the other by a rounding: on few pixels.
      bool same = std::abs(colors.at(x, y).w - weight) < 1e-3 && std::abs(normals.at(x, y).w - depth) < 5e-3;
      for (int c = 0; c < 3; ++c) same &= std::abs(colors.at(x, y)[c] - color[c]) < 2e-3;  // half floats
      off += !same;
    }
  EXPECT_GT(covered, 1200);
  EXPECT_LE(off, 12);
}

RenderOutput picture(Renderer& renderer, const char* name, const Camera& camera) {
  auto technique = find_technique(name).create();
  RenderSettings settings;
  settings.transparent = true;
  return renderer.render(*technique, camera, settings, all_outputs());
}

/// Points at random on a unit sphere, off it by a normal distribution.
PointCloud random_sphere(std::size_t count, double noise = 0) {
  std::mt19937 random(8), off(9);
  std::normal_distribution<double> normal;
  PointCloud cloud;
  while (cloud.size() < count) {
    const dvec3 way = glm::normalize(dvec3(normal(random), normal(random), normal(random)));
    cloud.positions.push_back(vec3((noise > 0 ? 1 + noise * normal(off) : 1) * way));
  }
  cloud.colors.assign(count, {180, 180, 180, 255});
  return cloud;
}

/// What a picture of the unit sphere is off by: medians of its normals and depths, and wrong pixels by the
/// length of the outline.
struct OffSphere {
  double normals_deg = 0, depth = 0, outline_px = 0;
};
OffSphere off_sphere(const RenderOutput& out, const Camera& camera) {
  const Intrinsics k = camera.intrinsics();
  const dmat4 world = camera.inverse_view();
  const double distance = glm::length(camera.position);
  std::vector<double> normals, depths;
  double wrong = 0;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const dvec3 ray = glm::normalize(dvec3((x + 0.5 - k.cx) / k.fx, -(y + 0.5 - k.cy) / k.fy, -1));
      const dvec3 direction(world * glm::dvec4(ray, 0));
      const double b = -glm::dot(direction, camera.position), d = b * b - distance * distance + 1;
      wrong += (d >= 0) != (out.color_linear.at(x, y).a > 0.5f);
      if (d < 0 || std::isinf(out.depth.at(x, y))) continue;
      const double t = b - std::sqrt(d);
      depths.push_back(std::abs(out.depth.at(x, y) + ray.z * t));
      const dvec3 normal = camera.position + t * direction;
      normals.push_back(
          glm::degrees(std::acos(std::clamp(glm::dot(normal, dvec3(out.normal.at(x, y))), -1.0, 1.0))));
    }
  const double outline = 2 * M_PI * k.fx / std::sqrt(distance * distance - 1);
  return {median(normals), median(depths), wrong / outline};
}

// The rows of docs/techniques/surface.md, on another shape: blocks of the screen's grid gave 17 degrees at 6
// px.
TEST_F(SurfaceDiscs, NormalsAndDepthsOfASphereAtEveryDensity) {
  const Camera camera = front_camera(240, 240, 3.2);
  const double distance = glm::length(camera.position),
               px_per_unit = camera.pixels_per_unit() / (distance - 1);
  for (double px : {2.0, 3.0, 6.0, 10.0}) {
    Renderer renderer(context());
    show(renderer, random_sphere(std::size_t(4 * M_PI * std::pow(px_per_unit / px, 2))), {});
    const RenderOutput out = picture(renderer, "surface", camera);
    const OffSphere off = off_sphere(out, camera);
    const double spacings = off.depth / (px / px_per_unit);
    std::cout << px << " px: normals " << off.normals_deg << " deg, depth " << spacings
              << " spacings, outline off by " << off.outline_px << " px\n";
    // Twice what is measured: the points are random.
    EXPECT_LT(off.normals_deg, 0.45 * px);
    EXPECT_LT(spacings, 0.08);
    EXPECT_LT(off.outline_px, px < 5 ? 1.0 : 0.35 * px);
  }
}

// In balls of three spacings noise of half a spacing tilts planes by 6.5 degrees, and of one by 13; twice as
// wide they are a quarter of that.
TEST_F(SurfaceDiscs, PlanesSeeAsFarAsNoiseAsks) {
  const Camera camera = front_camera(360, 360, 3.2);
  const double px = 2, spacing = px * (glm::length(camera.position) - 1) / camera.pixels_per_unit();
  for (const double noise : {0.5, 1.0}) {
    Renderer renderer(context());
    show(renderer, random_sphere(std::size_t(4 * M_PI / (spacing * spacing)), noise * spacing), {});
    const double off = off_sphere(picture(renderer, "surface", camera), camera).normals_deg;
    std::cout << noise << " spacings: " << off << " deg\n";
    EXPECT_LT(off, 4);
  }
}

// How often outlines stand on the likeliest of the 8 phases of a grid of 8 px: by chance 1, and with n edges
// about 1 + 1.4 sqrt(8 / n).
TEST_F(SurfaceDiscs, OutlinesDoNotKnowTheGridOfTheScreen) {
  Renderer renderer(context());
  // As fine as pixels the 2x2 squares are seen: 1.59 where discs of full ones were no larger than of single
  // pixels, 1.32 where they reach the corners; larger ones make outlines bolder.
  struct Case {
    std::size_t points;
    int size;
    double most;
  };
  for (const auto& [points, size, most] :
       {Case{6000, 200, 1.15}, {6000, 256, 1.15}, {80000, 200, 1.35}, {80000, 256, 1.35}}) {
    SCOPED_TRACE(std::to_string(points) + " points, " + std::to_string(size) + " px");
    show(renderer, random_sphere(points), {});
    double counts[8] = {}, sum = 0;
    for (double turn : {0.0, 0.7, 1.4, 2.1, 2.8, 3.5}) {
      Camera camera = turned(front_camera(size, size, 3.1), turn, 0.2 * turn);
      camera.target = {0.02 * turn, 0, 0.03 * turn};
      const Image<float> depth = picture(renderer, "surface", camera).depth;
      for (int y = 1; y < size; ++y)
        for (int x = 1; x < size; ++x) {
          const bool across = std::isinf(depth.at(x, y)) != std::isinf(depth.at(x - 1, y));
          const bool down = std::isinf(depth.at(x, y)) != std::isinf(depth.at(x, y - 1));
          counts[x % 8] += across, counts[y % 8] += down, sum += across + down;
        }
    }
    ASSERT_GT(sum, 2000);
    EXPECT_LE(8 * *std::max_element(counts, counts + 8) / sum, most);
  }
}

// A sphere that turns has an outline that stays: what comes and goes there is noise. Without the hull of
// points 2.0 to 2.9 times as many pixels did, and the outline was farther off.
TEST_F(SurfaceDiscs, OutlinesStayWhereTheyAre) {
  Renderer renderer(context());
  for (const auto& [count, most] : {std::pair{40000, 0.155}, {10000, 0.12}, {2500, 0.19}}) {
    show(renderer, random_sphere(std::size_t(count)), {});
    const Camera camera = front_camera(240, 240, 3.2);
    Image<float> last;
    double flips = 0;
    constexpr int frames = 12;
    for (int n = 0; n <= frames; ++n) {
      const Image<float> depth = picture(renderer, "surface", turned(camera, glm::radians(0.2) * n, 0)).depth;
      for (std::size_t i = 0; n > 0 && i < depth.size(); ++i)
        flips += std::isinf(depth.data()[i]) != std::isinf(last.data()[i]);
      last = depth;
    }
    const double distance = glm::length(camera.position);
    const double outline = 2 * M_PI * camera.intrinsics().fx / std::sqrt(distance * distance - 1);
    std::cout << count << " points: " << flips / frames / outline << " pixels a frame and px of outline\n";
    EXPECT_LE(flips / frames / outline, most);
  }
}

/// Three units before the plane y = 0, a pixel as wide as `pixel` everywhere.
Camera camera_before(int width, int height, double pixel) {
  Camera camera = front_camera(width, height);
  camera.position = {0, -3, 0};
  camera.projection = Projection::orthographic;
  camera.height_world = height * pixel;
  return camera;
}

// Round gaps of a plane while the camera pans by 0.8 px a frame: the wider, the less of them is closed, and
// nothing pops.
TEST_F(SurfaceDiscs, GapsCloseByTheirSizeAndDoNotPop) {
  const double spacing = 0.02, pixel = spacing / 3.5;  // the gap of 8 spacings is 28 px wide
  const std::vector<double> gaps{2, 4.65, 8, 12, 16};
  const auto middle = [](std::size_t k) { return (double(k) - 2) * 0.45; };
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  PointCloud cloud;
  for (int i = 0; i < int(4 * 1.6 * 0.5 / spacing / spacing); ++i) {
    const double x = 1.6 * uniform(random), z = 0.5 * uniform(random);
    bool open = false;
    for (std::size_t k = 0; k < gaps.size(); ++k)
      open |= std::hypot(x - middle(k), z) < gaps[k] / 2 * spacing;
    if (!open) cloud.positions.push_back(vec3(float(x), 0, float(z)));
  }
  cloud.colors.assign(cloud.size(), {180, 180, 180, 255});
  Renderer renderer(context());
  show(renderer, cloud, {});
  const Camera camera = camera_before(560, 120, pixel);
  std::vector<double> sums(gaps.size()), last(gaps.size()), jumps(gaps.size());
  constexpr int frames = 8;
  for (int n = 0; n < frames; ++n) {
    Camera moved = camera;
    moved.position.x += 0.8 * pixel * n, moved.target.x += 0.8 * pixel * n;
    const RenderOutput out = picture(renderer, "surface", moved);
    for (std::size_t k = 0; k < gaps.size(); ++k) {
      int all = 0, filled = 0;
      for (int y = 0; y < 120; ++y)
        for (int x = 0; x < 560; ++x) {
          const double dx = (x + 0.5 - 280) * pixel + moved.target.x - middle(k), dy = (y + 0.5 - 60) * pixel;
          if (std::hypot(dx, dy) < gaps[k] / 2 * spacing) ++all, filled += out.color_linear.at(x, y).a > 0.5f;
        }
      const double share = double(filled) / all;
      if (n > 0) jumps[k] = std::max(jumps[k], std::abs(share - last[k]));
      sums[k] += share / frames, last[k] = share;
    }
  }
  for (std::size_t k = 0; k < gaps.size(); ++k) {
    std::cout << gaps[k] << " spacings: " << 100 * sums[k] << " % filled, at most " << 100 * jumps[k]
              << " % a frame\n";
    if (k > 0) EXPECT_LE(sums[k], sums[k - 1]);
    EXPECT_LE(jumps[k],
              0.1);  // 5 % is the goal; a disc that comes and goes is worth 16 % of the gap of 8 spacings
  }
  EXPECT_GT(sums[1], 0.99);
  EXPECT_LT(sums.back(), 0.5);
}

// Leaves with a wall behind them: openings too wide to close, yet so narrow that hidden point removal takes
// the wall for hidden: rather that than the background.
TEST_F(SurfaceDiscs, WhatLiesBehindAnOpeningIsSeen) {
  const double spacing = 0.02, pixel = spacing / 4;
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<glm::dvec2> openings;
  for (int i = 0; i < 60; ++i) openings.emplace_back(uniform(random), 0.6 * uniform(random));
  PointCloud cloud;
  for (int i = 0; i < int(2 * 4 * 0.6 / spacing / spacing); ++i) {
    const glm::dvec2 at(uniform(random), 0.6 * uniform(random));
    const bool is_leaf = i % 2 == 0;
    bool is_open = false;
    for (const glm::dvec2& opening : openings)
      is_open |= is_leaf && glm::distance(at, opening) < 3.5 * spacing;
    if (!is_open) cloud.positions.push_back(vec3(float(at.x), is_leaf ? 0 : 1, float(at.y)));
  }
  cloud.colors.assign(cloud.size(), {180, 180, 180, 255});
  Renderer renderer(context());
  show(renderer, cloud, {});
  const Camera camera = camera_before(320, 180, pixel);
  const RenderOutput out = picture(renderer, "surface", camera);
  int background = 0, wall = 0;
  for (int y = 0; y < 180; ++y)
    for (int x = 0; x < 320; ++x) {
      const float depth = out.depth.at(x, y);
      background += std::isinf(depth);
      wall += std::abs(depth - 4) < 0.05;
    }
  const double all = 320 * 180;
  std::cout << 100 * background / all << " % background, " << 100 * wall / all << " % wall\n";
  EXPECT_LT(background / all,
            0.0125);  // 2.55 % when hidden points are left out, half of it at most is to stay
  EXPECT_GT(wall / all, 0.1);
}

}  // namespace
