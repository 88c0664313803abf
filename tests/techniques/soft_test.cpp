// Soft transparency against closed forms and a double-precision oracle that integrates densities numerically.
#include <array>
#include <random>

#include "core/error.h"
#include "reference/compare.h"
#include "reference/gl_fixture.h"
#include "reference/soft_oracle.h"
#include "reference/splat_oracle.h"
#include "techniques/soft/express.h"
#include "techniques/soft/field.h"
#include "techniques/soft/interior.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

struct Ball {
  vec3 center{0};
  float radius = 0.5f;
  Rgba8 color{200, 100, 50, 255};
  float field = 1;
  vec3 normal{0, -1, 0};
};

PointCloud cloud_of(const std::vector<Ball>& balls, double scale = 1) {
  PointCloud cloud;
  ScalarField field{"soft", 0, {}};
  for (const Ball& ball : balls) {
    cloud.positions.push_back(ball.center * float(scale));
    cloud.normals.push_back(ball.normal);
    cloud.radii.push_back(ball.radius * float(scale));
    cloud.colors.push_back(ball.color);
    field.values.push_back(ball.field);
  }
  cloud.set_scalar(std::move(field));
  return cloud;
}

/// Spheres of all sizes and colours in a ball of radius 1.
std::vector<Ball> ball_soup(int count, unsigned seed, float largest = 0.5f) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(-1, 1);
  auto code = [&] { return std::uint8_t(127.5f + 127.5f * uniform(random)); };
  std::vector<Ball> balls;
  while (int(balls.size()) < count) {
    const vec3 p(uniform(random), uniform(random), uniform(random));
    if (glm::length(p) > 1) continue;
    balls.push_back({p, largest * (0.3f + 0.7f * std::abs(uniform(random))), {code(), code(), code(), 255}});
  }
  return balls;
}

Camera camera_at(dvec3 position, int width, int height, double fov_deg = 45) {
  Camera camera;
  camera.position = position;
  camera.target = {0, 0, 0};
  camera.fov_y = glm::radians(fov_deg);
  camera.width = width;
  camera.height = height;
  return camera;
}

double lambda_of(double opacity) { return -std::log(1 - std::min(opacity, 0.999)); }

class Soft : public GlTest {
 protected:
  Soft() {
    settings_.transparent = true;
    settings_.shading = Shading::albedo;
    for (auto [name, value] : {std::pair{"field", "soft"}, {"field_threshold", "0.5"}, {"modulation_threshold", "0.5"},
                               {"antialias", "false"}, {"clamp_radius", "false"}, {"epsilon", "0.01"}})
      set(name, value);
  }
  void set(const std::string& name, const std::string& value) { set_parameter(*technique_, name, value); }
  void set_opacity(double value) { set("opacity", std::to_string(value)); }
  RenderOutput render(const PointCloud& cloud, const Camera& camera) {
    Renderer renderer(context());
    show(renderer, cloud, technique_->needs());
    return renderer.render(*technique_, camera, settings_, all_outputs());
  }
  RenderOutput render(const std::vector<Ball>& balls, const Camera& camera) { return render(cloud_of(balls), camera); }

