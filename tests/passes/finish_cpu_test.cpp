// Relief and smooth outlines by the processor against those by shaders.
#include <cmath>
#include <random>

#include "passes/finish.h"
#include "passes/shade.h"
#include "reference/gl_fixture.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

class FinishCpuTest : public GlTest {
 protected:
  /// Balls, a tilted wall with noise, a wire, a fence, holes, and nothing beside them; of a size that no tile
  /// or vector divides.
  FinishCpuTest() : depth_(333, 201, INFINITY), color_(333, 201, vec4(0)), normal_(333, 201, vec4(0)) {
    std::mt19937 random(3);
    std::normal_distribution<float> noise(0, 0.004f);
    std::uniform_real_distribution<float> uniform(0, 1);
    for (int y = 0; y < depth_.height(); ++y)
      for (int x = 0; x < depth_.width(); ++x) {
        float& d = depth_.at(x, y);
        if (x > 40 && y > 20 && !(x > 200 && x < 230 && y > 60 && y < 66))
          d = 10 + 0.01f * float(x) - 0.02f * float(y) + noise(random);
        for (const vec3& ball : {vec3(90, 80, 40), vec3(160, 100, 55), vec3(300, 180, 30)}) {
          const float away2 =
              (float(x) - ball.x) * (float(x) - ball.x) + (float(y) - ball.y) * (float(y) - ball.y);
          if (away2 < ball.z * ball.z) d = std::min(d, 7 - 0.02f * std::sqrt(ball.z * ball.z - away2));
        }
        if (std::abs(y - x / 3) < 1) d = std::min(d, 6.0f);
        if (y > 150 && x % 9 < 2) d = std::min(d, 6.5f);
        if (uniform(random) < 0.01f) d = 5;
        if (std::isfinite(d)) color_.at(x, y) = vec4(uniform(random), uniform(random), uniform(random), 1);
        if (x % 50 == 49) color_.at(x, y) *= 0.6f;  // half transparent
        // Waves, and a few that are not known.
        const vec3 n(0.6f * std::sin(0.1f * float(x)), -1, 0.4f * std::sin(0.17f * float(y)) + noise(random));
        if (x % 37 != 3) normal_.at(x, y) = vec4(glm::normalize(n), 1);
      }
  }
  Image<vec4> finished(gl::Place place) {
    const WithPreference<gl::Place> with(&gl::Preferences::finish, place);
    Camera camera = camera_at({0, -8, 0}, whole_.x, whole_.y);
    camera.projection = projection_;
    camera.height_world = 6;
    camera.near_plane = 1, camera.far_plane = 20;
    if (whole_.x > depth_.width()) camera = camera.tile(128, 64, depth_.width(), depth_.height());
    gl::Texture color("color", GL_RGBA32F, depth_.width(), depth_.height()),
        depth("depth", GL_R32F, depth_.width(), depth_.height()),
        normal("normal", GL_RGBA32F, depth_.width(), depth_.height());
    color.upload(color_), depth.upload(depth_), normal.upload(normal_);
    gl::Timers timers(false);
    PostProcessing().run(View(camera, dvec3(0)), relief_, outlines_, color, depth, normal, timers);
    return color.download<vec4>();
  }
  /// Sums of weights and powers are rounded elsewhere; a step that is as high as what counts as one may fall
  /// on either side.
  void expect_alike(const char* which) {
    SCOPED_TRACE(which);
    const Image<vec4> a = finished(gl::Place::gpu), b = finished(gl::Place::cpu);
    std::size_t changed = 0, differ = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const auto away = [&](const vec4& p, const vec4& q) {
        const vec4 d = glm::abs(p - q);
        return std::max(std::max(d.x, d.y), std::max(d.z, d.w));
      };
      changed += away(a.data()[i], color_.data()[i]) > 0.01f;
      differ += !(away(a.data()[i], b.data()[i]) < 2e-4f);
    }
    EXPECT_GT(changed, a.size() / 100);
    EXPECT_LE(differ, a.size() / 5000);
  }

  gl::Texture color_texture(const Image<vec4>& image) {
    gl::Texture out("colours", GL_RGBA32F, image.width(), image.height());
    out.upload(image);
    return out;
  }
  /// By how much a pixel differs that is shaded by shaders and by the processor.
  float shading_differs_by(const RenderSettings& settings) {
    Camera camera = camera_at({0, -8, 0}, depth_.width(), depth_.height());
    camera.projection = projection_;
    camera.height_world = 6;
    camera.near_plane = 1, camera.far_plane = 20;
    Image<vec4> normals = normal_;  // some turned away, some in shadow
    for (int y = 0; y < normals.height(); ++y)
      for (int x = 0; x < normals.width(); ++x)
        if (x % 3 == 0) normals.at(x, y) *= vec4(-1, -1, -1, 0.4f);
    const gl::Texture albedo = color_texture(color_), normal = color_texture(normals);
    gl::Texture depth("depth", GL_R32F, depth_.width(), depth_.height());
    depth.upload(depth_);
    Image<vec4> shaded[2];
    for (int k = 0; k < 2; ++k) {
      const WithPreference<gl::Place> with(&gl::Preferences::finish,
                                           k == 0 ? gl::Place::gpu : gl::Place::cpu);
      gl::Texture out("shaded", GL_RGBA32F, depth_.width(), depth_.height());
      Shade().run(View(camera, dvec3(0)), settings, Light::parse(settings.light_text), dvec3(0),
                  {albedo, depth, normal}, out);
      shaded[k] = out.download<vec4>();
    }
    float away = 0;
    for (std::size_t i = 0; i < shaded[0].size(); ++i)
      away = std::max(away, glm::length(shaded[0].data()[i] - shaded[1].data()[i]));
    return away;
  }

  Image<float> depth_;
  Image<vec4> color_, normal_;
  Relief::Options relief_;
  bool outlines_ = false;
  Projection projection_ = Projection::perspective;
  ivec2 whole_{333, 201};  ///< the picture, or that of which it is a tile
};

}  // namespace

