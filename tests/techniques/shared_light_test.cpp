// Light, material and finish that all techniques share, against the formulas of the documentation computed
// here in double precision from the depths and normals of the same picture.
#include <algorithm>
#include <cmath>

#include "reference/gl_fixture.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

double linear(double srgb) { return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4); }

constexpr Rgba8 paint{200, 100, 50, 255};
const dvec3 albedo{linear(200 / 255.0), linear(100 / 255.0), linear(50 / 255.0)};

/// A sphere with a floor beside it, of one colour.
PointCloud scene() {
  PointCloud cloud = sphere_cloud(30000);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> place(-2, 2);
  for (int i = 0; i < 30000; ++i) {
    cloud.positions.push_back({place(random), place(random), -1});
    cloud.normals.push_back({0, 0, 1});
  }
  cloud.colors.assign(cloud.size(), paint);
  return cloud;
}

/// World position of the middle of a pixel at an eye depth, by the definition of the camera.
dvec3 world_position(const Camera& camera, int x, int y, double depth) {
  const Intrinsics k = camera.intrinsics();
  const double w = camera.orthographic() ? 1 : depth;
  const glm::dvec4 eye((x + 0.5 - k.cx) / k.fx * w, -(y + 0.5 - k.cy) / k.fy * w, -depth, 1);
  return dvec3(glm::inverse(camera.view()) * eye);
}

struct Case {
  const char* technique;
  bool orthographic;
};

class SharedLight : public GlTest, public ::testing::WithParamInterface<Case> {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    technique = find_technique(GetParam().technique).create();
    show(renderer, scene(), technique->needs());
    settings.edl.user = false;
    camera = front_camera(96, 72);
    camera.position = {1, -4, 2};
    if (GetParam().orthographic) camera.projection = Projection::orthographic, camera.height_world = 4;
  }
  RenderOutput render() { return renderer.render(*technique, camera, settings, all_outputs()); }
  dvec3 to_eye(const dvec3& p) const {
    return camera.orthographic() ? -camera.direction() : glm::normalize(camera.position - p);
  }

  Renderer renderer{context()};
  std::unique_ptr<Technique> technique;
  RenderSettings settings;
  Camera camera;
};

// c = albedo (k_a + k_d n.l) + k_s (r.v)^s, with the normal on the side of the camera (light_and_shadows.md).
TEST_P(SharedLight, IsThatOfPhong) {
  settings.phong.ambient.user = 0.2f, settings.phong.diffuse.user = 0.6f, settings.phong.shininess = 7;
  settings.phong.specular.user = 0.4f;
  const dvec3 lamp(2, -3, 4), sun = glm::normalize(dvec3(-1, -2, 2));
  double brightest = 0;
  const bool is_surface = GetParam().technique == std::string("surface");
  const double tolerance = is_surface ? 4e-3 : 2e-3;  // it keeps the colours of its discs as halves
  const dvec3 ahead = camera.direction(), right = glm::normalize(glm::cross(ahead, camera.up)),
              above = glm::cross(right, ahead);
  const double aside = glm::radians(25.0);
  const dvec3 shoulder = -std::cos(aside) * ahead + std::sin(aside) * std::sqrt(0.5) * (above - right);
  for (const char* light : {"shoulder", "headlight", "2,-3,4", "dir:-1,-2,2"}) {
    settings.light_text = light;
    const RenderOutput out = render();
    int seen = 0;
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const vec4 c = out.color_linear.at(x, y);
        const dvec3 n(out.normal.at(x, y));
        if (c.a < 0.999f || std::isinf(out.depth.at(x, y)) || glm::length(n) < 0.5) continue;
        const dvec3 p = world_position(camera, x, y, out.depth.at(x, y)), v = to_eye(p);
        const dvec3 l = std::string(light) == "headlight" ? v
                        : light[0] == 's'
                            ? glm::normalize(glm::mix(v, shoulder, glm::smoothstep(0.0, 0.5, glm::dot(n, v))))
                        : light[0] == 'd' ? sun
                                          : glm::normalize(lamp - p);
        ASSERT_GE(glm::dot(n, v), -1e-4) << "the picture's normal faces away";
        if (glm::dot(n, v) < 1e-3) continue;  // seen edge-on, either side of it may be lit
        const double diffuse = std::max(0.0, glm::dot(n, l));
        const dvec3 reflected = 2 * glm::dot(n, l) * n - l;
        const double shine = diffuse > 0 ? 0.4 * std::pow(std::max(0.0, glm::dot(reflected, v)), 7) : 0;
        brightest = std::max(brightest, shine);
        for (int k = 0; k < 3; ++k)
          ASSERT_NEAR(c[k], albedo[k] * (0.2 + 0.6 * diffuse) + shine, tolerance)
              << light << " at " << x << ' ' << y;
        ++seen;
      }
    EXPECT_GT(seen, 1500) << light;
  }
  EXPECT_GT(brightest, 0.3) << "no highlight was looked at";
}