  /// Alpha of the picture minus expected(delta) over the whole disc of a lone sphere: the largest difference.
  template <class Expected>
  double lone_sphere_error(const Ball& ball, const Camera& camera, Expected expected) {
    const RenderOutput out = render({ball}, camera);
    double worst = 0;
    int covered = 0;
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const OracleRay ray = oracle_ray(camera, x + 0.5, y + 0.5);
        const dvec3 away = dvec3(ball.center) - ray.origin;
        const double delta = glm::length(away - glm::dot(away, ray.direction) * ray.direction) / ball.radius;
        covered += delta < 1;
        worst = std::max(worst, std::abs(out.color_linear.at(x, y).a - (delta < 1 ? expected(delta) : 0.0)));
      }
    EXPECT_GT(covered, 50);
    return worst;
  }
  /// The picture against the oracle with these spheres; colours are 16-bit floats (5e-4), alpha is not.
  void expect_like_oracle(const std::vector<Ball>& balls, const Camera& asked, const SoftOracle& oracle,
                          double alpha_tolerance = 1e-4) {
    const PointCloud cloud = cloud_of(balls);
    const RenderOutput out = render(cloud, asked);
    Camera camera = asked;
    camera.fit_depth_range(bounds(cloud));
    std::vector<OracleSplat> solid;
    std::vector<OracleSphere> soft;
    const std::vector<OracleSplat> all = [&] {
      std::vector<OracleSplat> list = oracle_splats(cloud);
      return list;
    }();
    for (std::size_t i = 0; i < balls.size(); ++i)
      if (balls[i].field > 0.5f) soft.push_back({all[i].center, all[i].radius, all[i].color});
      else solid.push_back(all[i]);
    double worst_alpha = 0, worst_color = 0;
    int covered = 0;
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const OracleRay ray = oracle_ray(camera, x + 0.5, y + 0.5);
        const OracleSurface surface = oracle_surface(ray, solid, splat_near(camera), 0.01, wendland);
        if (surface.fragile) continue;
        const std::vector<OracleHit> hits = oracle_hits(ray, solid, splat_near(camera));
        const double solid_t = hits.empty() ? HUGE_VAL : hits.front().t;
        glm::dvec4 color = oracle.through(ray, soft, splat_near(camera) / ray.cosine, solid_t);
        if (surface.weight > 0) color += (1 - color.a) * glm::dvec4(surface.color, 1);
        const vec4 actual = out.color_linear.at(x, y);
        covered += color.a > 0;
        worst_alpha = std::max(worst_alpha, std::abs(actual.a - color.a));
        for (int k = 0; k < 3; ++k) worst_color = std::max(worst_color, std::abs(actual[k] - color[k]));
      }
    EXPECT_GT(covered, camera.width * camera.height / 8);
    EXPECT_LT(worst_alpha, alpha_tolerance);
    EXPECT_LT(worst_color, 1e-3);
  }
  std::unique_ptr<Technique> technique_ = find_technique("soft").create();
  RenderSettings settings_;
};

/// One sphere in the middle, one in the corner of a wide view (where eye depth is not the ray distance).
std::vector<std::pair<Ball, Camera>> lone_spheres() {
  Camera orthographic = camera_at({0, -3, 0}, 64, 64);
  orthographic.projection = Projection::orthographic;
  orthographic.height_world = 2;
  return {{Ball{{0, 0, 0}, 0.5f}, camera_at({0, -3, 0}, 64, 64)},
          {Ball{{1.2f, 0, 0.85f}, 0.4f}, camera_at({0, -1, 0}, 96, 72, 100)},
          {Ball{{0.2f, 0, 0.1f}, 0.7f}, orthographic}};
}

// A.7 test 1, and the other models' lone spheres. 1e-4: what float leaves of t - t_m at these distances, 1e-6 of the
// radius, goes through a square root at the rim.
TEST_F(Soft, LoneSphereIsTheClosedForm) {
  for (const auto& [ball, camera] : lone_spheres())
    for (double opacity : {0.15, 0.6, 1.0}) {
      SCOPED_TRACE(std::to_string(opacity) + " at " + std::to_string(ball.center.x));
      set_opacity(opacity);
      const double lambda = lambda_of(opacity);
      set("model", "base");
      EXPECT_LT(lone_sphere_error(ball, camera, [&](double d) { return 1 - std::exp(-lambda * closed_form(d)); }), 1e-4);
      set("density", "uniform");
      EXPECT_LT(lone_sphere_error(ball, camera, [&](double d) { return 1 - std::exp(-lambda * std::sqrt(1 - d * d)); }), 1e-4);
      set("density", "radial");
      set("model", "express");
      EXPECT_LT(lone_sphere_error(ball, camera, [&](double d) { return opacity * (std::cos(std::acos(-1) * d) + 1) / 2; }), 1e-4);
      set("model", "concentric");
      set("concentric_count", "7");
      EXPECT_LT(lone_sphere_error(ball, camera, [&](double d) { return 1 - std::exp(-lambda * shell_sum(7, d)); }), 1e-4);
      set("concentric_count", "auto");
    }
}

