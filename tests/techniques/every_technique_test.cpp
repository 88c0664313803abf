// Contracts that every registered technique keeps, without being named here.
#include <algorithm>
#include <atomic>
#include <cstring>
#include <map>
#include <numeric>
#include <optional>
#include <set>

#include "core/error.h"
#include "reference/gl_fixture.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

class EveryTechnique : public GlTest, public ::testing::WithParamInterface<std::string> {
 protected:
  std::unique_ptr<Technique> make() { return find_technique(GetParam()).create(); }
  RenderSettings settings() {
    RenderSettings s;
    s.transparent = true;
    return s;
  }
  static std::size_t covered(const RenderOutput& out) {
    return std::size_t(std::count_if(out.color_linear.begin(), out.color_linear.end(),
                                     [](const vec4& c) { return c.a > 0; }));
  }
  static void expect_finite(const RenderOutput& out) {
    for (const vec4& c : out.color_linear) {
      ASSERT_TRUE(std::isfinite(c.r) && std::isfinite(c.g) && std::isfinite(c.b) && std::isfinite(c.a));
      ASSERT_GE(c.a, 0.0f);
      ASSERT_LE(c.a, 1.0f);
    }
    for (float z : out.depth) ASSERT_FALSE(std::isnan(z));
    for (const vec3& n : out.normal) {
      const float length = glm::length(n);
      ASSERT_TRUE(length == 0 || std::abs(length - 1) < 1e-3)
          << length;  // RG16 octahedral: 3e-5; blending: 1e-3
    }
  }
};

TEST_P(EveryTechnique, SurvivesPoorClouds) {
  Renderer renderer(context());
  auto technique = make();
  PointCloud behind = sphere_cloud(100, 0.2f, vec3(0, -20, 0));
  PointCloud same = sphere_cloud(50);
  std::fill(same.positions.begin(), same.positions.end(), vec3(0.1f));
  const PointCloud clouds[] = {PointCloud{}, behind, sphere_cloud(1, 0.1f), same};
  for (const PointCloud& cloud : clouds) {
    show(renderer, cloud, technique->needs());
    const RenderOutput out = renderer.render(*technique, front_camera(48, 32), settings(), all_outputs());
    expect_finite(out);
    if (&cloud < clouds + 2)
      EXPECT_EQ(covered(out), 0u);
    else
      EXPECT_GT(covered(out), 0u);
  }
}

TEST_P(EveryTechnique, LeavesOutTheWallBeforeARoom) {
  // A red sheet between the camera and a green one; from within, or without the room, nothing is left out.
  PointCloud cloud;
  for (int i = 0; i < 40'000; ++i) {
    const bool wall = i % 2;
    cloud.positions.push_back(
        {float(i / 2 % 141) / 70 - 1, wall ? -1.0f : 1.0f, float(i / 2 / 141) / 70 - 1});
    cloud.normals.push_back({0, wall ? 1.0f : -1.0f, 0});
    cloud.colors.push_back(wall ? Rgba8{220, 20, 20, 255} : Rgba8{20, 220, 20, 255});
  }
  Renderer renderer(context());
  auto technique = make();
  show(renderer, cloud, technique->needs());
  const auto at = [&](int x, double distance) {
    const RenderOutput out =
        renderer.render(*technique, camera_at({0, -distance, 0}, 64, 64), settings(), all_outputs());
    return out.color_linear.at(x, 32);
  };
  const auto center = [&](double distance) { return at(32, distance); };
  EXPECT_GT(center(4).r, center(4).g);
  renderer.set_room(Room{{{0, -1, 0, -0.9}}});  // outside where y < -0.9
  EXPECT_GT(center(4).g, center(4).r);
  EXPECT_GT(center(0.5).g, center(0.5).r);
  // A ceiling before the right half alone.
  const double none = std::numeric_limits<double>::infinity();
  Ceiling ceiling{{0, -1, 0}, {1, 0, 0, 1}, {0, 0, 1, 1}, 2, {none, 0.9, none, 0.9}};
  renderer.set_room(Room{{}, ceiling});
  EXPECT_GT(at(18, 4).r, at(18, 4).g);
  EXPECT_GT(at(46, 4).g, at(46, 4).r);
  renderer.set_room(std::nullopt);
  EXPECT_GT(center(4).r, center(4).g);
}