TEST_P(SharedLight, NormalsAreShownAsColours) {
  settings.shading = Shading::normals;
  const RenderOutput out = render();
  int seen = 0;
  for (std::size_t i = 0; i < out.normal.size(); ++i) {
    const dvec3 n(out.normal.data()[i]);
    const vec4 c = out.color_linear.data()[i];
    if (c.a < 0.999f || glm::length(n) < 0.5) continue;
    for (int k = 0; k < 3; ++k) ASSERT_NEAR(c[k], linear(0.5 * n[k] + 0.5), 2e-3);
    ++seen;
  }
  EXPECT_GT(seen, 1500);
}

// Near is light, far is dark, evenly spaced as sRGB; and nearer is never darker.
TEST_P(SharedLight, DepthIsShownFromLightToDark) {
  settings.shading = Shading::depth;
  const RenderOutput out = render();
  // Two numbers say the line: it must go through all the others.
  double nearest = INFINITY, farthest = 0, light = 0, dark = 1;
  const auto srgb = [](double c) {
    return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
  };
  const auto each = [&](const auto& f) {
    for (std::size_t i = 0; i < out.depth.size(); ++i)
      if (const vec4 c = out.color_linear.data()[i]; c.a > 0.999f && !std::isinf(out.depth.data()[i]))
        f(double(out.depth.data()[i]), srgb(c.r));
  };
  each([&](double depth, double value) {
    if (depth < nearest) nearest = depth, light = value;
    if (depth > farthest) farthest = depth, dark = value;
  });
  EXPECT_GT(light, dark + 0.2);
  EXPECT_LE(light, 1);
  EXPECT_GE(dark, 0);
  each([&](double depth, double value) {
    ASSERT_NEAR(value, light + (dark - light) * (depth - nearest) / (farthest - nearest), 2e-3);
  });
}

// What is drawn of depth is the same pass over the picture of every technique (relief_test.cpp has its
// values).
TEST_P(SharedLight, ReliefDarkensTheColoursAndNothingElse) {
  const RenderOutput plain = render();
  settings.edl.user = true;
  settings.ambient_occlusion.user = 0.7f;
  const RenderOutput out = render();
  int lines = 0, hollows = 0;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      ASSERT_EQ(out.depth.at(x, y), plain.depth.at(x, y));
      const vec4 before = plain.color_linear.at(x, y), after = out.color_linear.at(x, y);
      ASSERT_EQ(before.a, after.a);
      if (before.a == 0 || before.r == 0) continue;
      const float shade = after.r / before.r;
      ASSERT_LE(shade, 1 + 1e-5f);
      ASSERT_NEAR(after.b, shade * before.b, 1e-5f);
      // A straight step, which three of eight neighbours see, keeps 0.56
      // (LinesAlongStepsOfAnyHeightAreAlike), the bent border of a small ball more.
      if (shade < 0.65f)
        ++lines;
      else if (shade < 0.97f)
        ++hollows;
    }
  EXPECT_GT(lines, 20) << "the ball before the floor";
  EXPECT_GT(hollows, 200) << "the floor around the ball";
}