// One number means the same on a figurine and on a city.
TEST_F(Soft, ScaleDoesNotMatter) {
  const std::vector<Ball> balls = ball_soup(20, 3);
  for (const char* model : {"express", "base", "concentric"}) {
    set("model", model);
    const RenderOutput small = render(cloud_of(balls, 0.01), camera_at({0, -0.03, 0}, 48, 48));
    const RenderOutput large = render(cloud_of(balls, 1000), camera_at({0, -3000, 0}, 48, 48));
    for (std::size_t i = 0; i < small.color_linear.size(); ++i)
      ASSERT_NEAR(small.color_linear.data()[i].a, large.color_linear.data()[i].a, 2e-4) << model;
  }
}

// A.7 test 2: total alpha = 1 - exp(-sum tau_i) for any overlap and any order.
TEST_F(Soft, OverlappingSpheresAddUp) {
  for (int count : {2, 50}) {
    std::vector<Ball> balls = ball_soup(count, 17);
    for (Ball& ball : balls) ball.color = {200, 100, 50, 255};
    const Camera camera = camera_at({0, -4, 0}, 64, 64);
    set("model", "base");
    const RenderOutput out = render(balls, camera);
    double worst = 0;
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        const OracleRay ray = oracle_ray(camera, x + 0.5, y + 0.5);
        double depth = 0;
        for (const Ball& ball : balls) {
          const dvec3 away = dvec3(ball.center) - ray.origin;
          const double d = glm::length(away - glm::dot(away, ray.direction) * ray.direction) / ball.radius;
          if (d < 1) depth += lambda_of(0.3) * closed_form(d);
        }
        worst = std::max(worst, std::abs(out.color_linear.at(x, y).a - (1 - std::exp(-depth))));
      }
    EXPECT_LT(worst, 1e-4) << count;
  }
}

// A.7 test 3: in the lens the colours mix by w = 1 - d/r (Eq. 12), within one 8-bit step.
TEST_F(Soft, LensMixesColours) {
  set("model", "base");
  set_opacity(0.5);
  const std::vector<Ball> balls{{{0, 0, 0}, 0.5f, {255, 0, 0, 255}}, {{0.2f, 0, 0}, 0.6f, {0, 0, 255, 255}}};
  const Camera camera = camera_at({0, -100, 0}, 64, 64, 1.2);
  const RenderOutput out = render(balls, camera);
  SoftOracle oracle;
  oracle.opacity = 0.5;
  int lens = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const OracleRay ray = oracle_ray(camera, x + 0.5, y + 0.5);
      const double a = ray_delta(ray, balls[0].center, 0.5), b = ray_delta(ray, balls[1].center, 0.6);
      if (a >= 1 || b >= 1) continue;
      ++lens;
      const glm::dvec4 expected = oracle.through(ray, {{balls[0].center, 0.5, {1, 0, 0}}, {balls[1].center, 0.6, {0, 0, 1}}}, 0, HUGE_VAL);
      for (int k = 0; k < 3; ++k) ASSERT_NEAR(out.color_linear.at(x, y)[k], expected[k], 1.0 / 255);
    }
  EXPECT_GT(lens, 500);
  const std::vector<Ball> same{{{0, 0, 0}, 0.5f, {255, 0, 0, 255}}, {{0, 0, 0}, 0.5f, {0, 0, 255, 255}}};
  const vec4 middle = render(same, camera).color_linear.at(32, 32);
  EXPECT_NEAR(middle.r / middle.a, 0.5, 1e-3);
  EXPECT_NEAR(middle.b / middle.a, 0.5, 1e-3);
}

