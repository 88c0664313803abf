// Lists of any length: Base and Concentric model where hundreds and thousands of spheres lie in a pixel.
#include "reference/soft_scenes.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

class SoftLists : public SoftTest {
 protected:
  /// A parallel view along a row of spheres.
  static Camera along_row() {
    Camera camera = camera_at({0, -3, 0}, 12, 12);
    camera.projection = Projection::orthographic;
    camera.height_world = 1.4;
    return camera;
  }
  /// Spheres one behind the other, none inside another, far ones first.
  static std::vector<Ball> row(int count, float field = 1) {
    std::vector<Ball> balls;
    for (int i = count; i-- > 0;)
      balls.push_back({{0.1f * std::sin(float(i)), 1.1f * float(i), 0.1f * std::cos(float(i))},
                       0.5f,
                       {std::uint8_t(i % 251), std::uint8_t(i / 16), std::uint8_t(i % 16 * 16), 255},
                       field});
    return balls;
  }
  /// The picture against the spheres blended near to far, each with the opacity that `alpha` has at delta.
  template <class Alpha>
  void expect_blended(const std::vector<Ball>& balls, Alpha alpha) {
    const Camera camera = along_row();
    const RenderOutput out = render(balls, camera);
    double worst_alpha = 0, worst_color = 0, most = 0;
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        glm::dvec4 expected(0);
        for (std::size_t i = balls.size(); i-- > 0;) {
          const double delta =
              ray_delta(oracle_ray(camera, x + 0.5, y + 0.5), balls[i].center, balls[i].radius);
          if (delta >= 1) continue;
          expected += (1 - expected.a) * alpha(delta) *
                      glm::dvec4(dvec3(linear_of(balls[i].color.r), linear_of(balls[i].color.g),
                                       linear_of(balls[i].color.b)),
                                 1);
        }
        const vec4 actual = out.color_linear.at(x, y);
        most = std::max(most, expected.a);
        worst_alpha = std::max(worst_alpha, std::abs(actual.a - expected.a));
        for (int k = 0; k < 3; ++k) worst_color = std::max(worst_color, std::abs(actual[k] - expected[k]));
      }
    EXPECT_GT(most, 0.03);
    EXPECT_LT(worst_alpha, 1e-3) << balls.size();
    EXPECT_LT(worst_color, 1e-3) << balls.size();
  }
};

// 1500 spheres were cut to a third of their opacity, 2500 to none.
TEST_F(SoftLists, ThousandsOfSpheresKeepTheirOpacity) {
  set("model", "base");
  for (int count : {100, 1500, 2500, 5000}) {
    const double opacity = 0.3 / count;
    set_opacity(opacity);
    expect_blended(row(count), [&](double d) { return 1 - std::exp(-lambda_of(opacity) * closed_form(d)); });
  }
  set_opacity(0.01);  // opaque before the list ends
  expect_blended(row(2500), [&](double d) { return 1 - std::exp(-lambda_of(0.01) * closed_form(d)); });
}

// All of them open at once, in passes that go on where the last one ended.
TEST_F(SoftLists, ManyOpenSpheresAreCarriedOver) {
  set("model", "base");
  set_opacity(0.0002);
  std::vector<Ball> balls;
  for (int i = 0; i < 2000; ++i) balls.push_back({{0, 0.02f * float(i), 0}, 0.5f});
  expect_blended(balls, [&](double d) { return 1 - std::exp(-lambda_of(0.0002) * closed_form(d)); });
}

// Nested spheres between the thresholds of Eq. 22 take a loop for each record.
TEST_F(SoftLists, NestedSpheresWithModulation) {
  set("model", "concentric");
  set_opacity(0.01);
  set("modulation_threshold", "0.9");
  set("modulation_opacity", "0.03");
  for (auto [shells, count] : {std::pair{32, 300}, {1024, 2}}) {
    set("concentric_count", std::to_string(shells));
    expect_blended(row(count, 0.7f), [&](double d) {
      const double model = 1 - std::exp(-lambda_of(0.01) * shell_sum(shells, d));
      return 0.5 * 0.03 * (1 - d) + 0.5 * model;
    });
  }
}

// More than 256 records in a pixel are sorted in the buffer, more than 64 open spheres counted as overflow.
TEST_F(SoftLists, LongListsAndManyOpenSpheres) {
  const Camera camera = camera_at({0, -20, 0}, 24, 24, 4);
  std::vector<Ball> balls;
  std::mt19937 random(4);
  std::uniform_real_distribution<float> uniform(-1, 1);
  for (int i = 0; i < 300; ++i)
    balls.push_back({{0.2f * uniform(random), 8 * uniform(random), 0.2f * uniform(random)},
                     0.4f,
                     {std::uint8_t(i % 256), 128, 60, 255}});
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

// Spheres beyond the 64th in front of a wall, cut by it: what lies behind the wall hides nothing in front of
// it.
TEST_F(SoftLists, SpheresThatOverflowEndAtTheSolidSurface) {
  const Camera camera = camera_at({0, -20, 0}, 24, 24, 4);
  std::vector<Ball> balls;
  std::mt19937 random(9);
  std::uniform_real_distribution<float> uniform(-1, 1);
  for (int i = 0; i < 150; ++i)
    balls.push_back({{0.2f * uniform(random), 0.1f * uniform(random), 0.2f * uniform(random)}, 0.4f});
  balls.push_back({{0, 0, 0}, 3, {255, 255, 255, 255}, 0});  // a disc through them all
  set_opacity(0.02);
  set("model", "base");
  const RenderOutput out = render(balls, camera);
  EXPECT_TRUE(std::any_of(out.notes.begin(), out.notes.end(), [](const std::string& note) {
    return note.find("more than 64 spheres") != std::string::npos;
  }));
  double worst = 0, cut = 0;
  for (int y = 1; y < 24; y += 4)
    for (int x = 1; x < 24; x += 4) {
      const OracleRay ray = oracle_ray(camera, x + 0.5, y + 0.5);
      SoftOracle oracle;
      oracle.opacity = 0.02;
      std::vector<OracleSphere> spheres;
      for (std::size_t i = 0; i + 1 < balls.size(); ++i)
        spheres.push_back({balls[i].center, balls[i].radius, dvec3(0)});
      const double wall = -ray.origin.y / ray.direction.y;  // the disc is the plane y = 0
      const double expected = 1 - oracle.through(ray, spheres, 0, wall).a;
      cut += expected - (1 - oracle.through(ray, spheres, 0, HUGE_VAL).a);
      // The haze takes the place of the wall's colour, white: what is left of it is the transmittance.
      const vec4 color = out.color_linear.at(x, y);
      const dvec3 haze =
          dvec3(std::pow((200 / 255.0 + 0.055) / 1.055, 2.4), std::pow((100 / 255.0 + 0.055) / 1.055, 2.4),
                std::pow((50 / 255.0 + 0.055) / 1.055, 2.4));
      for (int k = 0; k < 3; ++k)
        worst = std::max(worst, std::abs(color[k] - (expected + (1 - expected) * haze[k])));
    }
  EXPECT_GT(cut / 36, 0.05) << "the wall hides too little of the haze to prove anything";
  EXPECT_LT(worst, 1e-3);  // colours are 16-bit floats
}

}  // namespace