TEST_P(EveryTechnique, DrawsASphereAtEverySize) {
  Renderer renderer(context());
  auto technique = make();
  show(renderer, sphere_cloud(20000), technique->needs());
  for (auto [w, h] : {std::pair{1, 1}, {7, 5}, {64, 64}, {101, 67}, {64, 64}})
    for (Projection projection : {Projection::perspective, Projection::orthographic}) {
      Camera camera = front_camera(w, h);
      camera.projection = projection;
      camera.height_world = 3;
      const RenderOutput out = renderer.render(*technique, camera, settings(), all_outputs());
      ASSERT_EQ(out.rgba8.width(), w);
      ASSERT_EQ(out.depth.height(), h);
      expect_finite(out);
      // The sphere's disc covers at least a seventh of the image; half of that must be there whatever the
      // style.
      if (w > 1) EXPECT_GT(covered(out), std::size_t(w * h) / 14) << w << "x" << h;
    }
}

TEST_P(EveryTechnique, SameInputGivesTheSameImage) {
  Renderer renderer(context());
  auto technique = make();
  show(renderer, sphere_cloud(20000), technique->needs());
  const RenderOutput a = renderer.render(*technique, front_camera(96, 64), settings(), all_outputs());
  const RenderOutput b = renderer.render(*technique, front_camera(96, 64), settings(), all_outputs());
  auto fresh = make();
  const RenderOutput c = renderer.render(*fresh, front_camera(96, 64), settings(), all_outputs());
  for (std::size_t i = 0; i < a.color_linear.size(); ++i) {
    ASSERT_EQ(a.color_linear.data()[i], b.color_linear.data()[i]);
    ASSERT_EQ(a.color_linear.data()[i], c.color_linear.data()[i]);
  }
}

/// Wants to stop when it is asked for the `at`-th time.
class StopsAt final : public Progress {
 public:
  explicit StopsAt(int at) : at_(at) {}
  void update(double, std::string_view) override {}
  bool cancelled() const override { return ++asked_ >= at_; }
  int asked() const { return asked_; }

 private:
  int at_;
  mutable std::atomic<int> asked_ = 0;
};

// Cancelled after any of its slices: what was left half done shows in no picture after it.
TEST_P(EveryTechnique, APictureCanBeCancelledAnywhere) {
  const auto draw = [](Renderer& renderer, Technique& technique, int frame, Shadows shadows,
                       Progress& progress = no_progress()) {
    RenderSettings s;
    s.shadows = shadows;
    s.light_samples = 2;
    s.ground = shadows == Shadows::hard;  // which finds shadows anew for every picture
    s.smooth_outlines.user = true;
    Camera camera = front_camera(72, 70);
    camera.position.x = 0.2 * frame;
    return renderer.render(technique, camera, s, all_outputs(), progress);
  };
  const PreparedCloud prepared = analysis::prepare(sphere_cloud(3000), make()->needs(), {});
  const auto show_anew = [&](Renderer& renderer) {
    PreparedCloud anew = prepared;
    anew.surface_share = {};  // which a picture may measure
    renderer.set_cloud(std::move(anew), colors_of(prepared.cloud));
  };
  for (const Shadows shadows : {Shadows::off, Shadows::hard, Shadows::soft}) {
    auto fresh = make();
    Renderer expecting(context());
    show_anew(expecting);
    const RenderOutput expected = draw(expecting, *fresh, 1, shadows);

    const WithPreference slices(&gl::Preferences::slice_units, 2000);
    auto technique = make();
    Renderer renderer(context());
    show_anew(renderer);
    StopsAt never(1 << 30);
    draw(renderer, *technique, 1, shadows, never);
    EXPECT_GE(never.asked(), gl::limits().software ? 12 : 1);
    int cancelled = 0, tried = 0;
    // Other moments for each kind of shadows, which have most slices in common.
    const int step = std::max(1, never.asked() / 24);
    for (int at = 1 + int(shadows) * step / 3; at < never.asked(); at += step) {
      SCOPED_TRACE("cancelled at " + std::to_string(at) + " of " + std::to_string(never.asked()));
      const bool is_first = tried % 2 == 0;  // of a technique that has drawn nothing yet
      if (is_first) {
        technique = make();
        show_anew(renderer);
      }
      StopsAt stops(at);
      ++tried;
      try {
        draw(renderer, *technique, is_first, shadows, stops);
      } catch (const Cancelled&) {
        ++cancelled;
      }
      const RenderOutput out = draw(renderer, *technique, 1, shadows);
      ASSERT_TRUE(std::ranges::equal(out.rgba8, expected.rgba8));
      ASSERT_TRUE(std::ranges::equal(out.color_linear, expected.color_linear));
      ASSERT_TRUE(std::ranges::equal(out.depth, expected.depth));
    }
    // Who has drawn before is done sooner.
    EXPECT_GT(cancelled, tried / 2);
  }
}