// Coloured spheres, some cut by solid discs and some by the near plane (the camera stands among them).
TEST_F(Soft, InteriorModelsMatchTheOracle) {
  std::vector<Ball> balls = ball_soup(24, 5);
  for (int i = 0; i < 6; ++i) balls[std::size_t(i)].field = 0;
  for (Ball& ball : balls) ball.normal = glm::normalize(vec3(0.3f, -1, 0.2f));
  for (const Camera& camera : {camera_at({0.3, -3, 0.4}, 48, 40), camera_at({0, -0.4, 0.1}, 48, 40, 90)}) {
    SoftOracle oracle;
    oracle.opacity = 0.4;
    set_opacity(0.4);
    set("model", "base");
    expect_like_oracle(balls, camera, oracle);
    set("model", "concentric");
    for (auto [name, normalization] : {std::pair{"exact", 0}, {"eq13", 1}, {"eq15", 2}}) {
      set("normalization", name);
      set("concentric_count", "3");
      oracle.shells = 3;
      oracle.normalization = normalization;
      expect_like_oracle(balls, camera, oracle);
    }
  }
}

TEST_F(Soft, ExpressBlendsFarToNear) {
  std::vector<Ball> balls = ball_soup(40, 6);
  for (int i = 0; i < 8; ++i) balls[std::size_t(i)].field = 0;
  set_opacity(0.5);
  SoftOracle oracle;
  oracle.opacity = 0.5;
  oracle.express = true;
  expect_like_oracle(balls, camera_at({0.3, -3, 0.4}, 48, 40), oracle);
}

// A.7 test 4. `exact`: 0 <= tau_N - T <= 2 sqrt(1-delta^2)/N (the bound of the Riemann sum), falling along N; in every
// normalisation the same depth through the centre for each N; Eqs. 13 and 15: the limits of notes A.2, halved.
TEST_F(Soft, NestedSpheresTendToTheirLimits) {
  set("model", "concentric");
  set_opacity(0.5);
  const Ball ball{{0, 0, 0}, 0.5f};
  const Camera camera = camera_at({0, -3, 0}, 65, 65);
  auto depth = [&](const char* normalization, int count) {
    set("normalization", normalization);
    set("concentric_count", std::to_string(count));
    return render({ball}, camera).color_linear;
  };
  auto each_pixel = [&](auto visit) {
    for (int y = 0; y < 65; ++y)
      for (int x = 0; x < 65; ++x) {
        const double delta = ray_delta(oracle_ray(camera, x + 0.5, y + 0.5), ball.center, ball.radius);
        if (delta < 0.97) visit(x, y, delta);
      }
  };
  auto tau = [](const Image<vec4>& image, int x, int y) { return -std::log(1 - double(image.at(x, y).a)) / lambda_of(0.5); };
  std::vector<Image<vec4>> exact;
  for (int count : {1, 3, 25, 400}) {
    exact.push_back(depth("exact", count));
    each_pixel([&](int x, int y, double delta) {
      const double above = tau(exact.back(), x, y) - closed_form(delta);
      // 1e-5: sums of 400 floats, and alpha through a logarithm.
      ASSERT_GE(above, -1e-5) << count;
      ASSERT_LE(above, 2 * std::sqrt(1 - delta * delta) / count + 1e-5) << count;
      if (exact.size() > 1) ASSERT_LE(tau(exact.back(), x, y), tau(exact[exact.size() - 2], x, y) + 1e-5);
    });
  }
  for (const char* name : {"exact", "eq13", "eq15"})
    for (int count : {1, 3, 25}) EXPECT_NEAR(tau(depth(name, count), 32, 32), 1, 1e-5) << name << count;
  for (auto [name, is_15] : {std::pair{"eq13", false}, {"eq15", true}}) {
    const Image<vec4> many = depth(name, 400);
    each_pixel([&](int x, int y, double d) {
      const double half = std::sqrt(1 - d * d);
      double limit = half - d * std::acos(d);
      if (is_15 && d > 0) limit -= d * (std::log((1 + half) / d) - half);
      // A Riemann sum of 400 steps over a density that is log-singular in the middle.
      if (d > 0.05) ASSERT_NEAR(tau(many, x, y), limit, 0.01) << name << " at " << d;
    });
  }
}

