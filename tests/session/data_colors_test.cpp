// Colours that stand for something reach the picture as the legend shows them.
#include <algorithm>
#include <array>

#include "reference/gl_fixture.h"
#include "session/session.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

/// A plane of scattered points, in stripes of classes whose colours have others between them.
PointCloud classes_in_stripes() {
  PointCloud cloud;
  std::mt19937 random(5);
  std::uniform_real_distribution<float> place(-1, 1);
  ScalarField classes;
  classes.name = "classification";
  const int kinds[] = {2, 6, 5, 9};  // ground, building, high vegetation, water
  for (int i = 0; i < 60'000; ++i) {
    const float x = place(random);
    cloud.positions.push_back({x, place(random), 0});
    cloud.normals.push_back({0, 0, 1});
    classes.values.push_back(float(kinds[int(10 * (x + 1)) % 4]));
  }
  cloud.scalars.push_back(std::move(classes));
  return cloud;
}

class DataColorsTest : public GlTest {
 protected:
  RenderOutput render(Look& look, const std::string& color_by,
                      const Camera& camera = camera_above(10, 2, 160)) {
    Session session(context());
    scene::Scene scene;
    scene.cloud = classes_in_stripes();
    SessionOptions options;
    options.color.color_by = color_by;
    session.set_scene(std::move(scene), {}, options);
    session.measure(look.technique->needs());
    look.settings.transparent = true;
    look.settings.smooth_outlines.user = false;
    look.settings.edl.user = false;
    return session.render(look, camera);
  }
};

TEST_F(DataColorsTest, CategoriesNeverBlend) {
  const Rgba8 colors[] = {class_color(2), class_color(6), class_color(5), class_color(9)};
  for (const char* technique : {"points", "splats", "surface", "denoise"}) {
    SCOPED_TRACE(technique);
    Look look(technique);
    look.settings.shading = Shading::albedo;
    const RenderOutput out = render(look, "classification");
    std::array<int, 4> shown{};
    int others = 0;
    for (const Rgba8& pixel : out.rgba8) {
      if (pixel.a < 255) continue;
      // One code: colours go to linear floats and back.
      const auto found = std::find_if(std::begin(colors), std::end(colors), [&](const Rgba8& c) {
        return std::abs(c.r - pixel.r) <= 1 && std::abs(c.g - pixel.g) <= 1 && std::abs(c.b - pixel.b) <= 1;
      });
      if (found == std::end(colors))
        ++others;
      else
        ++shown[std::size_t(found - colors)];
    }
    EXPECT_EQ(others, 0);
    for (int pixels : shown) EXPECT_GT(pixels, 1000);
  }
}

/// A table as a depth camera sees it: a grid, noise of 1.3 of its spacings along the view, a photograph.
PointCloud noisy_photograph() {
  PointCloud cloud;
  std::mt19937 random(11);
  std::normal_distribution<float> noise(0, 0.013f);
  for (int row = 0; row < 240; ++row)
    for (int column = 0; column < 240; ++column) {
      const float x = 0.01f * float(column - 120), y = 0.01f * float(row - 120);
      cloud.positions.push_back({x, y, 0.3f * x + noise(random)});
      const auto code = [&](float phase) {
        return std::uint8_t(150 + 60 * std::sin(5 * x + phase) * std::cos(7 * y));
      };
      cloud.colors.push_back({code(0), code(1), code(2), 255});
    }
  return cloud;
}

