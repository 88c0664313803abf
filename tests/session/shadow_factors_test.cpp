// Shadow factors that are kept with the points, and pictures that use them.
#include "session/shadow_factors.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "reference/gl_fixture.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

/// A ball above a floor of scattered points, far from the world's origin; some of them have no normal.
PointCloud ball_over_floor() {
  PointCloud cloud;
  std::mt19937 random(7);
  std::uniform_real_distribution<float> place(-2, 2);
  for (int i = 0; i < 40'000; ++i) {
    cloud.positions.push_back({place(random), place(random), -1});
    cloud.normals.push_back(i % 5 ? vec3(0, 0, 1) : vec3(0));
  }
  cloud.colors.assign(cloud.size(), {180, 180, 180, 255});
  append(cloud, sphere_cloud(12'000, 0.6f, vec3(0, 0, 0.2f)));
  cloud.origin = {447'000, 5'412'000, 100};
  return cloud;
}

RenderSettings lit_by(const std::string& light, Shadows shadows) {
  RenderSettings settings;
  settings.light_text = light;
  settings.shadows = shadows;
  settings.light_samples = 7;
  return settings;
}

Camera camera_of(const PointCloud& cloud) {
  Camera camera = camera_at({2, -4, 3}, 160, 120);
  camera.position += cloud.origin;
  camera.target += cloud.origin;
  return camera;
}

class ShadowFactorsTest : public GlTest {
 protected:
  /// The cloud's picture by `splats`, which computes normals as the factors do.
  Image<vec4> picture(Renderer& renderer, const RenderSettings& settings, const Camera& camera) {
    RenderWants wants;
    wants.color_linear = true;
    return renderer.render(*splats_, camera, settings, wants).color_linear;
  }
  static bool is_equal(const Image<vec4>& a, const Image<vec4>& b) {
    return a.width() == b.width() && a.height() == b.height() && std::equal(a.begin(), a.end(), b.begin());
  }
  std::unique_ptr<Technique> splats_ = find_technique("splats").create();
};

// A lamp in the middle of a ball lights all of it, with a disc as with a point.
TEST_F(ShadowFactorsTest, OfALightInTheMiddleOfTheBox) {
  PointCloud ball = sphere_cloud(20'000, 1, vec3(0));
  for (vec3& normal : ball.normals) normal = -normal;
  for (std::size_t i = 0; i < 20'000; ++i) {  // mirrored, so that the middle is 0 exactly
    ball.positions.push_back(-ball.positions[i]);
    ball.normals.push_back(-ball.normals[i]);
    ball.colors.push_back(ball.colors[i]);
  }
  ASSERT_EQ(bounds(ball).center(), dvec3(0));
  const RenderSettings settings = lit_by("0,0,0", Shadows::soft);
  for (const float factor : shadow_factors(context(), ball, settings)) ASSERT_EQ(factor, 1);
  for (const char* no_place : {"nan,0,0", "dir:inf,0,1", "1,2,1e999"})
    EXPECT_THROW(Light::parse(no_place), Error) << no_place;
}

// The picture with stored factors is the picture with those that are found while it is drawn, bit by bit.
TEST_F(ShadowFactorsTest, DrawThePictureThatTheyWereFoundFor) {
  const PointCloud cloud = ball_over_floor();
  const Camera camera = camera_of(cloud);
  for (const char* light : {"dir:1,-0.4,2", "447003,5412001,104"})
    for (const Shadows shadows : {Shadows::hard, Shadows::soft}) {
      SCOPED_TRACE(std::string(light) + (shadows == Shadows::hard ? ", hard" : ", soft"));
      RenderSettings settings = lit_by(light, shadows);
      Renderer plain(context());
      show(plain, cloud, splats_->needs());
      const Image<vec4> found = picture(plain, settings, camera);

      PointCloud with_factors = cloud;
      with_factors.set_scalar({"shadow", 0, shadow_factors(context(), cloud, settings)});
      Renderer renderer(context());
      // Chunks of 7000: a factor belongs to its point wherever that lies.
      show(renderer, with_factors, splats_->needs(), 7000);
      settings.shadows = Shadows::stored;
      const Image<vec4> stored = picture(renderer, settings, camera);
      EXPECT_TRUE(is_equal(stored, found));

      // From one kind to the other and back, with nothing left of either.
      settings.shadows = Shadows::off;
      const Image<vec4> off = picture(renderer, settings, camera);
      EXPECT_FALSE(is_equal(off, found));
      settings.shadows = Shadows::stored;
      EXPECT_TRUE(is_equal(picture(renderer, settings, camera), stored));
      settings.shadows = shadows;
      settings.light_text = "dir:-1,0.3,1";
      const Image<vec4> other = picture(renderer, settings, camera);
      EXPECT_FALSE(is_equal(other, found));
      settings.shadows = Shadows::stored;
      settings.light_text = light;
      EXPECT_TRUE(is_equal(picture(renderer, settings, camera), stored));
      settings.shadows = shadows;
      EXPECT_TRUE(is_equal(picture(renderer, settings, camera), found));
    }
}

// Under the ball it is dark and beside it light, in the order of the points; how wide the penumbra is follows
// from where the light's disc is seen past the ball (ShadowTest has the closed form).
TEST_F(ShadowFactorsTest, AreThoseOfTheirPoints) {
  const PointCloud cloud = ball_over_floor();
  const std::vector<float> factors = shadow_factors(context(), cloud, lit_by("dir:0,0,1", Shadows::soft));
  ASSERT_EQ(factors.size(), cloud.size());
  const double height = 1.2 + 0.6;               // of the top of the ball over the floor, at most
  const double blur = height * 0.5 * 0.1 + 0.1;  // of a light as wide as a tenth of the box, and texels
  int dark = 0, lit = 0;
  for (std::size_t i = 0; i < 40'000; ++i) {
    const double r = std::hypot(double(cloud.positions[i].x), double(cloud.positions[i].y));
    const bool is_dark = r<0.6 - blur, is_lit = r> 0.6 + blur;
    dark += is_dark, lit += is_lit;
    if (is_dark) EXPECT_EQ(factors[i], 0) << "at " << r;
    if (is_lit) EXPECT_NEAR(factors[i], 1, 1e-6) << "at " << r;  // sevenths are summed
  }
  EXPECT_GT(dark, 500);
  EXPECT_GT(lit, 20'000);
}

// More points in one place than are kept for drawing: the others share their factor.
TEST_F(ShadowFactorsTest, PointsOfOnePlaceAreAlike) {
  PointCloud cloud = ball_over_floor();
  const std::size_t first = cloud.size();
  for (int i = 0; i < 400; ++i) {
    cloud.positions.push_back({0, 0, -1});
    cloud.normals.push_back({0, 0, 1});
    cloud.colors.push_back({180, 180, 180, 255});
  }
  const std::vector<float> factors = shadow_factors(context(), cloud, lit_by("dir:0,0,1", Shadows::hard));
  EXPECT_EQ(std::count(factors.begin() + std::ptrdiff_t(first), factors.end(), 0.0f), 400);
}

// Points without a factor are lit: those of a file that has none beside one that has, NaN in its rows.
TEST_F(ShadowFactorsTest, WhatHasNoneIsLit) {
  PointCloud cloud = ball_over_floor();
  const Camera camera = camera_of(cloud);
  RenderSettings settings = lit_by("dir:1,0,2", Shadows::off);
  Renderer renderer(context());
  show(renderer, cloud, splats_->needs());
  const Image<vec4> lit = picture(renderer, settings, camera);
  settings.shadows = Shadows::stored;
  try {
    picture(renderer, settings, camera);
    FAIL() << "drawn without factors";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("convert IN --shadows soft"), std::string::npos) << error.what();
  }
  cloud.set_scalar({"shadow", 0, std::vector<float>(cloud.size(), std::nanf(""))});
  show(renderer, cloud, splats_->needs());
  // Other shaders, which a driver may round in another way.
  const Image<vec4> all_lit = picture(renderer, settings, camera);
  for (std::size_t i = 0; i < lit.size(); ++i)
    ASSERT_LE(glm::distance(all_lit.data()[i], lit.data()[i]), 1e-5f) << i;
}

TEST_F(ShadowFactorsTest, NeedALightThatStandsSomewhere) {
  const PointCloud cloud = sphere_cloud(100);
  for (const auto& [light, shadows] :
       {std::pair("headlight", Shadows::soft), std::pair("shoulder", Shadows::hard),
        std::pair("dir:0,0,1", Shadows::off), std::pair("dir:0,0,1", Shadows::stored)})
    EXPECT_THROW(shadow_factors(context(), cloud, lit_by(light, shadows)), Error) << light;
}

}  // namespace
