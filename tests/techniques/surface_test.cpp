#include <algorithm>
#include <numeric>

#include "core/error.h"
#include "passes/points_to_pixels.h"
#include "reference/gl_fixture.h"
#include "reference/screen_oracle.h"
#include "reference/surface_scenes.h"
#include "techniques/surface/screen_operators.h"

using namespace sfumato;
using namespace sfumato::testing;
using surface::HiddenPoints;
using surface::LevelNormals;
using surface::Removal;

namespace {

class Surface : public GlTest {};

Camera wide_camera(int width, int height, Projection projection = Projection::perspective) {
  Camera camera = front_camera(width, height);
  camera.projection = projection;
  camera.height_world = 3;
  camera.near_plane = 1;
  camera.far_plane = 12;
  return camera;
}

/// A depth image as the operators get it, and what they make of it.
struct Operators {
  Camera camera;
  Image<float> depth;
  View view;
  NearestPyramid pyramid;
  HiddenPoints hidden_points;

  Operators(const Camera& c, const Image<float>& d, float spacing) : camera(c), depth(d), view(c, dvec3(0)) {
    pyramid.points(d.width(), d.height()).upload(eye_positions(c, d, spacing));
    pyramid.build();
  }
  Image<float> mean(const HiddenPoints::Options& options) {
    view.bind();
    hidden_points.run(pyramid, options);
    return hidden_points.mean().download<float>();
  }
  /// Bilinear between the squares of the coarse map.
  double level_at(const Image<float>& levels, int coarse_level, int x, int y) const {
    const double sx = (x + 0.5) / (1 << coarse_level) - 0.5, sy = (y + 0.5) / (1 << coarse_level) - 0.5;
    const int ix = int(std::floor(sx)), iy = int(std::floor(sy));
    const auto at = [&](int i, int j) {
      return double(levels.at(std::clamp(i, 0, levels.width() - 1), std::clamp(j, 0, levels.height() - 1)));
    };
    const double tx = sx - ix, ty = sy - iy;
    return (1 - ty) * ((1 - tx) * at(ix, iy) + tx * at(ix + 1, iy)) +
           ty * ((1 - tx) * at(ix, iy + 1) + tx * at(ix + 1, iy + 1));
  }
};

/// One point in each block of `block` x `block` pixels, at a random pixel; `depth_of(x, y)` is the surface.
template <class F>
void add_layer(Image<float>& depth, int block, F depth_of, unsigned seed = 3) {
  std::mt19937 random(seed);
  for (int y = 0; y + block <= depth.height(); y += block)
    for (int x = 0; x + block <= depth.width(); x += block) {
      const int px = x + int(random() % unsigned(block)), py = y + int(random() % unsigned(block));
      depth.at(px, py) = std::min(depth.at(px, py), float(depth_of(px + 0.5, py + 0.5)));
    }
}

TEST_F(Surface, MeanOcclusionAndFetchesAreThoseOfThePaper) {
  for (Projection projection : {Projection::perspective, Projection::orthographic}) {
    const Camera camera = wide_camera(128, 64, projection);
    Image<float> depth(128, 64, INFINITY);
    add_layer(depth, 5, [](double x, double) { return x < 70 ? 3 + x / 100 : 9; });
    add_layer(
        depth, 9, [](double, double y) { return 4 + y / 50; }, 8);
    const float spacing = projection == Projection::perspective ? 0.25f : 0.06f;
    Operators on_screen(camera, depth, spacing);
    for (float scale : {1.0f, 3.0f, 6.0f}) {
      HiddenPoints::Options options;
      options.removal_scale = scale;
      options.gap_scale = 0.7f * scale;
      options.disc_radius = 0.8f;
      options.count_fetches = true;
      const Image<float> mean = on_screen.mean(options);
      const Image<float> levels = on_screen.hidden_points.levels().download<float>();
      const Image<float> fetches = on_screen.hidden_points.fetches().download<float>();
      // Eq. 1 where the square of the coarse map holds a point.
      for (int y = 0; y < levels.height(); ++y)
        for (int x = 0; x < levels.width(); ++x)
          if (const auto nearest = nearest_in_square(camera, depth, x, y, options.coarse_level)) {
            const double z = projection == Projection::perspective ? -nearest->z : 1;
            const double level = std::log2(scale * spacing * camera.pixels_per_unit() / z);
            ASSERT_NEAR(levels.at(x, y), std::clamp(level, 0.0, 6.0), 1e-5);  // log2 of software GL: 1e-6
          }
      for (int y = 0; y < 64; y += 3)
        for (int x = 1; x < 128; x += 5) {
          double level = on_screen.level_at(levels, options.coarse_level, x, y);
          if (std::isinf(depth.at(x, y))) level = std::max(0.0, level + std::log2(0.7));
          if (std::abs(level - std::round(level)) < 1e-5) continue;  // either side of a step in the count
          const MeanOcclusion expected = mean_occlusion(camera, depth, x, y, level, 0.8, spacing);
          ASSERT_EQ(fetches.at(x, y), 8 * (std::ceil(level) + 1));
          ASSERT_EQ(expected.looked_at, int(fetches.at(x, y)));
          // Cosines of float differences of positions near 10: 2e-6 / the smallest distance, 0.002.
          ASSERT_NEAR(mean.at(x, y), expected.mean, 1e-3) << x << " " << y << " level " << level;
        }
    }
  }
}

// Tiles without a point in reach are not even looked at: that must not show.
TEST_F(Surface, SkippedTilesAreOpenSky) {
  const Camera camera = wide_camera(256, 192);
  Image<float> depth(256, 192, INFINITY);
  add_layer(depth, 7, [](double x, double y) {
    return std::hypot(x - 200, y - 40) < 30 ? 3 + x / 100 + y / 77 : INFINITY;
  });
  depth.at(20, 150) = 3;
  for (float spacing : {0.03f, 0.12f}) {
    Operators on_screen(camera, depth, spacing);
    HiddenPoints::Options options;
    options.gap_scale = 8;
    const Image<float> mean = on_screen.mean(options);
    const Image<float> levels = on_screen.hidden_points.levels().download<float>();
    const Image<float> tiles = on_screen.hidden_points.tiles().on.download<float>();
    const int size = on_screen.hidden_points.tiles().size;
    int skipped = 0;
    for (int y = 0; y < 192; ++y)
      for (int x = 0; x < 256; ++x) {
        double level = on_screen.level_at(levels, options.coarse_level, x, y);
        if (std::isinf(depth.at(x, y))) level = std::clamp(level + std::log2(0.8), 0.0, 6.0);
        skipped += tiles.at(x / size, y / size) == 0;
        if (tiles.at(x / size, y / size) > 0 && (x % 5 || y % 3)) continue;  // the rest is tested above
        const double expected = mean_occlusion(camera, depth, x, y, level, options.disc_radius, spacing).mean;
        ASSERT_NEAR(mean.at(x, y), expected, 1e-3) << x << " " << y;
      }
    EXPECT_GT(skipped, 3000);
  }
}

// Neighbouring tiles look at levels of their own, and none of them past the end of another one's.
TEST_F(Surface, NoTileWithAPointIsSkipped) {
  const Camera camera = wide_camera(1024, 768);
  for (const float spacing : {0.1f, 0.03f, 0.01f}) {
    Image<float> depth(1024, 768, INFINITY);
    std::mt19937 random(5);
    std::uniform_real_distribution<float> uniform(0, 1);
    for (int y = 16; y < 768; y += 32)
      for (int x = 16; x < 1024; x += 32)
        if (uniform(random) < 0.03f) depth.at(x, y) = std::exp2(6 * uniform(random));
    Operators on_screen(camera, depth, spacing);
    HiddenPoints::Options options;
    options.removal_scale = 4;
    on_screen.view.bind();
    on_screen.hidden_points.run_squares(on_screen.pyramid, options);
    const Image<float> tiles = on_screen.hidden_points.tiles().on.download<float>();
    ASSERT_EQ(tiles.width(), 32);
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < 32; ++x)
        if (std::isfinite(depth.at(32 * x + 16, 32 * y + 16))) EXPECT_GT(tiles.at(x, y), 0) << x << " " << y;
  }
}