// Loading sorts, so a shuffled file proves nothing: the prepared cloud itself is shuffled, as one batch and
// as many small GPU chunks.
TEST_P(EveryTechnique, OrderOfPointsDoesNotMatter) {
  auto technique = make();
  ParamList params;
  technique->describe(params);
  // Adaptive sizes are measured in runs of the order that `prepare` gives
  // (tests/unit/analysis/dots_test.cpp).
  if (Param* mode = params.find("size_mode")) mode->set("world");
  PointCloud cloud = sphere_cloud(20000);
  for (std::size_t i = 0; i < 500; ++i)
    cloud.positions[i] = cloud.positions[i + 500];  // coincident, other colours
  PreparedCloud prepared = analysis::prepare(std::move(cloud), technique->needs(), {});
  const Bounds box = bounds(prepared.cloud);
  auto batches = [&](std::uint32_t count) {
    std::vector<Batch> list;
    const std::uint32_t n = std::uint32_t(prepared.cloud.size());
    for (std::uint32_t first = 0; first < n; first += count) {
      list.push_back({first, std::min(count, n - first), vec3(box.min), vec3(box.max)});
      list.back().set_even_spacing(prepared.median_spacing);
    }
    return list;
  };
  Renderer renderer(context());
  prepared.batches = batches(std::uint32_t(prepared.cloud.size()));
  renderer.set_cloud(prepared, colors_of(prepared.cloud));
  const RenderOutput a = renderer.render(*technique, front_camera(96, 64), settings(), all_outputs());

  std::vector<std::uint32_t> order(prepared.cloud.size());
  std::iota(order.begin(), order.end(), 0u);
  std::shuffle(order.begin(), order.end(), std::mt19937(7));
  PreparedCloud shuffled = prepared;
  shuffled.cloud = select(prepared.cloud, order);
  for (std::size_t i = 0; i < shuffled.shrunk.size(); ++i) shuffled.shrunk[i] = prepared.shrunk[order[i]];
  shuffled.batches = batches(3000);
  renderer.set_cloud(shuffled, colors_of(shuffled.cloud), 6000);
  const RenderOutput b = renderer.render(*technique, front_camera(96, 64), settings(), all_outputs());
  // Float sums change with the order of blending: 1e-4 is some 1000 roundings of 1e-7.
  // Where a bin of `denoise` weighs as much as its threshold they decide what is seen.
  std::size_t differ = 0;
  for (std::size_t i = 0; i < a.color_linear.size(); ++i) {
    const vec4 apart = glm::abs(a.color_linear.data()[i] - b.color_linear.data()[i]);
    differ += !(std::max({apart.x, apart.y, apart.z, apart.w}) <= 1e-4f);
  }
  EXPECT_LE(differ, GetParam() == "denoise" ? 3u : 0u) << "of " << a.color_linear.size();
}

TEST_P(EveryTechnique, FurnaceKeepsTheOneColour) {
  Renderer renderer(context());
  auto technique = make();
  PointCloud cloud = sphere_cloud(20000);
  std::fill(cloud.colors.begin(), cloud.colors.end(), Rgba8{200, 100, 50, 255});
  show(renderer, cloud, technique->needs());
  RenderSettings s = settings();
  s.shading = Shading::albedo;
  s.edl.user = false;
  const RenderOutput out = renderer.render(*technique, front_camera(96, 64), s, all_outputs());
  auto linear = [](double c) { return std::pow((c / 255 + 0.055) / 1.055, 2.4); };
  const vec3 expected(float(linear(200)), float(linear(100)), float(linear(50)));
  for (const vec4& c : out.color_linear)
    if (c.a > 1e-3f)
      for (int k = 0; k < 3; ++k)
        ASSERT_NEAR(c[k] / c.a, expected[k], 2e-3);  // half an 8-bit step at this level
}