// A.7 test 5: largest opacity differences of the cosine from the exact integral, by opacity.
TEST_F(Soft, ExpressStaysNearBase) {
  for (auto [opacity, most] : {std::pair{0.05, 0.0037}, {0.1, 0.0080}, {0.2, 0.0185}, {0.3, 0.0321}, {0.5, 0.073}, {0.7, 0.145},
                               {0.9, 0.297}}) {
    set_opacity(opacity);
    const Camera camera = camera_at({0, -3, 0}, 64, 64);
    const std::vector<Ball> balls{{{0, 0, 0}, 0.8f}};
    set("model", "express");
    const RenderOutput express = render(balls, camera);
    set("model", "base");
    const RenderOutput base = render(balls, camera);
    double worst = 0;
    for (std::size_t i = 0; i < base.color_linear.size(); ++i)
      worst = std::max(worst, double(std::abs(express.color_linear.data()[i].a - base.color_linear.data()[i].a)));
    EXPECT_LE(worst, most + 1.0 / 255) << opacity;
    EXPECT_GE(worst, 0.9 * most - 1.0 / 255) << opacity << ": the table would prove nothing";
  }
}

/// What a technique does before Interior::draw, for tests that look inside.
struct InteriorScene {
  PreparedCloud prepared;
  GpuCloud gpu;
  Camera camera;
  Target target;
  gl::Timers timers{false};
  RenderSettings settings;
  Light light;
  Frame frame;
  View view;
  soft::SoftPoints points;
  gl::Texture solid_t, result;

  InteriorScene(const std::vector<Ball>& balls, const Camera& asked, float solid)
      : prepared(analysis::prepare(cloud_of(balls), {}, {})), gpu(prepared, colors_of(prepared.cloud)), camera(asked),
        target(asked.width, asked.height),
        frame{gpu, camera, settings, light, target, true, timers, no_progress()}, view(camera, prepared.cloud.origin),
        solid_t("solid", GL_R32F, asked.width, asked.height), result("result", GL_RGBA32F, asked.width, asked.height) {
    settings.shading = Shading::albedo;
    gpu.set_field(prepared.cloud.scalar("soft")->values);
    points.choose(gpu, prepared.cloud.scalar("soft")->values, 0.5f);
    soft::Look look;
    look.field_threshold = look.modulation_threshold = 0.5f;
    look.antialias = false;
    points.update(frame, view, look);
    solid_t.clear(vec4(solid));
    target.color.clear(vec4(0));
  }
};