TEST_F(Surface, TwiceTheReachCostsOneRingMore) {
  const Camera camera = wide_camera(64, 64);
  Image<float> depth(64, 64, 3.0f);
  Operators on_screen(camera, depth, 0.3f);
  float before = 0;
  for (float scale : {1.0f, 2.0f, 4.0f}) {
    HiddenPoints::Options options;
    options.removal_scale = scale;
    options.count_fetches = true;
    on_screen.mean(options);
    const float count = on_screen.hidden_points.fetches().download<float>().at(30, 30);
    if (before > 0) EXPECT_EQ(count, before + 8);
    before = count;
  }
}

TEST_F(Surface, WindowIsTheExhaustiveOperator) {
  const Camera camera = wide_camera(64, 64);
  Image<float> depth(64, 64, INFINITY);
  add_layer(depth, 4, [](double x, double) { return x < 30 ? 3 : 5; });
  Operators on_screen(camera, depth, 0.1f);
  HiddenPoints::Options options;
  options.method = Removal::window;
  options.window_radius = 7;
  options.disc_radius = 0;
  const Image<float> mean = on_screen.mean(options);
  for (int y = 0; y < 64; y += 3)
    for (int x = 0; x < 64; x += 3)
      ASSERT_NEAR(mean.at(x, y), window_occlusion(camera, depth, x, y, 7), 1e-4);
}

