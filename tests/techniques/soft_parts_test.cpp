// The parts of soft transparency: fragment lists, thresholds, modulation, the baseline, orders, light,
// fields.
#include <algorithm>
#include <random>

#include "core/error.h"
#include "reference/soft_scenes.h"
#include "techniques/soft/express.h"
#include "techniques/soft/field.h"
#include "techniques/soft/interior.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

class SoftParts : public SoftTest {};

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
      : prepared(analysis::prepare(cloud_of(balls), {}, {})),
        gpu(prepared, colors_of(prepared.cloud)),
        camera(asked),
        target(asked.width, asked.height),
        frame{gpu, camera, settings, light, target, true, timers, no_progress()},
        view(camera, prepared.cloud.origin),
        solid_t("solid", GL_R32F, asked.width, asked.height),
        result("result", GL_RGBA32F, asked.width, asked.height) {
    settings.shading = Shading::albedo;
    gpu.set_field(gpu.make_values("soft", prepared.cloud.scalar("soft")->values));
    points.choose(gpu, prepared.cloud.scalar("soft")->values, 0.5f);
    soft::Look look;
    look.field_threshold = look.modulation_threshold = 0.5f;
    look.antialias = false;
    solid_t.clear(vec4(solid));
    points.update(frame, view, look, solid_t);
    target.color.clear(vec4(0));
  }
};

// A.7 test 6: as many records stored as counted, two for each sphere or shell that is left after clamping.
TEST_F(SoftParts, FragmentsAreCountedAndStoredAlike) {
  const std::vector<Ball> balls = ball_soup(60, 8);
  const Camera camera = camera_at({0, -1.2, 0}, 40, 30, 70);
  for (bool concentric : {false, true}) {
    InteriorScene scene(balls, camera, 1.5f);
    soft::Interior interior;
    soft::InteriorSettings settings;
    settings.concentric = concentric;
    interior.draw(scene.points, scene.view, scene.solid_t, scene.target.color, scene.result, settings, false,
                  scene.timers);
    const Image<float> counted =
        interior.list().counts().download<float>();  // the storing pass adds once more
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
          const double delta = ray_delta(ray, ball.center, ball.radius),
                       middle = glm::dot(dvec3(ball.center) - ray.origin, ray.direction);
          const double depth = glm::dot(dvec3(ball.center) - ray.origin, camera.direction());
          const double size_px = ball.radius * camera.pixels_per_unit() / std::max(depth, splat_near(camera));
          const std::vector<double> shells = concentric
                                                 ? Shells(std::clamp(size_px / 4, 1.0, 32.0), delta, 0).radii
                                                 : std::vector<double>{1};
          for (const double radius : shells) {
            if (radius <= delta) break;
            const double half = ball.radius * std::sqrt(radius * radius - delta * delta);
            if (std::max(middle - half, splat_near(camera) / ray.cosine) < std::min(middle + half, 1.5))
              expected += 2;
          }
        }
    // Rims and clamped chords that rounding decides: one in ten thousand.
    EXPECT_NEAR(double(total), double(expected), 1 + 1e-4 * double(expected));
  }
}