// A.7 test 6: as many records stored as counted, two for each sphere or shell that is left after clamping.
TEST_F(Soft, FragmentsAreCountedAndStoredAlike) {
  const std::vector<Ball> balls = ball_soup(60, 8);
  const Camera camera = camera_at({0, -1.2, 0}, 40, 30, 70);
  for (bool concentric : {false, true}) {
    InteriorScene scene(balls, camera, 1.5f);
    soft::Interior interior;
    soft::InteriorSettings settings;
    settings.concentric = concentric;
    interior.draw(scene.points, scene.view, scene.solid_t, scene.target.color, scene.result, settings, false, scene.timers);
    const Image<float> counted = interior.list().counts().download<float>();  // the storing pass adds once more
    const Image<std::uint32_t> stored = interior.list().stored().download<std::uint32_t>();
    std::uint64_t total = 0, expected = 0;
    for (std::size_t i = 0; i < stored.size(); ++i) {
      ASSERT_EQ(counted.data()[i], 2.0f * float(stored.data()[i]));
      ASSERT_EQ(stored.data()[i] % 2, 0u);
      total += stored.data()[i];
    }
    EXPECT_EQ(total, interior.fragments());
    EXPECT_EQ(interior.overflows(), 0u);
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x)
        for (const Ball& ball : balls) {
          const OracleRay ray = oracle_ray(camera, x + 0.5, y + 0.5);
          const double delta = ray_delta(ray, ball.center, ball.radius), middle = glm::dot(dvec3(ball.center) - ray.origin, ray.direction);
          const double depth = glm::dot(dvec3(ball.center) - ray.origin, camera.direction());
          const double size_px = ball.radius * camera.pixels_per_unit() / std::max(depth, splat_near(camera));
          const int shells = concentric ? std::clamp(int(size_px / 4), 1, 32) : 1;
          for (int i = 0; i < shells && 1 - double(i) / shells > delta; ++i) {
            const double half = ball.radius * std::sqrt(std::pow(1 - double(i) / shells, 2) - delta * delta);
            if (std::max(middle - half, splat_near(camera) / ray.cosine) < std::min(middle + half, 1.5)) expected += 2;
          }
        }
    // Rims and clamped chords that rounding decides: one in ten thousand.
    EXPECT_NEAR(double(total), double(expected), 1 + 1e-4 * double(expected));
  }
}

// More than 256 records in a pixel are sorted in the buffer, more than 64 open spheres counted as overflow.
TEST_F(Soft, LongListsAndManyOpenSpheres) {
  const Camera camera = camera_at({0, -20, 0}, 24, 24, 4);
  std::vector<Ball> balls;
  std::mt19937 random(4);
  std::uniform_real_distribution<float> uniform(-1, 1);
  for (int i = 0; i < 300; ++i)
    balls.push_back({{0.2f * uniform(random), 8 * uniform(random), 0.2f * uniform(random)}, 0.4f, {std::uint8_t(i % 256), 128, 60, 255}});
  SoftOracle oracle;
  oracle.opacity = 0.02;
  set_opacity(0.02);
  set("model", "base");
  expect_like_oracle(balls, camera, oracle);
  for (Ball& ball : balls) ball.center.y *= 0.02f;  // all of them overlap
  const RenderOutput out = render(balls, camera);
  double worst = 0;
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 24; ++x) {
      double depth = 0;
      for (const Ball& ball : balls) {
        const double delta = ray_delta(oracle_ray(camera, x + 0.5, y + 0.5), ball.center, ball.radius);
        if (delta < 1) depth += lambda_of(0.02) * closed_form(delta);
      }
      worst = std::max(worst, std::abs(out.color_linear.at(x, y).a - (1 - std::exp(-depth))));
    }
  EXPECT_LT(worst, 1e-4) << "no opacity may be lost";
  EXPECT_TRUE(std::any_of(out.notes.begin(), out.notes.end(), [](const std::string& note) {
    return note.find("more than 64 spheres") != std::string::npos;
  }));
}

// A.7 test 7.
TEST_F(Soft, ThresholdAndOpacityAtTheirEnds) {
  std::vector<Ball> balls = ball_soup(60, 12);
  for (std::size_t i = 0; i < balls.size(); ++i) balls[i].field = i % 3 ? 0.2f : 0.9f;
  const Camera camera = camera_at({0, -4, 0}, 48, 48);
  auto splats = find_technique("splats").create();
  set_parameter(*splats, "radius_scale", "1");
  for (auto [name, value] : {std::pair{"antialias", "false"}, {"clamp_radius", "false"}, {"epsilon", "0.01"}})
    set_parameter(*splats, name, value);
  auto plain = [&](const std::vector<Ball>& some) {
    Renderer renderer(context());
    show(renderer, cloud_of(some), splats->needs());
    return renderer.render(*splats, camera, settings_, all_outputs());
  };
  auto expect_equal = [](const RenderOutput& a, const RenderOutput& b) {
    for (std::size_t i = 0; i < a.depth.size(); ++i) {
      // The same sums; the batches, and with them the order of adding, may differ.
      ASSERT_NEAR(glm::distance(a.color_linear.data()[i], b.color_linear.data()[i]), 0, 1e-5);
      ASSERT_EQ(std::isinf(a.depth.data()[i]), std::isinf(b.depth.data()[i]));
    }
  };
  std::vector<Ball> solid;
  for (const Ball& ball : balls)
    if (ball.field < 0.5f) solid.push_back(ball);
  for (const char* model : {"express", "base", "concentric", "one_layer"}) {
    SCOPED_TRACE(model);
    set("model", model);
    set("opacity", "0.5");
    set("field_threshold", "1");
    expect_equal(render(balls, camera), plain(balls));
    set("field_threshold", "0.5");
    if (model != std::string("one_layer")) {
      set("opacity", "0");
      expect_equal(render(balls, camera), plain(solid));
      set("opacity", "1");
      set("field_threshold", "-1");
      const RenderOutput all = render(balls, camera);
      for (float depth : all.depth) ASSERT_TRUE(std::isinf(depth)) << "no surface is left";
      EXPECT_GT(all.color_linear.at(24, 24).a, 0.9f);
    }
  }
}

