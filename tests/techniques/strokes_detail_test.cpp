// What strokes keep: the width of thin things, closed surfaces, the colours of the scan; and what a file may
// call clusters.
#include <algorithm>
#include <cmath>

#include "analysis/still.h"
#include "reference/stroke_scenes.h"
#include "techniques/strokes/stroke_data.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

struct LargeStrokeScene : StrokeScene {
  explicit LargeStrokeScene(PointCloud cloud) : StrokeScene(std::move(cloud)) {
    camera = front_camera(320, 240);
    camera.fit_depth_range(gpu->bounds());
    target = Target(320, 240);
  }
};

class StrokesDetailTest : public GlTest {};

/// Random points of a pole along z, `spacing` apart: no normals, as scans come.
PointCloud pole_cloud(float radius, float spacing) {
  PointCloud cloud;
  std::mt19937 random(2);
  std::uniform_real_distribution<float> uniform(0, 1);
  const auto count = std::size_t(2 * 3.14159265f * radius * 2 / (spacing * spacing));
  for (std::size_t i = 0; i < count; ++i) {
    const float angle = 2 * 3.14159265f * uniform(random);
    cloud.positions.push_back({radius * std::cos(angle), radius * std::sin(angle), 2 * uniform(random) - 1});
    cloud.colors.push_back({150, 110, 60});
  }
  return cloud;
}

TEST_F(StrokesDetailTest, APoleKeepsItsWidth) {
  for (float spacing : {0.01f, 0.03f}) {
    constexpr float radius = 0.06f;
    LargeStrokeScene scene(pole_cloud(radius, spacing));
    ASSERT_TRUE(scene.step());
    const Image<vec4> picture = scene.picture();
    const double distance = glm::length(scene.camera.position - scene.camera.target);
    const double truth = 2 * radius * scene.camera.intrinsics().fx / distance;
    double width = 0;
    int rows = 0;
    for (int y = 80; y < 160; ++y, ++rows)
      for (int x = 0; x < 320; ++x) width += picture.at(x, y).a;
    EXPECT_LT(width / rows, 1.3 * truth) << spacing;
    EXPECT_GT(width / rows, 0.8 * truth) << spacing;
  }
}

TEST_F(StrokesDetailTest, RandomSurfacesAreClosed) {
  // A wall of random points that fills the picture, 1 to 6 px apart.
  for (std::size_t count : {200'000u, 20'000u, 5'000u}) {
    PointCloud cloud;
    std::mt19937 random(4);
    std::uniform_real_distribution<float> uniform(-4, 4);
    for (std::size_t i = 0; i < count; ++i) {
      cloud.positions.push_back({uniform(random), 0, uniform(random)});
      cloud.colors.push_back({90, 120, 150});
    }
    LargeStrokeScene scene(std::move(cloud));
    ASSERT_TRUE(scene.step());
    std::size_t open = 0;
    for (const vec4& c : scene.picture()) open += c.a < 0.98f;
    EXPECT_LE(open, 5u) << count;
  }
}

// One colour in, the same colour out on the whole, in every style that paints in colour, with relief and
// variation.
TEST_F(StrokesDetailTest, ColoursStayThoseOfTheScan) {
  for (const char* style : {"oil", "impressionist", "pointillist", "figure_4b"}) {
    PointCloud cloud = sphere_cloud(20000, 0.8f);
    cloud.colors.assign(cloud.size(), {130, 70, 160});
    LargeStrokeScene scene(std::move(cloud));
    scene.settings.shading = Shading::lit;
    scene.set("style", style);
    ASSERT_TRUE(scene.step());
    dvec3 sum(0);
    double covered = 0;
    for (const vec4& c : scene.picture()) sum += dvec3(c), covered += c.a;
    const auto linear = [](double v) { return std::pow((v / 255 + 0.055) / 1.055, 2.4); };
    for (int k = 0; k < 3; ++k) {
      const double expected = linear(k == 0 ? 130 : k == 1 ? 70 : 160);
      // Impressionists saturate by 15 %; else a few thousand strokes of 6 to 20 % variation leave less than a
      // hundredth.
      EXPECT_NEAR(sum[k] / covered, expected, (style[0] == 'o' || style[0] == 'f' ? 0.04 : 0.2) * expected)
          << style << k;
    }
  }
}

// A wall that stands still, measured anew for each frame: strokes followed every twentieth of a spacing.
TEST_F(StrokesDetailTest, NoiseDoesNotMoveAStillWall) {
  auto frame = [](unsigned seed) {
    PointCloud cloud;
    std::mt19937 places(5), random(seed);
    std::uniform_real_distribution<float> uniform(-2, 2);
    std::normal_distribution<float> noise(0, 0.05f * 0.02f);
    for (int i = 0; i < 40'000; ++i) {
      const float x = uniform(places), z = uniform(places);
      cloud.positions.push_back({x, noise(random), z});
      cloud.colors.push_back({std::uint8_t(120 + 60 * std::sin(3 * x)), std::uint8_t(z > 0 ? 90 : 180), 70});
    }
    return cloud;
  };
  analysis::StillPoints still;
  Renderer renderer(context());
  auto technique = find_technique("strokes").create();
  EXPECT_TRUE(technique->holds_still());
  Image<Rgba8> before;
  for (unsigned n = 0; n < 3; ++n) {
    PointCloud cloud = frame(n + 1);
    still.hold(cloud, 6);
    show(renderer, std::move(cloud), technique->needs());
    const Image<Rgba8> now = renderer.render(*technique, front_camera(320, 240), RenderSettings{}).rgba8;
    double change = 0;
    for (std::size_t i = 0; i < before.size(); ++i) {
      const Rgba8 a = before.data()[i], b = now.data()[i];
      change += std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
    }
    EXPECT_LT(change / double(now.size()), 0.1) << n;
    before = now;
  }
}

TEST_F(StrokesDetailTest, LabelsOfAFileMayBeAnything) {
  PointCloud cloud = sphere_cloud(500, 0.8f);
  ScalarField labels{"cluster", 0, std::vector<float>(cloud.size(), 3e9f), StoredType::float32};
  for (std::size_t i = 0; i < cloud.size(); i += 3) labels.values[i] = -7;
  labels.values[5] = std::nanf("");
  cloud.set_scalar(labels);
  const std::vector<std::uint32_t> dense = strokes::dense_labels(labels.values);
  EXPECT_EQ(*std::max_element(dense.begin(), dense.end()), 2u);
  EXPECT_EQ(dense[1], dense[2]);
  EXPECT_NE(dense[0], dense[1]);
  StrokeScene scene(std::move(cloud));
  EXPECT_TRUE(scene.step());
}

}  // namespace