/// Values with which no point is to be seen, and why.
const std::set<std::string> shows_no_point{
    "layers.show_layer=32",           // a sphere has two
    "denoise.weight_threshold=1000",  // no place weighs as much
};

TEST_P(EveryTechnique, EveryParameterAtBothEnds) {
  Renderer renderer(context());
  auto technique = make();
  PointCloud cloud = sphere_cloud(3000);
  cloud.set_scalar({"shadow", 0, std::vector<float>(cloud.size(), 0.5f)});  // of `shadows = stored`
  show(renderer, cloud, technique->needs());
  ParamList params;
  RenderSettings s = settings();
  technique->describe(params);
  s.describe(params);
  for (Param& param : params.all()) {
    std::vector<std::string> values = param.choices;
    if (param.kind == ParamKind::boolean) values = {"true", "false"};
    for (const auto& end : {param.min, param.max})
      if (end && (param.kind == ParamKind::real || param.kind == ParamKind::integer)) {
        ParamList scratch;
        float number = float(*end);
        values.push_back(param.kind == ParamKind::integer ? std::to_string(long(*end))
                                                          : scratch.add("x", number).get());
      }
    EXPECT_FALSE(param.help_text.empty()) << param.name;
    const std::string before = param.get();
    for (const std::string& value : values) {
      SCOPED_TRACE(param.name + " = " + value);
      param.set(value);
      const PreparedCloud& prepared = renderer.prepared();
      if (!prepared.lacking(technique->needs()).empty()) show(renderer, cloud, technique->needs());
      if (technique->shows(s.shading)) {
        const RenderOutput out = renderer.render(*technique, front_camera(40, 30), s, all_outputs());
        expect_finite(out);
        EXPECT_EQ(covered(out) == 0, shows_no_point.contains(GetParam() + "." + param.name + "=" + value));
      } else {
        EXPECT_THROW(renderer.render(*technique, front_camera(40, 30), s, all_outputs()), Error);
      }
      for (const std::string& message : context().take_messages()) ADD_FAILURE() << "GL: " << message;
    }
    param.set(before);
  }
}

// A technique that renames a parameter would have nothing to draw with in motion.
TEST_P(EveryTechnique, ValuesOfItsOwnAreOfItsParameters) {
  const auto technique = make();
  ParamList params;
  technique->describe(params);
  for (const Technique::Values& values : {technique->in_motion(), technique->of_selected({})})
    for (const auto& [name, value] : values) {
      ASSERT_TRUE(params.find(name)) << name;
      EXPECT_NO_THROW(params.find(name)->set(value)) << name;
    }
}

TEST_P(EveryTechnique, HasOneSizeOfPointsAtMost) {
  const auto technique = make();
  ParamList params;
  technique->describe(params);
  EXPECT_LE(std::count_if(params.all().begin(), params.all().end(),
                          [](const Param& param) { return param.is_point_size; }),
            1);
}