// A.7 test 8: between the thresholds the shape goes from a cone to the model's own, without a step at either end.
TEST_F(Soft, ModulationIsContinuous) {
  const Camera camera = camera_at({0, -3, 0}, 48, 48);
  set("field_threshold", "0.5");
  set("modulation_threshold", "0.8");
  set_opacity(0.4);
  auto row = [&](float field) {
    const RenderOutput out = render({Ball{{0, 0, 0}, 0.7f, {200, 100, 50, 255}, field}}, camera);
    std::vector<double> alpha;
    for (int x = 0; x < 48; ++x) alpha.push_back(out.color_linear.at(x, 24).a);
    return alpha;
  };
  for (const char* model : {"express", "base", "concentric"}) {
    SCOPED_TRACE(model);
    set("model", model);
    set("modulation_threshold", "0.5");
    const std::vector<double> own = row(0.9f);
    set("modulation_threshold", "0.8");
    const std::vector<double> below = row(0.7999f), above = row(0.8001f), lowest = row(0.50001f), middle = row(0.65f);
    for (int x = 0; x < 48; ++x) {
      const double delta = ray_delta(oracle_ray(camera, x + 0.5, 24.5), dvec3(0), 0.7);
      const double cone = delta < 1 ? 0.4 * (1 - delta) : 0;
      EXPECT_NEAR(above[std::size_t(x)], own[std::size_t(x)], 1e-6);
      EXPECT_NEAR(below[std::size_t(x)], own[std::size_t(x)], 1e-3);  // the share is stored in 16 bits: 5e-4
      EXPECT_NEAR(lowest[std::size_t(x)], cone, 3e-4);
      EXPECT_NEAR(middle[std::size_t(x)], 0.5 * (cone + own[std::size_t(x)]), 3e-4);  // Eq. 22, W = 1/2
    }
  }
}

/// Discs on a grid in the plane y = `at`.
void add_sheet(std::vector<Ball>& balls, float at, Rgba8 color, float field) {
  for (int i = -8; i <= 8; ++i)
    for (int j = -8; j <= 8; ++j) balls.push_back({{0.1f * float(i), at, 0.1f * float(j)}, 0.12f, color, field});
}

// A.6: of two parallel soft sheets the first is transparent, the second opaque.
TEST_F(Soft, OneLayerShowsTheSecondSheetOpaque) {
  std::vector<Ball> balls;
  add_sheet(balls, 0, {255, 0, 0, 255}, 1);
  add_sheet(balls, 0.5f, {0, 0, 255, 255}, 1);
  const Camera camera = camera_at({0, -4, 0}, 32, 32, 15);
  set("model", "one_layer");
  set("opacity", "0.25");
  const RenderOutput out = render(balls, camera);
  const vec4 middle = out.color_linear.at(16, 16);
  EXPECT_NEAR(middle.r, 0.25, 1e-4);
  EXPECT_NEAR(middle.b, 0.75, 1e-4);
  EXPECT_NEAR(middle.a, 1, 1e-6);
  EXPECT_NEAR(out.depth.at(16, 16), 4.5, 1e-3);
  // A solid sheet in front hides both.
  add_sheet(balls, -0.5f, {0, 255, 0, 255}, 0);
  EXPECT_NEAR(render(balls, camera).color_linear.at(16, 16).g, 1, 1e-4);
}