TEST_F(Surface, BothWrappersGiveTheSameMean) {
  const Camera camera = wide_camera(64, 64);
  Image<float> depth(64, 64, INFINITY);
  add_layer(depth, 4, [](double x, double) { return x < 30 ? 3 : 5; });
  Image<float> means[2];
  int k = 0;
  for (const ScreenPassKind kind : {ScreenPassKind::fragment, ScreenPassKind::compute}) {
    const WithPreference with(&gl::Preferences::screen_passes, kind);
    Operators on_screen(camera, depth, 0.1f);
    means[k++] = on_screen.mean({});
  }
  for (std::size_t i = 0; i < means[0].size(); ++i) ASSERT_EQ(means[0].data()[i], means[1].data()[i]);
}

TEST_F(Surface, NoPointOfATiltedPlaneIsRemoved) {
  // Rays of the perspective camera meet the plane at up to 22 degrees more than its tilt.
  for (auto [projection, tilt_deg] : {std::pair{Projection::perspective, 0.0},
                                      {Projection::perspective, 30.0},
                                      {Projection::perspective, 60.0},
                                      {Projection::perspective, 75.0},
                                      {Projection::orthographic, 30.0},
                                      {Projection::orthographic, 80.0}}) {
    const Camera camera = wide_camera(128, 128, projection);
    const double k = camera.pixels_per_unit(), slope = std::tan(glm::radians(tilt_deg));
    const bool parallel = projection == Projection::orthographic;
    Image<float> depth(128, 128, INFINITY);
    add_layer(depth, 3, [&](double x, double) {
      const double across = (x - 64) / k, z = parallel ? 12 + across * slope : 4 / (1 + across * slope);
      return z > 0.5 && z < 40 ? z : INFINITY;
    });
    Operators on_screen(camera, depth, float((parallel ? 3 : 3 * 4) / k));
    const Image<float> mean = on_screen.mean({});
    for (std::size_t i = 0; i < mean.size(); ++i)
      if (!std::isinf(depth.data()[i])) ASSERT_GE(mean.data()[i], 0.1f) << tilt_deg;
  }
}