// A.7 test 7.
TEST_F(SoftParts, ThresholdAndOpacityAtTheirEnds) {
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

// A.7 test 8: between the thresholds the shape goes from a cone to the model's own, without a step at either
// end.
TEST_F(SoftParts, ModulationIsContinuous) {
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
  for (auto [model, at_threshold] :
       {std::pair{"express", 0.4}, {"base", 0.4}, {"concentric", 0.4}, {"express", 0.9}, {"base", 0.9}}) {
    SCOPED_TRACE(model);
    set("model", model);
    set("modulation_opacity", std::to_string(at_threshold));
    set("modulation_threshold", "0.5");
    const std::vector<double> own = row(0.9f);
    set("modulation_threshold", "0.8");
    const std::vector<double> below = row(0.7999f), above = row(0.8001f), lowest = row(0.50001f),
                              middle = row(0.65f);
    for (int x = 0; x < 48; ++x) {
      const double delta = ray_delta(oracle_ray(camera, x + 0.5, 24.5), dvec3(0), 0.7);
      const double cone = delta < 1 ? at_threshold * (1 - delta) : 0;
      EXPECT_NEAR(above[std::size_t(x)], own[std::size_t(x)], 1e-6);
      EXPECT_NEAR(below[std::size_t(x)], own[std::size_t(x)], 1e-3);  // the share is stored in 16 bits: 5e-4
      EXPECT_NEAR(lowest[std::size_t(x)], cone, 3e-4);
      EXPECT_NEAR(middle[std::size_t(x)], 0.5 * (cone + own[std::size_t(x)]), 3e-4);  // Eq. 22, W = 1/2
    }
  }
}

// The dense cones near the threshold are three times as opaque as `opacity` says, so that they fade with it.
TEST_F(SoftParts, ModulationFadesWithOpacity) {
  const Camera camera = camera_at({0, -3, 0}, 49, 49);
  set("field_threshold", "0.5");
  set("modulation_threshold", "0.8");
  for (auto [opacity, expected] : {std::pair{0.01, 0.03}, {0.3, 0.9}, {0.6, 1.0}}) {
    set_opacity(opacity);
    const RenderOutput out = render({Ball{{0, 0, 0}, 0.7f, {200, 100, 50, 255}, 0.50001f}}, camera);
    EXPECT_NEAR(out.color_linear.at(24, 24).a, expected, 1e-3);  // through the centre
  }
}

/// Discs on a grid in the plane y = `at`.
void add_sheet(std::vector<Ball>& balls, float at, Rgba8 color, float field) {
  for (int i = -8; i <= 8; ++i)
    for (int j = -8; j <= 8; ++j)
      balls.push_back({{0.1f * float(i), at, 0.1f * float(j)}, 0.12f, color, field});
}

// A.6: of two parallel soft sheets the first is transparent, the second opaque.
TEST_F(SoftParts, OneLayerShowsTheSecondSheetOpaque) {
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

TEST_F(SoftParts, SortingOnTheGpuGivesTheSamePicture) {
  const std::vector<Ball> balls = ball_soup(5000, 30, 0.05f);
  const Camera camera = camera_at({0.5, -3, 1}, 64, 64);
  const RenderOutput cpu = render(balls, camera);
  const WithPreference with(&gl::Preferences::depth_sort, gl::Place::gpu);
  const RenderOutput gpu = render(balls, camera);
  for (std::size_t i = 0; i < cpu.color_linear.size(); ++i)
    ASSERT_EQ(cpu.color_linear.data()[i], gpu.color_linear.data()[i]);
}

// The rasteriser and the processor blend the same spheres in the same order; float sums of some 30 layers and
// two ways to compute a cosine differ by less than 1e-5.
TEST_F(SoftParts, BlendingOnTheCpuAndOnTheGpuGivesTheSamePicture) {
  std::vector<Ball> balls = ball_soup(3000, 34, 0.08f);
  for (std::size_t i = 0; i < balls.size(); ++i) balls[i].field = 0.4f + 0.6f * float(i % 7) / 6;
  set("field_threshold", "0.45");
  set_opacity(0.4);
  for (const char* modulation : {"-1", "0.8"})
    for (const char* antialias : {"false", "true"})
      for (bool orthographic : {false, true}) {
        set("modulation_threshold", modulation);
        set("antialias", antialias);
        Camera camera = camera_at({0.4, -1.6, 0.5}, 67, 41, 60);
        if (orthographic) {
          camera.projection = Projection::orthographic;
          camera.height_world = 1.4;
        }
        RenderOutput cpu, gpu;
        {
          const WithPreference with(&gl::Preferences::soft_blend, gl::Place::cpu);
          cpu = render(balls, camera);
        }
        {
          const WithPreference with(&gl::Preferences::soft_blend, gl::Place::gpu);
          gpu = render(balls, camera);
        }
        double covered = 0;
        std::size_t apart = 0;
        for (std::size_t i = 0; i < cpu.color_linear.size(); ++i) {
          const vec4 a = cpu.color_linear.data()[i], b = gpu.color_linear.data()[i];
          covered += a.a > 0.5f;
          apart += glm::distance(a, b) > 1e-5f;
        }
        EXPECT_GT(covered, 0.3 * double(cpu.color_linear.size()));
        // A middle that lies on the solid surface, or on its far side, within a rounding: a pixel in a
        // thousand.
        EXPECT_LE(apart, cpu.color_linear.size() / 1000)
            << modulation << " " << antialias << " " << orthographic;
      }
}

// The order is kept while the view stays, but not when spheres grow into it.
TEST_F(SoftParts, KeptOrderFollowsThresholdAndRadius) {
  std::vector<Ball> balls = ball_soup(400, 33, 0.1f);
  for (std::size_t i = 0; i < balls.size(); ++i) {
    balls[i].center *= 1.5f;
    balls[i].field = float(i % 10) / 10;
  }
  const Camera camera = camera_at({0, -2.5, 0}, 40, 40, 40);
  Renderer renderer(context());
  show(renderer, cloud_of(balls), technique_->needs());
  for (auto [name, value] : {std::pair{"radius_scale", "1"},
                             {"radius_scale", "3"},
                             {"field_threshold", "0.2"},
                             {"opacity", "0.5"}}) {
    set(name, value);
    const RenderOutput kept = renderer.render(*technique_, camera, settings_, all_outputs());
    auto fresh = find_technique("soft").create();
    ParamList params;
    technique_->describe(params);
    for (const Param& param : params.all()) set_parameter(*fresh, param.name, param.get());
    const RenderOutput anew = renderer.render(*fresh, camera, settings_, all_outputs());
    for (std::size_t i = 0; i < kept.color_linear.size(); ++i)
      ASSERT_EQ(kept.color_linear.data()[i], anew.color_linear.data()[i]) << name << " = " << value;
  }
}

// Looking straight along an axis, the order along it is the order of depth.
TEST_F(SoftParts, AxisOrderIsExactAlongAnAxis) {
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
      const vec3 shares =
          soft::axis_shares({std::cos(a) * std::cos(e), std::sin(a) * std::cos(e), std::sin(e)});
      EXPECT_NEAR(shares.x + shares.y + shares.z, 1, 1e-6);
      if (degree > 0)
        for (int axis = 0; axis < 3; ++axis)
          EXPECT_LE(std::abs(shares[axis] - last[axis]), 0.125 + 1e-6) << degree;
      last = shares;
    }
  }
}