TEST_F(FinishCpuTest, LooksAsByShaders) {
  outlines_ = true;
  expect_alike("outlines");
  relief_.edl_strength = 0.4f;
  expect_alike("lines and outlines");
  outlines_ = false, relief_.occlusion = 1;
  expect_alike("relief");
  relief_.spacing = 0.2f, relief_.noise = 0.004f;  // 5 to 7 px
  expect_alike("of points far apart");
  relief_.edl_strength = 0;
  expect_alike("occlusion alone");
  relief_.occlusion = 0, relief_.scaling = 0.5f;
  expect_alike("ridges above the noise");
  relief_.median_spacing = 0.04f;  // .8 to 3 px
  expect_alike("ridges of points");
  relief_.occlusion = 1;
  relief_.coarse = true;
  expect_alike("without the finest octaves");
  relief_.coarse = false;
  relief_.sensor = vec3(2, -1, -3), relief_.sensor_noise = 0.0002f;
  expect_alike("noise of a sensor");
}

TEST_F(FinishCpuTest, Orthographic) {
  projection_ = Projection::orthographic;
  outlines_ = true, relief_.edl_strength = 0.4f, relief_.occlusion = 0.7f, relief_.scaling = 0.25f;
  expect_alike("all");
  relief_.sensor = vec3(2, -1, -3), relief_.sensor_noise = 0.0002f;
  expect_alike("noise of a sensor");
}

// Lines, and squares of openness, are wider in pictures of more than 720 rows.
TEST_F(FinishCpuTest, ATileOfALargePicture) {
  whole_ = {1920, 1600};
  relief_.sensor = vec3(2, -1, -3), relief_.sensor_noise = 0.0002f;
  outlines_ = true, relief_.edl_strength = 0.4f, relief_.occlusion = 1, relief_.scaling = 0.25f;
  expect_alike("all");
  whole_ = {7680, 4320};
  expect_alike("of squares of 16 px");
}