TEST_F(Surface, ARearSheetIsRemovedWhereItIsFarEnoughBehind) {
  const Camera camera = wide_camera(192, 192);
  const double spacing = 3 * 4 / camera.pixels_per_unit();
  for (auto [behind, least, most] : {std::tuple{10.0, 0.99, 1.0}, {0.5, 0.0, 0.0}}) {
    Image<float> front(192, 192, INFINITY), both(192, 192, INFINITY);
    add_layer(
        front, 3, [](double, double) { return 4.0; }, 3);
    both = front;
    add_layer(
        both, 3, [&](double, double) { return 4 + behind * spacing; }, 9);
    Operators on_screen(camera, both, float(spacing));
    const Image<float> mean = on_screen.mean({});
    int rear = 0, removed = 0;
    for (int y = 32; y < 160; ++y)  // away from the border, where one side is open
      for (int x = 32; x < 160; ++x) {
        if (both.at(x, y) > 4.0f && !std::isinf(both.at(x, y))) ++rear, removed += mean.at(x, y) < 0.1f;
        if (both.at(x, y) == 4.0f) ASSERT_GE(mean.at(x, y), 0.1f);
      }
    ASSERT_GT(rear, 500);
    EXPECT_GE(removed, least * rear) << behind;
    EXPECT_LE(removed, most * rear) << behind;
  }
}

TEST_F(Surface, GapsInsideAreFilledAndTheOutsideStaysOutside) {
  const Camera camera = wide_camera(192, 192);
  const double spacing = 3 * 4 / camera.pixels_per_unit();
  Image<float> depth(192, 192, INFINITY);
  add_layer(depth, 3, [](double x, double y) { return std::hypot(x - 96, y - 96) < 60 ? 4.0 : INFINITY; });
  Operators on_screen(camera, depth, float(spacing));
  const Image<float> mean = on_screen.mean({});
  for (int y = 0; y < 192; ++y)
    for (int x = 0; x < 192; ++x) {
      if (!std::isinf(depth.at(x, y))) continue;
      const double r = std::hypot(x + 0.5 - 96, y + 0.5 - 96);
      if (r < 45)
        ASSERT_LT(mean.at(x, y), 0.1f) << x << " " << y;  // as far inside as the operator looks: 15 px
      if (r > 62) ASSERT_GE(mean.at(x, y), 0.1f) << x << " " << y;
    }
}

// A sphere whose depths are given on every pixel: its normals on each level are those of the geometry.
TEST_F(Surface, LevelNormalsAreThoseOfASphere) {
  const Camera camera = wide_camera(128, 128);
  const View view(camera, dvec3(0));
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0, 0.002);
  Image<float> truth(128, 128, 6.0f), noisy(128, 128, 6.0f);
  const dvec3 center(0, 0, -4);
  const auto sphere_at = [&](double x, double y) -> std::optional<dvec3> {
    const dvec3 ray = glm::normalize(unproject(camera, x, y, 1));
    const double b = glm::dot(ray, center), d = b * b - 16 + 1;
    return d < 0 ? std::nullopt : std::optional(ray * (b - std::sqrt(d)));
  };
  for (int y = 0; y < 128; ++y)
    for (int x = 0; x < 128; ++x)
      if (const auto p = sphere_at(x + 0.5, y + 0.5)) {
        truth.at(x, y) = float(-p->z);
        noisy.at(x, y) = float(-p->z + noise(random));
      }
  double noisy_error[5] = {};
  for (bool with_noise : {false, true}) {
    PullPush pull_push;
    Image<vec4> a(128, 128, vec4(1));
    for (std::size_t i = 0; i < a.size(); ++i) a.data()[i].x = (with_noise ? noisy : truth).data()[i];
    gl::Texture seeds("seeds", GL_RGBA32F, 128, 128);
    seeds.upload(a);
    pull_push.run(seeds, seeds);
    view.bind();
    LevelNormals level_normals;
    level_normals.run(pull_push.filled(), 0, 4);
    for (int l = 0; l <= 4; ++l) {
      const Image<vec4> normals = level_normals.level(l).download<vec4>();
      std::vector<double> errors;
      for (int y = 0; y < normals.height(); ++y)
        for (int x = 0; x < normals.width(); ++x) {
          const double px = (x + 0.5) * (1 << l), py = (y + 0.5) * (1 << l);
          if (std::hypot(px - 64, py - 64) > 24) continue;  // of 40: away from the rim
          const dvec3 expected = glm::normalize(*sphere_at(px, py) - center);
          errors.push_back(
              glm::degrees(std::acos(std::min(1.0, std::abs(glm::dot(expected, dvec3(normals.at(x, y))))))));
        }
      const double worst = *std::max_element(errors.begin(), errors.end());
      // A texel of level 3 is a fifth of the radius.
      if (!with_noise && l <= 2) EXPECT_LT(worst, 3) << l;
      if (with_noise)
        noisy_error[l] = std::accumulate(errors.begin(), errors.end(), 0.0) / double(errors.size());
    }
  }
  EXPECT_LT(noisy_error[1], 0.7 * noisy_error[0]);
  EXPECT_LT(noisy_error[2], 0.7 * noisy_error[1]);
}