struct WithVariable {
  const char* name;
  WithVariable(const char* n, const char* value) : name(n) { setenv(n, value, 1); }
  ~WithVariable() { unsetenv(name); }
};

TEST_F(Soft, SortingOnTheGpuGivesTheSamePicture) {
  const std::vector<Ball> balls = ball_soup(5000, 30, 0.05f);
  const Camera camera = camera_at({0.5, -3, 1}, 64, 64);
  const RenderOutput cpu = render(balls, camera);
  const WithVariable with("SFUMATO_DEPTH_SORT", "gpu");
  const RenderOutput gpu = render(balls, camera);
  for (std::size_t i = 0; i < cpu.color_linear.size(); ++i)
    ASSERT_EQ(cpu.color_linear.data()[i], gpu.color_linear.data()[i]);
}

// Looking straight along an axis, the order along it is the order of depth.
TEST_F(Soft, AxisOrderIsExactAlongAnAxis) {
  const std::vector<Ball> balls = ball_soup(300, 31, 0.2f);
  for (dvec3 from : {dvec3(0, -3, 0), dvec3(0, 3, 0), dvec3(3, 0, 0), dvec3(-3, 0, 0), dvec3(0, 0, 3)}) {
    Camera camera = camera_at(from, 40, 40);
    if (from.z != 0) camera.up = {0, 1, 0};
    camera.projection = Projection::orthographic;
    camera.height_world = 2.4;
    set("order", "exact");
    const RenderOutput exact = render(balls, camera);
    set("order", "axis");
    const RenderOutput axis = render(balls, camera);
    for (std::size_t i = 0; i < exact.color_linear.size(); ++i)
      ASSERT_NEAR(glm::distance(exact.color_linear.data()[i], axis.color_linear.data()[i]), 0, 1e-5);
  }
}

// On an orbit in steps of one degree no picture moves by more than 1/8 of what the hard switch would.
TEST(SoftAxisShares, FadeOverEightSteps) {
  for (double elevation : {0.0, 20.0, 35.3, 60.0}) {
    vec3 last(0);
    for (int degree = 0; degree <= 360; ++degree) {
      const double a = glm::radians(double(degree)), e = glm::radians(elevation);
      const vec3 shares = soft::axis_shares({std::cos(a) * std::cos(e), std::sin(a) * std::cos(e), std::sin(e)});
      EXPECT_NEAR(shares.x + shares.y + shares.z, 1, 1e-6);
      if (degree > 0)
        for (int axis = 0; axis < 3; ++axis) EXPECT_LE(std::abs(shares[axis] - last[axis]), 0.125 + 1e-6) << degree;
      last = shares;
    }
  }
}

// Lambert: ambient and diffuse, no highlight; both sides of a point are alike.
TEST_F(Soft, SoftPointsAreLit) {
  settings_.shading = Shading::lit;
  settings_.light_text = "dir:0,-1,0";
  set_opacity(0.5);
  const Camera camera = camera_at({0, -3, 0}, 33, 33);
  for (float sign : {1.0f, -1.0f}) {
    Ball ball{{0, 0, 0}, 0.7f, {255, 255, 255, 255}};
    ball.normal = sign * glm::normalize(vec3(1, -1, 0));
    const vec4 middle = render({ball}, camera).color_linear.at(16, 16);
    EXPECT_NEAR(middle.r / middle.a, 0.3 + 0.7 * std::sqrt(0.5), 1e-3);
  }
}

}  // namespace