// Radiance scaling, from the normals and depths that the picture hands out.
TEST_P(SharedLight, RidgesAreLightenedByTheTurnOfNormals) {
  settings.phong.ambient.user = 0.6f;
  const RenderOutput plain = render();
  settings.radiance_scaling.user = 0.5f;
  const RenderOutput out = render();
  const dmat4 view = camera.view();
  int lighter = 0, checked = 0;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const vec4 before = plain.color_linear.at(x, y), after = out.color_linear.at(x, y);
      ASSERT_EQ(before.a, after.a);
      if (before.a < 0.999f || before.r < 0.02f || std::isinf(out.depth.at(x, y))) continue;
      const double depth = out.depth.at(x, y),
                   px = camera.pixels_per_unit() / (camera.orthographic() ? 1 : depth);
      double sum = 0;
      std::vector<double> turns, angles;
      // The one nearer to 0, which is 0 where they differ in sign.
      const auto less = [](double a, double b) {
        return a * b > 0 ? std::copysign(std::min(std::abs(a), std::abs(b)), a) : 0;
      };
      const std::vector<int> distances = {1, 1, 2, 3, 4, 6, 8};
      for (std::size_t k = 0; k < distances.size(); ++k) {
        const int r = distances[k];
        double angle = 0;
        for (const int axis : {0, 1}) {
          const int ax = std::clamp(x + (axis == 0 ? r : 0), 0, camera.width - 1),
                    ay = std::clamp(y - (axis == 1 ? r : 0), 0, camera.height - 1),
                    bx = std::clamp(x - (axis == 0 ? r : 0), 0, camera.width - 1),
                    by = std::clamp(y + (axis == 1 ? r : 0), 0, camera.height - 1);
          const vec3 a = out.normal.at(ax, ay), b = out.normal.at(bx, by);
          const double step = std::max(std::abs(double(out.depth.at(ax, ay)) - depth),
                                       std::abs(double(out.depth.at(bx, by)) - depth));
          if (glm::dot(a, a) < 0.25f || glm::dot(b, b) < 0.25f || !(step < 4 * r / px)) continue;
          const dvec3 eye_a(view * glm::dvec4(dvec3(a), 0)), eye_b(view * glm::dvec4(dvec3(b), 0));
          angle += (eye_a[axis] - eye_b[axis]) / 2;
        }
        turns.push_back(angle);
        if (k >= 2) {
          const double half = distances[k - 2];
          angle = less(less(angle, 1.5 * r / half * angles[k - 2]),
                       1.5 * r / (r - half) * (turns[k] - turns[k - 2]));
          sum += angle;
        }
        angles.push_back(angle);
      }
      const dvec3 n(out.normal.at(x, y)), place = world_position(camera, x, y, depth);
      const double turned = std::exp(0.5 * std::tanh(sum / 5 * std::abs(glm::dot(n, to_eye(place))) / 0.35)),
                   gain = std::min(turned, std::max(1.0, 1 / double(before.r)));  // red is the lightest
      ++checked, lighter += after.r > 1.05f * before.r;
      // The noise that is measured of points on a ball and a floor, some thousandths, takes a little of it.
      ASSERT_NEAR(after.r / before.r, gain, 0.02) << x << ' ' << y;
    }
  EXPECT_GT(checked, 1000);
  EXPECT_GT(lighter, 100) << "the ball";
}

INSTANTIATE_TEST_SUITE_P(Techniques, SharedLight,
                         ::testing::Values(Case{"points", false}, Case{"points", true}, Case{"splats", false},
                                           Case{"splats", true}, Case{"surface", false},
                                           Case{"surface", true}),
                         [](const auto& each) {
                           return std::string(each.param.technique) +
                                  (each.param.orthographic ? "_orthographic" : "");
                         });

}  // namespace