/// A square grid of points that reaches beyond the view on every side.
PointCloud wall_cloud(double spacing, double half) {
  PointCloud cloud;
  std::mt19937 random(6);
  std::uniform_real_distribution<double> jitter(-0.5, 0.5);
  for (double x = -half; x < half; x += spacing)
    for (double z = -half; z < half; z += spacing)
      cloud.positions.push_back(vec3(x + spacing * jitter(random), 0, z + spacing * jitter(random)));
  cloud.colors.assign(cloud.size(), {200, 100, 50, 255});
  return cloud;
}

TEST_F(Surface, AWallThatFillsTheViewIsFilled) {
  Renderer renderer(context());
  auto technique = find_technique("surface").create();
  for (Projection projection : {Projection::perspective, Projection::orthographic}) {
    Camera camera = front_camera(160, 120);
    camera.projection = projection;
    camera.height_world = 3.3;
    show(renderer,
         wall_cloud(3 * 4 / camera.pixels_per_unit() * (projection == Projection::perspective ? 1 : 0.25), 4),
         {});
    RenderSettings settings;
    settings.transparent = true;
    const RenderOutput out = renderer.render(*technique, camera, settings, all_outputs());
    for (const vec4& c : out.color_linear) ASSERT_EQ(c.a, 1.0f);
    for (float z : out.depth) ASSERT_FALSE(std::isinf(z));
  }
}

TEST_F(Surface, BothWrappersGiveTheSamePicture) {
  Image<Rgba8> pictures[2];
  int k = 0;
  for (const ScreenPassKind kind : {ScreenPassKind::fragment, ScreenPassKind::compute}) {
    const WithPreference with(&gl::Preferences::screen_passes, kind);
    Renderer renderer(context());
    auto technique = find_technique("surface").create();
    show(renderer, sphere_cloud(5000), {});
    pictures[k++] = renderer.render(*technique, front_camera(96, 64), RenderSettings{}).rgba8;
  }
  int different = 0;
  for (std::size_t i = 0; i < pictures[0].size(); ++i)
    different += !(pictures[0].data()[i] == pictures[1].data()[i]);
  EXPECT_EQ(different, 0);
}

TEST_F(Surface, ShadowFactorReachesThePicture) {
  PreparedCloud prepared = analysis::prepare(sphere_cloud(20000), {}, {});
  GpuCloud cloud(prepared, colors_of(prepared.cloud));
  std::vector<float> shadow(prepared.cloud.size(), 0.25f);
  cloud.set_shadow(shadow);
  Camera camera = front_camera(64, 64);
  camera.fit_depth_range(cloud.bounds());
  auto technique = find_technique("surface").create();
  const RenderSettings settings;
  Target target(64, 64);
  gl::Timers timers(false);
  Frame frame{cloud, camera, settings, Light{}, target, true, timers, no_progress()};
  technique->render(frame);
  EXPECT_NEAR(target.normal.download<vec4>().at(32, 32).w, 0.25, 1e-5);
}