/// A noisy sphere over a floor, with normals that point outwards, with strays and a colour that changes,
/// before a wall of few points: something for every parameter.
PointCloud rich_scene() {
  PointCloud cloud;
  std::mt19937 random(4);
  std::normal_distribution<float> normal(0, 1);
  std::uniform_real_distribution<float> uniform(-2, 2);
  const auto add = [&](vec3 p) {
    cloud.positions.push_back(p);
    cloud.normals.push_back(p.z < -1.05f ? vec3(0, 0, 1) : glm::normalize(p));
    const bool dark = std::sin(9 * p.x) * std::sin(9 * p.y + 9 * p.z) > 0;
    cloud.colors.push_back(dark ? Rgba8{40, 60, 160, 255} : Rgba8{230, 200, 80, 255});
  };
  for (int i = 0; i < 6000; ++i) {
    const vec3 d = glm::normalize(vec3(normal(random), normal(random), normal(random)));
    add(d * (1 + 0.03f * normal(random)));
  }
  for (int i = 0; i < 4000; ++i) add({uniform(random), uniform(random), -1.1f});
  for (int i = 0; i < 150; ++i) add({uniform(random), uniform(random), uniform(random)});
  // Eight times as sparse as the floor.
  for (int row = 0; row < 15; ++row)
    for (int column = 0; column < 15; ++column) {
      add({-3.5f + 0.5f * float(column), 2.5f, -1 + 0.5f * float(row)});
      cloud.normals.back() = {0, -1, 0};
    }
  ScalarField classes;
  classes.name = "classification";
  for (const vec3& p : cloud.positions) classes.values.push_back(p.z < -1.05f ? 2 : p.x < 0 ? 5 : 6);
  ScalarField rows;
  rows.name = "row";
  for (const vec3& p : cloud.positions) rows.values.push_back(p.z > 0 ? 2 : p.y < 0 ? 1 : 0);
  cloud.scalars = {std::move(classes), std::move(rows)};
  return cloud;
}

/// Parameters that change no pixel of a final picture, and why.
const std::map<std::string, std::string> shows_nothing{
    {"fast", "allows atomics that software GL does not have"},
    {"layers.peeling", "both ways find the same layers"},
    {"denoise.hash_bits", "a full table grows by itself"},
    {"strokes.min_sorted", "of later pictures of a view"},
    {"strokes.sort_steps", "of later pictures of a view"},
    {"strokes.hold_still", "of sequences"},
    {"strokes.fragment_memory", "what does not fit comes in turns"},
    {"strokes.specular", "gloss takes its place"},
};

/// Parameters that want several others beside them.
const std::map<std::string, std::vector<std::pair<std::string, std::string>>> company_of{
    {"soft.field_size", {{"field", "distance"}, {"field_distance", "box"}}},
    {"strokes.shininess", {{"lighting", "on"}, {"gloss", "1"}}},
};

// A slider that moves nothing is a bug. Each parameter has a value that another picture shows, if need be
// together with some other choice (shadows for the size of the light).
TEST_P(EveryTechnique, EveryParameterChangesThePicture) {
  if (gl::preferences().screen_passes == gl::ScreenPassKind::compute)
    GTEST_SKIP() << "parameters are the same by any way: once is enough";
  Renderer renderer(context());
  auto technique = make();
  PointCloud scene = rich_scene();
  if (GetParam() == "splats" || GetParam() == "denoise") {
    // Computed radii are limited before `clamp_radius` is: it is for those of files.
    scene.radii.assign(scene.size(), 0.05f);
    scene.radii.front() = 0.6f;
  }
  show(renderer, scene, technique->needs());
  ParamList params;
  RenderSettings s = settings();
  s.photographed = false;  // whose relief has coarse octaves only, which are wider than this picture
  technique->describe(params);
  s.describe(params);
  const auto draw = [&]() -> std::optional<RenderOutput> {
    if (!technique->shows(s.shading)) return std::nullopt;
    const Attributes needs = technique->needs();
    renderer.complete(
        0, [&](const PreparedCloud& of) { return !of.lacking(needs).empty(); },
        [&](PreparedCloud& of) { analysis::complete(of, needs, {}, no_progress()); });
    try {
      return renderer.render(*technique, front_camera(48, 36), s, {});
    } catch (const Error&) {  // of values that do not go together
      return std::nullopt;
    }
  };
  const auto values_of = [](const Param& param) {
    std::vector<std::string> values = param.choices;
    if (param.kind == ParamKind::boolean) values = {"true", "false"};
    if (param.kind == ParamKind::real || param.kind == ParamKind::integer) {
      for (const auto& end : {param.min, param.max})
        if (end)
          values.push_back(param.kind == ParamKind::integer ? std::to_string(long(*end))
                                                            : std::to_string(*end));
      values.insert(values.end(), {"1", "2", "5", "0.1", "0.5", "0.02", "40"});
    }
    if (param.kind == ParamKind::real_list) values = {"0.1,0.5,1", "0.02,0.4,0.9", "1,2,3", "2", "5"};
    if (param.kind == ParamKind::text) values = {"class", "distance", "row", "0,0,1", "1,0.4,0.2"};
    if (param.kind == ParamKind::vector3) values = {"1,0,0", "0,1,0.5"};
    if (param.name == "light") values = {"1,-3,4", "dir:1,-1,1"};
    return values;
  };
  const auto try_set = [](Param& param, const std::string& value) {
    try {
      param.set(value);
      return true;
    } catch (const Error&) {  // out of its range, or not of its kind
      return false;
    }
  };
  std::vector<Param*> silent;
  for (Param& param : params.all())
    if (!shows_nothing.contains(GetParam() + "." + param.name) && !shows_nothing.contains(param.name))
      silent.push_back(&param);
  for (const auto& [name, others] : company_of)
    if (name.starts_with(GetParam() + "."))
      for (const auto& [other, value] : others) params.find(other)->set(value);
  // First by itself, then beside every choice of others and their ends.
  std::vector<std::pair<Param*, std::string>> company{{nullptr, ""}};
  for (Param& other : params.all())
    for (const std::string& value : values_of(other))
      if (value != other.default_text && company.size() < 400) company.emplace_back(&other, value);
  std::stable_partition(company.begin() + 1, company.end(), [](const auto& each) {
    return !each.first->choices.empty() || each.first->kind == ParamKind::boolean ||
           each.first->kind == ParamKind::text;
  });
  for (const auto& [other, choice] : company) {
    if (silent.empty()) break;
    const std::string other_before = other ? other->get() : "";
    if (other && !try_set(*other, choice)) continue;
    if (const auto plain = draw())
      std::erase_if(silent, [&](Param* param) {
        if (param == other) return false;
        const std::string before = param->get();
        bool differs = false;
        for (const std::string& value : values_of(*param)) {
          if (value == before || !try_set(*param, value)) continue;
          const auto changed = draw();
          differs = changed && !std::ranges::equal(changed->rgba8, plain->rgba8);
          if (differs) break;
        }
        param->set(before);
        return differs;
      });
    if (other) other->set(other_before);
  }
  for (const Param* param : silent) ADD_FAILURE() << param->name << " changes nothing, whatever its value";
}