// Lambert: ambient and diffuse, no highlight; both sides of a point are alike.
TEST_F(SoftParts, SoftPointsAreLit) {
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

/// Points on a line along x, at 0, 1 ... 10, with class and confidence.
soft::Field evaluated(const PreparedCloud& cloud, soft::FieldSettings& settings) {
  analysis::Nearby nearby;
  return soft::evaluate(cloud, settings, nearby);
}

PreparedCloud line_cloud() {
  PreparedCloud prepared;
  ScalarField classes{"classification", 0, {}}, confidence{"confidence", 0, {}}, height{"height", 1000, {}},
      constant{"constant", 0, {}};
  for (int i = 0; i <= 10; ++i) {
    prepared.cloud.positions.push_back({float(i), 0, 0});
    classes.values.push_back(float(i % 4 + 3));
    confidence.values.push_back(float(i) / 10);
    height.values.push_back(float(i));
    constant.values.push_back(7);
  }
  confidence.values[0] = std::nanf("");
  for (const ScalarField& field : {classes, confidence, height, constant}) prepared.cloud.set_scalar(field);
  return prepared;
}

TEST(SoftField, ScalarsInTheUnitRangeStayAndOthersAreNormalized) {
  const PreparedCloud cloud = line_cloud();
  soft::FieldSettings settings;
  settings.field = "confidence";
  const soft::Field own = evaluated(cloud, settings);
  EXPECT_EQ(own.values[0], 0) << "unknown is certain";
  for (int i = 1; i <= 10; ++i) EXPECT_FLOAT_EQ(own.values[std::size_t(i)], float(i) / 10);
  EXPECT_FLOAT_EQ(own.threshold, 0.85f);
  EXPECT_FLOAT_EQ(own.modulation_threshold, 0.95f);
  settings.invert = true;
  EXPECT_FLOAT_EQ(evaluated(cloud, settings).values[3], 0.7f);
  settings.invert = false;
  settings.field = "height";
  const soft::Field height = evaluated(cloud, settings);
  EXPECT_EQ(height.values[0], 0);
  EXPECT_EQ(height.values[10], 1);
  EXPECT_NEAR(height.values[5], 0.5, 1e-5);
  EXPECT_TRUE(height.notes.empty());
  settings.field = "constant";
  const soft::Field constant = evaluated(cloud, settings);
  EXPECT_EQ(*std::max_element(constant.values.begin(), constant.values.end()), 0);
  ASSERT_EQ(constant.notes.size(), 1u);
  EXPECT_NE(constant.notes[0].find("constant hardly varies"), std::string::npos);
  settings.field = "confidense";
  try {
    evaluated(cloud, settings);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean confidence"), std::string::npos) << error.what();
  }
}

TEST(SoftField, ClassesAndDistances) {
  const PreparedCloud cloud = line_cloud();
  soft::FieldSettings settings;
  settings.field = "class";
  settings.classes = {3, 6};
  const soft::Field classes = evaluated(cloud, settings);
  for (int i = 0; i <= 10; ++i) EXPECT_EQ(classes.values[std::size_t(i)], i % 4 == 0 || i % 4 == 3 ? 1 : 0);
  // Most points may be soft: the threshold stays between the two values.
  EXPECT_LT(classes.threshold, 1);
  EXPECT_GE(classes.threshold, 0);

  settings.field = "distance";
  settings.range.user = 10.0f;
  auto at = [&](soft::DistanceTo to, const char* origin, const char* direction, const char* size, int i) {
    settings.distance_to = to;
    settings.origin = origin;
    settings.direction = direction;
    settings.size = size;
    return evaluated(cloud, settings).values[std::size_t(i)];
  };
  EXPECT_FLOAT_EQ(at(soft::DistanceTo::axis, "3,4,9", "auto", "auto", 0), 0.5f);  // up: hypot(3, 4)
  EXPECT_FLOAT_EQ(at(soft::DistanceTo::axis, "0,4,0", "1,0,0", "auto", 9), 0.4f);
  EXPECT_FLOAT_EQ(at(soft::DistanceTo::plane, "2,5,5", "2,0,0", "auto", 8), 0.6f);
  EXPECT_FLOAT_EQ(at(soft::DistanceTo::point, "3,4,0", "auto", "auto", 0), 0.5f);
  EXPECT_FLOAT_EQ(at(soft::DistanceTo::box, "5,0,0", "auto", "4,1,1", 6), 0);
  EXPECT_FLOAT_EQ(at(soft::DistanceTo::box, "5,0,0", "auto", "4,1,1", 10), 0.3f);
  EXPECT_THROW(at(soft::DistanceTo::axis, "1,2", "auto", "auto", 0), Error);
  EXPECT_THROW(at(soft::DistanceTo::axis, "auto", "0,0,0", "auto", 0), Error);
}

// Where more is uncertain the least certain 15 % are soft, whatever the units of the cloud: noise as thick as
// the neighbourhoods that normals are measured in.
TEST_F(SoftParts, UncertaintyMakesItsShareSoft) {
  set("field", "uncertainty");
  set("field_threshold", "auto");
  for (float radius : {0.001f, 1000.0f}) {
    PointCloud cloud = sphere_cloud(4000, radius);
    cloud.normals.clear();
    std::mt19937 random(2);
    std::normal_distribution<float> noise(0, 0.15f * radius);
    for (vec3& p : cloud.positions) p += vec3(noise(random), noise(random), noise(random));
    const RenderOutput out = render(cloud, front_camera(32, 32, 4 * radius));
    ASSERT_FALSE(out.notes.empty());
    EXPECT_EQ(out.notes.back().substr(0, 34), "15.0 % of the points are soft (unc") << out.notes.back();
  }
}

}  // namespace