TEST_F(Surface, ShowsTheOperatorAtWork) {
  Renderer renderer(context());
  auto technique = find_technique("surface").create();
  show(renderer, sphere_cloud(3000), {});
  RenderSettings settings;
  settings.transparent = true;
  settings.shading = Shading::hidden;
  const RenderOutput out = renderer.render(*technique, front_camera(96, 96), settings, all_outputs());
  int visible = 0, hidden = 0, other = 0;
  for (const vec4& c : out.color_linear) {
    if (c.a == 0) continue;
    if (c == vec4(0.8f, 0, 0, 1))
      ++visible;
    else if (c == vec4(0, 0.6f, 0, 1))
      ++hidden;
    else
      ++other;
  }
  EXPECT_GT(visible, 300);
  EXPECT_GT(hidden, 100);  // the far half of the sphere, seen through the near one
  EXPECT_EQ(other, 0);
  set_parameter(*technique, "hidden_point_removal", "none");
  for (const vec4& c :
       renderer.render(*technique, front_camera(96, 96), settings, all_outputs()).color_linear)
    ASSERT_FALSE(c == vec4(0, 0.6f, 0, 1));

  auto points = find_technique("points").create();
  EXPECT_THROW(renderer.render(*points, front_camera(96, 96), settings), Error);
}

// The pictures against the truth: one point per 3x3 pixels on what is seen, and about as many on what is not.
struct Bound {
  const char* scene;
  int block;
};
class SurfaceTruth : public Surface, public ::testing::WithParamInterface<Bound> {};

TEST_P(SurfaceTruth, TheSurfaceIsWhereTheSceneHasIt) {
  const auto [name, block] = GetParam();
  const Camera camera = scene_camera(name, 640, 480);
  const Deviation d = deviation_from_truth(name, camera, block, context());
  RecordProperty("deviation", to_string(d));
  std::cout << name << ": " << to_string(d) << "\n";
  EXPECT_GE(d.filled, 0.99);
  EXPECT_LE(d.deeper, block == 2 ? 0.005 : 0.02);
  EXPECT_LE(d.nearer, 0.02);
  EXPECT_LE(d.background_per_outline, 1.5);
  EXPECT_LE(d.median_depth_spacings, 1);
  EXPECT_LE(d.median_normal_deg, 4);
}

INSTANTIATE_TEST_SUITE_P(Scenes, SurfaceTruth,
                         ::testing::Values(Bound{"spheres", 3}, Bound{"tori", 3}, Bound{"room", 3},
                                           Bound{"spheres", 2}, Bound{"tori", 2}, Bound{"room", 2}),
                         [](const auto& i) { return i.param.scene + std::to_string(i.param.block); });

/// Mean over pixels and channels of the change between two pictures, 8-bit steps.
double change(const Image<Rgba8>& a, const Image<Rgba8>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Rgba8 &p = a.data()[i], &q = b.data()[i];
    sum += std::abs(p.r - q.r) + std::abs(p.g - q.g) + std::abs(p.b - q.b);
  }
  return sum / 3 / double(a.size());
}

TEST_F(Surface, MovesMoreQuietlyThanPoints) {
  Camera camera = scene_camera("spheres", 240, 180);
  Renderer renderer(context());
  show(renderer, scene_cloud("spheres", camera, 3), {});
  auto surface = find_technique("surface").create(), points = find_technique("points").create();
  set_parameter(*points, "size_mode", "pixels");
  set_parameter(*points, "point_size", "1");
  RenderSettings settings;
  settings.edl.user = false;
  double sums[2] = {0, 0}, largest = 0;
  Image<Rgba8> last[2];
  const dvec3 from = camera.position - camera.target;
  for (int frame = 0; frame < 8; ++frame) {
    const double angle = glm::radians(0.2 * frame);
    camera.position = camera.target + dvec3(std::cos(angle) * from.x - std::sin(angle) * from.y,
                                            std::sin(angle) * from.x + std::cos(angle) * from.y, from.z);
    int k = 0;
    for (Technique* technique : {surface.get(), points.get()}) {
      const Image<Rgba8> now = renderer.render(*technique, camera, settings).rgba8;
      if (frame > 0) sums[k] += change(last[k], now);
      if (frame > 0 && k == 0) largest = std::max(largest, change(last[k], now));
      last[k++] = now;
    }
  }
  std::cout << "motion: surface " << sums[0] / 7 << ", points " << sums[1] / 7 << " steps of 255 a frame\n";
  EXPECT_LE(sums[0], 0.5 * sums[1]);
  EXPECT_LE(largest, 1.5 * sums[0] / 7);  // no frame stands out: levels do not pop
}

}  // namespace
