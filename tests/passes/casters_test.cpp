// Techniques that draw points less than opaque, or not at all, cast shadows accordingly.
#include <algorithm>

#include "reference/gl_fixture.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

class CastersTest : public GlTest {
 protected:
  CastersTest() : renderer_(context()) {}

  /// A floor |x|, |y| <= 1 at height 0, and sheets of twice that size above it; scalar `file` counts them
  /// from 1.
  static PointCloud floor_below(const std::vector<float>& heights) {
    PointCloud cloud;
    ScalarField file{"file", 0, {}, StoredType::uint16}, haze{"haze", 0, {}, StoredType::float32};
    std::mt19937 random(3);
    std::uniform_real_distribution<float> jitter(0, 1);
    auto add = [&](int side, float extent, float height, float number) {
      for (int i = 0; i < side * side; ++i) {
        const vec2 at =
            (vec2(i % side, i / side) + vec2(jitter(random), jitter(random))) * (2 * extent / float(side)) -
            extent;
        cloud.positions.push_back({at.x, at.y, height});
        cloud.normals.push_back({0, 0, 1});
        cloud.colors.push_back({200, 200, 200, 255});
        file.values.push_back(number);
        haze.values.push_back(number > 1);
      }
    };
    add(100, 1, 0, 1);
    for (std::size_t k = 0; k < heights.size(); ++k) add(200, 2, heights[k], float(k + 2));
    cloud.set_scalar(file);
    cloud.set_scalar(haze);
    return cloud;
  }

  /// Brightness of the floor, seen from between it and the sheets, with shadows; without is 1.
  std::vector<double> floor_brightness(Technique& technique) {
    const Camera camera = camera_above(0.4, 1.4, 48);
    RenderSettings settings;
    settings.transparent = true;
    settings.light_text = "dir:0,0,1";
    settings.phong = {.shininess = 1, .ambient = {0.0f}, .diffuse = {1.0f}, .specular = {0.0f}};
    settings.edl.user = false;
    const RenderOutput without = renderer_.render(technique, camera, settings, all_outputs());
    settings.shadows = Shadows::hard;
    const RenderOutput with = renderer_.render(technique, camera, settings, all_outputs());
    std::vector<double> ratios;
    for (std::size_t i = 0; i < with.color_linear.size(); ++i)
      ratios.push_back(with.color_linear.data()[i].g / without.color_linear.data()[i].g);
    return ratios;
  }
  void expect_floor(Technique& technique, double expected) {
    std::vector<double> ratios = floor_brightness(technique);
    std::size_t right = 0;
    for (double ratio : ratios)
      right += std::abs(ratio - expected) < 1e-3;  // colours pass through 16-bit floats
    // Empty texels that the filter of the light map leaves: 1 % of the points, each in a few pixels.
    EXPECT_GE(right, ratios.size() * 95 / 100) << expected << " got " << ratios[ratios.size() / 2];
  }
  Renderer renderer_;
};

TEST_F(CastersTest, SoftPointsCastAsMuchAsTheirOpacity) {
  auto technique = find_technique("soft").create();
  for (const auto& [name, value] : {std::pair{"field", "haze"}, {"field_threshold", "0.5"}})
    set_parameter(*technique, name, value);
  for (const auto& heights : {std::vector<float>{0.8f}, {0.8f, 1.2f}}) {
    show(renderer_, floor_below(heights), technique->needs());
    for (double opacity : {0.2, 0.5, 1.0, 0.0}) {
      set_parameter(*technique, "opacity", std::to_string(opacity));
      expect_floor(*technique, std::pow(1 - opacity, double(heights.size())));
    }
  }
}

TEST_F(CastersTest, LayersCastAsMuchAsTheirOpacity) {
  auto technique = find_technique("layers").create();
  show(renderer_, floor_below({0.8f, 1.2f}), technique->needs());
  for (const auto& [list, expected] :
       {std::pair{"0.2", 0.64}, {"1,0.2,0.5", 0.4}, {"0.4,0.3,0", 0.7}, {"1,1,0.5", 0.0}}) {
    set_parameter(*technique, "opacity", list);
    expect_floor(*technique, expected);
  }
}

TEST_F(CastersTest, SolidTechniquesCastFully) {
  auto technique = find_technique("points").create();
  auto layers = find_technique("layers").create();
  set_parameter(*layers, "opacity", "0.5");
  show(renderer_, floor_below({0.8f}), technique->needs());
  expect_floor(*technique, 0);
  expect_floor(*layers, 0.5);
  expect_floor(*technique, 0);  // what the other one left behind does not count
}

// On the ground: onto points, strays that are narrower than the light map can tell cast nothing anyway.
TEST_F(CastersTest, WhatDenoiseRemovesCastsNothing) {
  PointCloud cloud = floor_below({});
  for (int i = 0; i < 36; ++i) {
    cloud.positions.push_back(
        {1.4f + 0.2f * float(i % 6), -0.55f + 0.2f * float(i / 6), 0.7f + 0.02f * float(i)});
    cloud.normals.push_back({0, 0, 1});
    cloud.colors.push_back({200, 200, 200, 255});
  }
  cloud.scalars.clear();
  auto technique = find_technique("denoise").create();
  show(renderer_, cloud, technique->needs());
  // The darkest place of the ground beside the floor, seen from below the strays.
  const auto darkest = [&] {
    RenderSettings settings;
    settings.transparent = settings.ground = true;
    settings.shadows = Shadows::hard;
    settings.light_text = "dir:0,0,1";
    settings.edl.user = false;
    const RenderOutput out = renderer_.render(*technique, camera_above(0.4, 6, 240), settings, all_outputs());
    float alpha = 0;
    for (int y = 0; y < 240; ++y)
      for (int x = 168; x < 240; ++x) alpha = std::max(alpha, out.color_linear.at(x, y).a);  // x > 1.2
    return alpha;
  };
  EXPECT_LT(darkest(), 0.001f);
  // They do cast where nothing is removed.
  set_parameter(*technique, "weight_threshold", "0");
  EXPECT_GT(darkest(), 0.2f);
}

}  // namespace
