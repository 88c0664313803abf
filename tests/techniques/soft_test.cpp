// Soft transparency against closed forms and a double-precision oracle that integrates densities numerically.
#include "reference/soft_scenes.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

class Soft : public SoftTest {};

/// One sphere in the middle, one in the corner of a wide view (where eye depth is not the ray distance).
std::vector<std::pair<Ball, Camera>> lone_spheres() {
  Camera orthographic = camera_at({0, -3, 0}, 64, 64);
  orthographic.projection = Projection::orthographic;
  orthographic.height_world = 2;
  return {{Ball{{0, 0, 0}, 0.5f}, camera_at({0, -3, 0}, 64, 64)},
          {Ball{{1.2f, 0, 0.85f}, 0.4f}, camera_at({0, -1, 0}, 96, 72, 100)},
          {Ball{{0.2f, 0, 0.1f}, 0.7f}, orthographic}};
}

// A.7 test 1, and the other models' lone spheres. 1e-4: what float leaves of t - t_m at these distances, 1e-6
// of the radius, goes through a square root at the rim.
TEST_F(Soft, LoneSphereIsTheClosedForm) {
  for (const auto& [ball, camera] : lone_spheres())
    for (double opacity : {0.15, 0.6, 1.0}) {
      SCOPED_TRACE(std::to_string(opacity) + " at " + std::to_string(ball.center.x));
      set_opacity(opacity);
      const double lambda = lambda_of(opacity);
      set("model", "base");
      EXPECT_LT(
          lone_sphere_error(ball, camera, [&](double d) { return 1 - std::exp(-lambda * closed_form(d)); }),
          1e-4);
      set("density", "uniform");
      EXPECT_LT(lone_sphere_error(ball, camera,
                                  [&](double d) { return 1 - std::exp(-lambda * std::sqrt(1 - d * d)); }),
                1e-4);
      set("density", "radial");
      set("model", "express");
      EXPECT_LT(lone_sphere_error(ball, camera,
                                  [&](double d) { return opacity * (std::cos(std::acos(-1) * d) + 1) / 2; }),
                1e-4);
      set("model", "concentric");
      set("concentric_count", "7");
      EXPECT_LT(
          lone_sphere_error(ball, camera, [&](double d) { return 1 - std::exp(-lambda * shell_sum(7, d)); }),
          1e-4);
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
          if (d < 1) depth += lambda_of(0.15) * closed_form(d);
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
      const glm::dvec4 expected = oracle.through(
          ray, {{balls[0].center, 0.5, {1, 0, 0}}, {balls[1].center, 0.6, {0, 0, 1}}}, 0, HUGE_VAL);
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

/// Optical depth of nested spheres in units of the Base model's through the centre.
double nested_depth(const RenderOutput& out, int x, int y) {
  return -std::log(1 - double(out.color_linear.at(x, y).a)) / lambda_of(0.5);
}

// A.7 test 4. `exact`: near the Base model by the error of the midpoint rule, whose worst is where a ray
// touches a nested sphere; in every normalisation depth 1 through the centre for each N; Eqs. 13 and 15: the
// limits of notes A.2, halved.
TEST_F(Soft, NestedSpheresTendToTheirLimits) {
  set("model", "concentric");
  set_opacity(0.5);
  const Ball ball{{0, 0, 0}, 0.5f};
  const Camera camera = camera_at({0, -3, 0}, 65, 65);
  auto picture = [&](const char* normalization, int count) {
    set("normalization", normalization);
    set("concentric_count", std::to_string(count));
    return render({ball}, camera);
  };
  auto each_pixel = [&](auto visit) {
    for (int y = 0; y < 65; ++y)
      for (int x = 0; x < 65; ++x) {
        const double delta = ray_delta(oracle_ray(camera, x + 0.5, y + 0.5), ball.center, ball.radius);
        if (delta < 0.97) visit(x, y, delta);
      }
  };
  for (int count : {3, 25, 400}) {
    const RenderOutput exact = picture("exact", count);
    each_pixel([&](int x, int y, double delta) {
      // 5e-5: sums of 400 floats, and alpha through a logarithm.
      ASSERT_NEAR(nested_depth(exact, x, y), closed_form(delta), 1 / std::pow(count, 1.5) + 5e-5)
          << count << " at " << delta;
    });
  }
  for (const char* name : {"exact", "eq13", "eq15"})
    for (int count : {1, 3, 25})
      EXPECT_NEAR(nested_depth(picture(name, count), 32, 32), 1, 1e-5) << name << count;
  for (auto [name, is_15] : {std::pair{"eq13", false}, {"eq15", true}}) {
    const RenderOutput many = picture(name, 400);
    each_pixel([&](int x, int y, double d) {
      const double half = std::sqrt(1 - d * d);
      double limit = half - d * std::acos(d);
      if (is_15 && d > 0) limit -= d * (std::log((1 + half) / d) - half);
      // A Riemann sum of 400 steps over a density that is log-singular in the middle.
      if (d > 0.05) ASSERT_NEAR(nested_depth(many, x, y), limit, 0.01) << name << " at " << d;
    });
  }
}

// However few nested spheres there are, what they take from the light behind is what the Base model takes:
// its mean depth over the disc is 1/3. Automatic counts of small points are fractions.
TEST_F(Soft, NestedSpheresKeepTheMass) {
  set("model", "concentric");
  set_opacity(0.5);
  const Ball ball{{0, 0, 0}, 0.5f};
  // From afar, so that the rays are parallel: 85 px of radius.
  const Camera camera = camera_at({0, -100, 0}, 181, 181, 0.612);
  const double radius_px = ball.radius * camera.pixels_per_unit() / 100;
  auto mass = [&] {
    const RenderOutput out = render({ball}, camera);
    double sum = 0;
    for (int y = 0; y < 181; ++y)
      for (int x = 0; x < 181; ++x) sum += nested_depth(out, x, y);
    return sum / (std::acos(-1) * radius_px * radius_px);
  };
  for (int count : {1, 2, 3, 8, 25}) {
    set("concentric_count", std::to_string(count));
    EXPECT_NEAR(mass(), 1.0 / 3, 0.001) << count;
  }
  set("concentric_count", "auto");
  for (double count : {1.4, 1.6, 2.4, 5.3}) {
    set("concentric_spacing_px", std::to_string(radius_px / count));
    EXPECT_NEAR(mass(), 1.0 / 3, 0.001) << count;
  }
}

// The picture follows the definition through fractions of nested spheres while zooming, without steps where a
// further one begins.
TEST_F(Soft, NestedSpheresGrowWhileZooming) {
  set("model", "concentric");
  set_opacity(0.5);
  set("concentric_spacing_px", "2");
  const Ball ball{{0, 0, 0}, 0.5f};
  double misfit = 0;
  for (double distance = 60; distance > 14; distance *= 0.993) {  // 2.0 to 9 nested spheres
    const Camera camera = camera_at({0, -distance, 0}, 33, 33, 6);
    const RenderOutput out = render({ball}, camera);
    const double count = ball.radius * camera.pixels_per_unit() / distance / 2;
    for (int x = 0; x < 33; ++x)
      for (int y = 0; y < 33; ++y) {
        const double delta = ray_delta(oracle_ray(camera, x + 0.5, y + 0.5), ball.center, ball.radius);
        if (delta > 0.95) continue;
        // The number of spheres is kept in 11 bits: away from where a ray touches one of them.
        const double here = shell_sum(count, delta), moved = shell_sum(count * 1.001, delta);
        misfit = std::max(misfit, std::abs(nested_depth(out, x, y) - here) - 2 * std::abs(moved - here));
      }
  }
  EXPECT_LT(misfit, 0.005);
}

// The definition has no steps: what a change of N by a millionth changes goes with the square root of it.
TEST(SoftOracle, NestedSpheresHaveNoSteps) {
  for (double delta : {0.0, 0.1, 0.5, 0.9})
    for (double count = 1; count < 32; count *= 1.0001)
      ASSERT_NEAR(shell_sum(count * (1 + 1e-7), delta), shell_sum(count, delta), 1e-3)
          << count << ' ' << delta;
}

// A.7 test 5: largest opacity differences of the cosine from the exact integral, by opacity.
TEST_F(Soft, ExpressStaysNearBase) {
  for (auto [opacity, most] : {std::pair{0.05, 0.0037},
                               {0.1, 0.0080},
                               {0.2, 0.0185},
                               {0.3, 0.0321},
                               {0.5, 0.073},
                               {0.7, 0.145},
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
      worst =
          std::max(worst, double(std::abs(express.color_linear.data()[i].a - base.color_linear.data()[i].a)));
    EXPECT_LE(worst, most + 1.0 / 255) << opacity;
    EXPECT_GE(worst, 0.9 * most - 1.0 / 255) << opacity << ": the table would prove nothing";
  }
}

// The order is kept while the camera stands; a wider lens from the same place sees points that were left out
// of it.
TEST_F(Soft, AWiderLensSeesMore) {
  set_opacity(0.3);
  set("model", "express");
  const std::vector<Ball> balls{{{0, 0, 0}, 0.4f}, {{2.5f, 0, 0}, 0.4f}, {{-2.5f, 0, 0}, 0.4f}};
  const Camera narrow = camera_at({0, -3, 0}, 96, 48, 20), wide = camera_at({0, -3, 0}, 96, 48, 60);
  const RenderOutput expected = render(balls, wide);
  Renderer renderer(context());
  show(renderer, cloud_of(balls), technique_->needs());
  renderer.render(*technique_, narrow, settings_, all_outputs());
  const RenderOutput actual = renderer.render(*technique_, wide, settings_, all_outputs());
  EXPECT_GT(expected.color_linear.at(8, 24).a + expected.color_linear.at(14, 24).a, 0.0f);
  for (std::size_t i = 0; i < expected.color_linear.size(); ++i)
    ASSERT_EQ(actual.color_linear.data()[i], expected.color_linear.data()[i]);
}

}  // namespace