TEST_P(EveryTechnique, DepthIsThatOfTheSphere) {
  Renderer renderer(context());
  auto technique = make();
  show(renderer, sphere_cloud(60000), technique->needs());
  const RenderOutput out = renderer.render(*technique, front_camera(64, 64), settings(), all_outputs());
  // Through the middle of the image the ray meets the unit sphere at distance ~3; splats and pyramids smooth
  // over a few spacings (0.015 each).
  EXPECT_NEAR(out.depth.at(32, 32), std::sqrt(16.09) - 1, 0.06);
  EXPECT_TRUE(std::isinf(out.depth.at(1, 1)));
}

// A sphere over a plane, light from straight above: the plane is darker under the sphere than beside it.
TEST_P(EveryTechnique, ShadowsDarken) {
  Renderer renderer(context());
  auto technique = make();
  PointCloud cloud = sphere_cloud(20000, 0.5f, vec3(0, 0, 1));
  std::mt19937 random(9);
  std::uniform_real_distribution<float> uniform(-2, 2);
  for (int i = 0; i < 60000; ++i) {
    cloud.positions.push_back({uniform(random), uniform(random), 0});
    cloud.normals.push_back({0, 0, 1});
  }
  cloud.colors.assign(cloud.size(), Rgba8{200, 200, 200, 255});
  show(renderer, cloud, technique->needs());
  Camera camera = front_camera(120, 90);
  camera.position = {0, -4, 3};
  camera.target = {0, 0, 0.3};
  const Intrinsics k = camera.intrinsics();
  auto brightness = [&](const RenderOutput& out, dvec3 p) {
    const dvec3 eye(camera.view() * glm::dvec4(p, 1));
    const int x = int(k.fx * eye.x / -eye.z + k.cx), y = int(-k.fy * eye.y / -eye.z + k.cy);
    double sum = 0;
    for (int dy = -2; dy <= 2; ++dy)
      for (int dx = -2; dx <= 2; ++dx) sum += out.color_linear.at(x + dx, y + dy).g / 25;
    return sum;
  };
  RenderSettings s = settings();
  s.light_text = "dir:0,0,1";
  for (Shadows shadows : {Shadows::off, Shadows::hard, Shadows::soft}) {
    s.shadows = shadows;
    s.ground = shadows == Shadows::hard;  // which finds shadows anew for every picture
    const RenderOutput out = renderer.render(*technique, camera, s, all_outputs());
    expect_finite(out);
    const double under = brightness(out, {0, 0, 0}), beside = brightness(out, {1.4, 0, 0});
    EXPECT_GT(beside, 0.05);
    // k_a = 0.3 of k_a + k_d = 1 is left in full shadow; styles and smoothing may lift it to a half.
    if (shadows == Shadows::off)
      EXPECT_GT(under, 0.7 * beside);
    else
      EXPECT_LT(under, 0.5 * beside);
  }
}