// What a shader would clamp lies outside of a picture smaller than the reach.
TEST_F(FinishCpuTest, ATinyPicture) {
  Image<float> depth(5, 3, 7);
  depth.at(2, 1) = 6, depth.at(4, 2) = INFINITY;
  whole_ = {5, 3}, depth_ = depth, color_ = Image<vec4>(5, 3, vec4(0.5f, 0.4f, 0.3f, 1));
  normal_ = Image<vec4>(5, 3, vec4(0, -1, 0, 1));
  normal_.at(0, 1) = vec4(0.6f, -0.8f, 0, 1), normal_.at(3, 0) = vec4(0);
  color_.at(4, 2) = vec4(0);
  outlines_ = true, relief_.edl_strength = 1, relief_.edl_radius = 9, relief_.scaling = 1;
  expect_alike("all");
  relief_.occlusion = 1;
  expect_alike("and occlusion");
}

TEST_F(FinishCpuTest, NothingAskedChangesNothing) {
  const Image<vec4> same = finished(gl::Place::cpu);
  for (std::size_t i = 0; i < same.size(); ++i) ASSERT_EQ(same.data()[i], color_.data()[i]);
}

// Powers of a driver are good to some 1e-4 of what they are.
TEST_F(FinishCpuTest, Shading) {
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    projection_ = projection;
    for (const char* light : {"shoulder", "headlight", "3,-9,4", "dir:1,-2,1"}) {
      RenderSettings settings;
      settings.light_text = light;
      settings.phong.ambient.user = 0.2f, settings.phong.diffuse.user = 0.8f;
      settings.phong.specular.user = 0.5f;
      EXPECT_LT(shading_differs_by(settings), 1e-3f) << light;
    }
    for (const Shading shading : {Shading::albedo, Shading::normals, Shading::depth}) {
      RenderSettings settings;
      settings.shading = shading;
      EXPECT_LT(shading_differs_by(settings), 1e-3f) << int(shading);
    }
  }
  RenderSettings categories;
  categories.shading = Shading::albedo;
  categories.palette = {vec3(0.1f, 0.2f, 0.9f), vec3(0.9f, 0.5f, 0), vec3(0.3f)};
  EXPECT_LT(shading_differs_by(categories), 1e-6f);
}

// The nearest code of the formula in doubles, but where it lies between two.
TEST_F(FinishCpuTest, BackgroundAndCodes) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (vec4& c : color_) {
    const float a = uniform(random) < 0.2f ? 0.0f : uniform(random) < 0.5f ? 1.0f : uniform(random);
    c = vec4(a * 1.1f * uniform(random), a * uniform(random) * uniform(random), a * 0.01f * uniform(random),
             a);
  }
  const vec3 behind(0.23f, 0.28f, 0.37f);
  const auto linear = [](double s) { return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4); };
  const auto code = [](double v) {
    v = std::clamp(v, 0.0, 1.0);
    return 255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055);
  };
  for (const bool transparent : {false, true}) {
    RenderSettings settings;
    settings.background = behind, settings.transparent = transparent;
    const gl::Texture color = color_texture(color_);
    Image<Rgba8> coded[2];
    for (int k = 0; k < 2; ++k) {
      const WithPreference<gl::Place> with(&gl::Preferences::finish,
                                           k == 0 ? gl::Place::gpu : gl::Place::cpu);
      gl::Texture out("codes", GL_RGBA8, color_.width(), color_.height());
      Finish().run(settings, color, out);
      coded[k] = out.download<Rgba8>();
    }
    for (std::size_t i = 0; i < color_.size(); ++i) {
      const vec4 c = color_.data()[i];
      const Rgba8 by_shader = coded[0].data()[i], here = coded[1].data()[i];
      const std::uint8_t shader[] = {by_shader.r, by_shader.g, by_shader.b, by_shader.a},
                         cpu[] = {here.r, here.g, here.b, here.a};
      for (int k = 0; k < 4; ++k) ASSERT_LE(std::abs(shader[k] - cpu[k]), 1) << i;
      for (int k = 0; k < 3; ++k) {
        const double a = c.a,
                     value = transparent ? (a > 0 ? c[k] / a : 0) : c[k] + (1 - a) * linear(behind[k]);
        ASSERT_NEAR(cpu[k], code(value), 0.502) << i;
      }
      ASSERT_NEAR(cpu[3], transparent ? 255 * c.a : 255, 0.502) << i;
    }
  }
}