// Photographs were lit when they were taken: neither lamp nor noise shows on them. Clay has nothing but its
// light.
TEST_F(DataColorsTest, PhotographsKeepTheirLight) {
  const auto shown = [&](const char* technique, const char* color_by, bool flat) {
    Session session(context());
    scene::Scene scene;
    scene.cloud = noisy_photograph();
    SessionOptions options;
    options.color.color_by = color_by;
    Look look(technique);
    session.set_scene(std::move(scene), {}, options);
    session.measure(look.technique->needs());
    look.settings.smooth_outlines.user = false;
    if (flat) {
      look.settings.shading = Shading::albedo, look.settings.edl.user = false;
      look.settings.ambient_occlusion.user = 0.0f;
    }
    RenderWants wants;
    wants.color_linear = true;
    return session.render(look, camera_above(10, 1.6, 160), wants).color_linear;
  };
  for (const char* technique : {"points", "splats", "surface", "denoise", "layers", "soft"}) {
    SCOPED_TRACE(technique);
    const auto deviation = [&](const char* color_by) {
      const Image<vec4> lit = shown(technique, color_by, false), flat = shown(technique, color_by, true);
      double sum = 0;
      for (std::size_t i = 0; i < lit.size(); ++i)
        sum += std::abs(double(lit.data()[i].g / flat.data()[i].g) - 1) / double(lit.size());
      return sum;
    };
    EXPECT_LE(deviation("rgb"), 0.02);
    if (technique != std::string("points")) EXPECT_GT(deviation("clay"), 0.022);
  }
}

// As of leaves that a classifier painted black: nobody sees what is black.
TEST_F(DataColorsTest, ShadesShowOnBlackLabels) {
  PointCloud ball;
  std::mt19937 random(3);
  std::normal_distribution<float> anywhere;
  for (int i = 0; i < 40'000; ++i) {
    const vec3 place = glm::normalize(vec3(anywhere(random), anywhere(random), anywhere(random)));
    ball.positions.push_back(place), ball.normals.push_back(place);
    ball.colors.push_back(place.x < 0 ? Rgba8{0, 0, 0, 255} : Rgba8{230, 160, 20, 255});
  }
  Session session(context());
  scene::Scene scene;
  scene.cloud = std::move(ball);
  Look look("splats");
  SessionOptions options;
  options.color.color_by = "rgb";
  session.set_scene(std::move(scene), {}, options);
  session.measure(look.technique->needs());
  look.settings.edl.user = false, look.settings.light_text = "headlight";
  const Image<Rgba8> shown = session.render(look, camera_above(10, 2.2, 200)).rgba8;
  EXPECT_GT(shown.at(90, 100).g, shown.at(20, 100).g + 10) << "lighter in the middle than at the rim";
  EXPECT_GT(shown.at(120, 100).r, 180) << "what is light stays";
}

TEST_F(DataColorsTest, HighlightsAreForThingsAndNotForData) {
  Look look("splats");
  const auto specular = [&](const std::string& color_by, const Camera& camera = camera_above(10, 2, 160)) {
    return render(look, color_by, camera).settings.phong.specular.value();
  };
  EXPECT_EQ(specular("classification"), 0);
  EXPECT_EQ(specular("elevation"), 0);
  EXPECT_EQ(specular("clay"), 0) << "parallel views have none";
  EXPECT_EQ(specular("clay", camera_at({0, -1, 4}, 160, 160)), 0.1f);
  look.set("specular", "0.4");
  EXPECT_EQ(specular("classification"), 0.4f);
}

/// A crown, of leaves in all of it or of bark around it, that is lighter to one side.
PointCloud crown(bool is_full) {
  PointCloud cloud;
  std::mt19937 random(11);
  std::normal_distribution<float> along(0, 1);
  std::uniform_real_distribution<float> unit(0, 1);
  ScalarField intensity{"intensity", 0, {}, StoredType::float32};
  for (int i = 0; i < 20'000; ++i) {
    const vec3 way = glm::normalize(vec3(along(random), along(random), along(random)));
    cloud.positions.push_back((is_full ? std::cbrt(unit(random)) : 1.0f) * way);
    intensity.values.push_back(100 + 50 * cloud.positions.back().x);
  }
  cloud.scalars.push_back(std::move(intensity));
  return cloud;
}

TEST_F(DataColorsTest, LeavesAreSeenByTheirHeightAndSurfacesByWhatTheyReflect) {
  for (const bool is_full : {true, false}) {
    Session session(context());
    scene::Scene scene;
    scene.cloud = crown(is_full);
    const Look look("points");
    session.set_scene(std::move(scene), {}, {});
    session.measure(look.technique->needs());
    EXPECT_EQ(session.coloring().source, is_full ? "elevation" : "intensity");
  }
}

}  // namespace