std::vector<std::string> names() {
  std::vector<std::string> list;
  for (const TechniqueInfo& info : all_techniques()) list.push_back(info.name);
  return list;
}

/// A sphere on a floor that comes near the camera, so that spacings on the screen differ by a factor of ten.
PointCloud sphere_on_floor() {
  PointCloud cloud = sphere_cloud(20000);
  for (int i = 0; i < 40000; ++i) {  // a lattice without rows
    const double u = std::fmod(0.7548776662466927 * i, 1.0), v = std::fmod(0.5698402909980532 * i, 1.0);
    cloud.positions.push_back(vec3(float(8 * u - 4), float(7 * v - 3), -1));
    cloud.normals.push_back({0, 0, 1});
    cloud.colors.push_back({std::uint8_t(80 + 100 * u), 120, std::uint8_t(60 + 120 * v), 255});
  }
  return cloud;
}

template <class T>
std::size_t count_differences(const Image<T>& a, const Image<T>& b) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += std::memcmp(a.data() + i, b.data() + i, sizeof(T)) != 0;
  return count;
}

TEST_P(EveryTechnique, TilesMakeThePictureInOneGo) {
  Renderer renderer(context());
  auto technique = make();
  show(renderer, sphere_on_floor(), technique->needs());
  for (const int variant : {0, 1}) {
    SCOPED_TRACE(variant);
    // Wide enough for tiles that share nothing with the first.
    Camera camera = front_camera(variant == 0 ? 900 : 300, variant == 0 ? 200 : 260);
    RenderSettings s = settings();
    s.edl.user = true;
    s.smooth_outlines.user = variant == 0;
    if (variant == 1) {
      s.samples = 2, s.shadows = Shadows::hard, s.ground = true;
      camera.projection = Projection::orthographic, camera.height_world = 4;
    }
    const RenderOutput whole = renderer.render(*technique, camera, s, all_outputs());
    const WithPreference tiles(&gl::Preferences::tile_side, 128);
    ASSERT_TRUE(renderer.is_tiled(camera));
    const RenderOutput tiled = renderer.render(*technique, camera, s, all_outputs());
    ASSERT_EQ(tiled.rgba8.width(), camera.width);
    ASSERT_EQ(tiled.rgba8.height(), camera.height);
    EXPECT_EQ(tiled.points_drawn, whole.points_drawn);
    // Rasterisers put corners on a grid of 1/256 px of the canvas: quads of strokes are interpolated from
    // places that differ by a rounding, and a pixel in a thousand shows it (0.04 to 0.06 % counted). All
    // else, and strokes that the CPU lists, goes by rays through pixels and is equal.
    if (GetParam() == "strokes" && gl::place_of_work(gl::preferences().stroke_lists) == gl::Place::gpu) {
      EXPECT_LT(count_differences(tiled.rgba8, whole.rgba8), whole.rgba8.size() / 1000);
      continue;
    }
    EXPECT_EQ(count_differences(tiled.rgba8, whole.rgba8), 0u);
    EXPECT_EQ(count_differences(tiled.color_linear, whole.color_linear), 0u);
    EXPECT_EQ(count_differences(tiled.depth, whole.depth), 0u);
    EXPECT_EQ(count_differences(tiled.normal, whole.normal), 0u);
  }
}

INSTANTIATE_TEST_SUITE_P(All, EveryTechnique, ::testing::ValuesIn(names()),
                         [](const auto& param_info) { return param_info.param; });

}  // namespace
