// Scenes of several clouds and techniques in one picture, against pictures of single items put together by
// the test.
#include <algorithm>
#include <array>
#include <map>

#include "core/order.h"
#include "reference/gl_fixture.h"
#include "session/session.h"
#include "techniques/panorama.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

/// A square grid of points at height `z`, spacing 0.02, from -extent to extent along x and y.
PointCloud sheet(float z, float extent, Rgba8 color) {
  PointCloud cloud;
  for (float y = -extent; y <= extent; y += 0.02f)
    for (float x = -extent; x <= extent; x += 0.02f) {
      cloud.positions.push_back({x, y, z});
      cloud.normals.push_back({0, 0, 1});
      cloud.colors.push_back(color);
    }
  return cloud;
}

struct Given {
  PointCloud cloud;
  std::string technique;
  std::map<std::string, std::string> parameters;
};

class ItemsTest : public GlTest {
 protected:
  RenderOutput picture(const std::vector<Given>& given, const Camera& camera, RenderSettings settings = {}) {
    settings.transparent = true;
    settings.edl.user = false;
    settings.smooth_outlines.user = false;
    std::vector<ColoredCloud> clouds;
    std::vector<std::unique_ptr<Technique>> techniques;
    std::vector<Item> items;
    for (const Given& each : given) {
      techniques.push_back(find_technique(each.technique).create());
      for (const auto& [name, value] : each.parameters) set_parameter(*techniques.back(), name, value);
      PreparedCloud prepared = analysis::prepare(each.cloud, techniques.back()->needs(), {});
      std::vector<Rgba8> colors = colors_of(prepared.cloud);
      clouds.push_back({std::move(prepared), std::move(colors)});
    }
    for (std::size_t i = 0; i < given.size(); ++i) items.push_back({i, techniques[i].get(), &settings});
    Renderer renderer(context());
    renderer.set_clouds(std::move(clouds), 3000);
    return renderer.render(items, camera, settings, all_outputs());
  }
  static RenderSettings albedo() {
    RenderSettings settings;
    settings.shading = Shading::albedo;
    return settings;
  }
};

TEST_F(ItemsTest, OpaqueItemsAreTheirPicturesPutTogetherByDepth) {
  const std::vector<Given> items{{sphere_cloud(30000, 0.8f, {-0.5f, 0, 0}), "splats", {}},
                                 {sphere_cloud(30000, 0.8f, {0.5f, 0.2f, 0}), "points", {}},
                                 {sphere_cloud(30000, 0.6f, {0, -0.4f, 0.4f}), "surface", {}}};
  const Camera camera = front_camera(160, 120);
  const RenderOutput all = picture(items, camera);
  // Near and far follow the cloud, and what is resolved between them; points of a third each shift by
  // rounding alone.
  std::vector<RenderOutput> single;
  for (const Given& item : items) single.push_back(picture({item}, camera));
  std::array<int, 3> shown{};
  for (std::size_t i = 0; i < all.depth.size(); ++i) {
    std::size_t nearest = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (single[k].depth.begin()[i] < single[nearest].depth.begin()[i]) nearest = k;
    vec4 color = single[nearest].color_linear.begin()[i];
    // Partly covered edges, which surface has, show what is behind.
    std::array<std::size_t, 3> order{0, 1, 2};
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return single[a].depth.begin()[i] < single[b].depth.begin()[i];
    });
    color = vec4(0);
    for (std::size_t k : order) color += (1 - color.a) * single[k].color_linear.begin()[i];
    ASSERT_EQ(all.depth.begin()[i], single[nearest].depth.begin()[i]) << "pixel " << i;
    for (int c = 0; c < 4; ++c) ASSERT_NEAR(all.color_linear.begin()[i][c], color[c], 1e-6) << "pixel " << i;
    ASSERT_EQ(all.normal.begin()[i], single[nearest].normal.begin()[i]) << "pixel " << i;
    if (std::isfinite(all.depth.begin()[i])) ++shown[nearest];
  }
  for (int pixels : shown) EXPECT_GT(pixels, 500) << "an item that is not seen tests nothing";
}

TEST_F(ItemsTest, TheOrderOfOpaqueItemsDoesNotMatter) {
  std::vector<Given> items{
      {sphere_cloud(20000, 0.8f, {-0.5f, 0, 0}), "splats", {}},
      {sphere_cloud(20000, 0.8f, {0.5f, 0.2f, 0}), "points", {}},
      {sphere_cloud(5000, 0.3f, {0, -1.2f, 0}), "soft", {{"field", "distance"}, {"field_threshold", "-1"}}}};
  const Camera camera = front_camera(120, 90);
  const RenderOutput before = picture(items, camera);
  std::swap(items[0], items[2]);
  const RenderOutput after = picture(items, camera);
  EXPECT_TRUE(std::ranges::equal(before.rgba8, after.rgba8));
}

/// One sheet above another, seen from above: what the middle shows.
vec4 middle(const RenderOutput& out) {
  return out.color_linear.at(out.color_linear.width() / 2, out.color_linear.height() / 2);
}

TEST_F(ItemsTest, LayersBlendOverWhatIsOpaqueBehindThem) {
  const Rgba8 red{255, 0, 0, 255}, blue{0, 0, 255, 255};
  const std::map<std::string, std::string> half{{"opacity", "0.5"}, {"layers", "4"}};
  const Camera camera = camera_above(10, 1, 48);
  const Given opaque{sheet(0, 0.9f, blue), "points", {}};
  const vec4 before = middle(picture({opaque, {sheet(1, 0.9f, red), "layers", half}}, camera, albedo()));
  EXPECT_NEAR(before.r, 0.5, 1e-3);
  EXPECT_NEAR(before.b, 0.5, 1e-3);
  EXPECT_NEAR(before.a, 1, 1e-3);
  const vec4 behind = middle(picture({opaque, {sheet(-1, 0.9f, red), "layers", half}}, camera, albedo()));
  EXPECT_NEAR(behind.r, 0, 1e-3) << "nothing is seen through what is opaque";
  EXPECT_NEAR(behind.b, 1, 1e-3);
  // A layer in front and one behind it, which ends there, also where nothing is smoothed, as in motion.
  PointCloud around = sheet(1, 0.9f, red);
  append(around, sheet(-1, 0.9f, red));
  const Given unsmoothed{
      around, "layers", {{"opacity", "0.5"}, {"layers", "4"}, {"smoothing_iterations", "0"}}};
  const vec4 through = middle(picture({opaque, unsmoothed}, camera, albedo()));
  EXPECT_NEAR(through.r, 0.5, 1e-3);
  EXPECT_NEAR(through.b, 0.5, 1e-3);
  // Two layers before it: each lets half through.
  PointCloud two = sheet(1, 0.9f, red);
  append(two, sheet(2, 0.9f, red));
  const vec4 both = middle(picture({opaque, {two, "layers", half}}, camera, albedo()));
  EXPECT_NEAR(both.r, 0.75, 1e-3);
  EXPECT_NEAR(both.b, 0.25, 1e-3);
  // The last layer is opaque where nothing follows; here something does.
  const vec4 last = middle(picture({opaque, {sheet(1, 0.9f, red), "layers", {}}}, camera, albedo()));
  EXPECT_NEAR(last.b, 0.5, 1e-3);
  const vec4 alone = middle(picture({{sheet(1, 0.9f, red), "layers", {}}}, camera, albedo()));
  EXPECT_NEAR(alone.r, 1, 1e-3) << "as without other items";
}

TEST_F(ItemsTest, HazeIsSeenBeforeAndHiddenBehindOpaqueItems) {
  const Rgba8 red{255, 0, 0, 255}, blue{0, 0, 255, 255};
  const Camera camera = camera_above(10, 1, 48);
  const Given opaque{sheet(0, 0.9f, blue), "splats", {}};
  // A single soft point of opacity 0.3 in the middle of the picture (Eq. 19: through its centre).
  PointCloud point;
  point.positions = {{0, 0, 1}};
  point.colors = {red};
  point.normals = {{0, 0, 1}};
  point.radii = {0.2f};
  std::map<std::string, std::string> soft{{"field", "distance"},          {"field_threshold", "-1"},
                                          {"modulation_threshold", "-1"}, {"opacity", "0.3"},
                                          {"radius_scale", "1"},          {"clamp_radius", "false"}};
  for (const char* model : {"express", "base"}) {
    soft["model"] = model;
    const vec4 before = middle(picture({opaque, {point, "soft", soft}}, camera, albedo()));
    // The pixel's centre is half a pixel, 0.015 of a radius of 0.2 units, off the point's.
    EXPECT_NEAR(before.r, 0.3, 0.02) << model;
    EXPECT_NEAR(before.b, 0.7, 0.02) << model;
    PointCloud under = point;
    under.positions = {{0, 0, -1}};
    const vec4 behind = middle(picture({opaque, {under, "soft", soft}}, camera, albedo()));
    EXPECT_NEAR(behind.b, 1, 1e-3) << model;
    EXPECT_NEAR(behind.r, 0, 1e-3) << model;
  }
}

TEST_F(ItemsTest, ShadowsFallFromItemToItem) {
  RenderSettings settings;
  settings.shadows = Shadows::hard;
  settings.light_text = "dir:0,0,1";
  settings.phong = {.ambient = {0.2f}, .diffuse = {0.8f}, .specular = {0.0f}};
  const Camera camera = camera_above(10, 2, 64);
  const PointCloud floor = sheet(0, 1, {255, 255, 255, 255});
  PointCloud roof;  // hides a quarter of the floor, and is itself cut away by looking from below it
  for (const vec3& p : sheet(5, 0.9f, {}).positions)
    if (p.x > 0 && p.y > 0)
      roof.positions.push_back(p), roof.normals.push_back({0, 0, 1}), roof.colors.push_back({0, 0, 0, 255});
  Camera below_roof = camera;
  below_roof.position = {0, 0, 4};
  const RenderOutput out = picture({{floor, "points", {}}, {roof, "splats", {}}}, below_roof, settings);
  // x > 0, y > 0 is the right upper quarter.
  const float dark = out.color_linear.at(48, 16).r, lit = out.color_linear.at(16, 48).r;
  EXPECT_NEAR(dark, 0.2, 0.01) << "ambient light alone";
  EXPECT_NEAR(lit, 1.0, 0.01);
  // A roof of layers lets half of it through.
  const RenderOutput half =
      picture({{floor, "points", {}}, {roof, "layers", {{"opacity", "0.5"}}}}, below_roof, settings);
  EXPECT_NEAR(half.color_linear.at(48, 16).r, 0.2 + 0.5 * 0.8, 0.02);
  EXPECT_NEAR(half.color_linear.at(16, 48).r, 1.0, 0.01);
}

// What is kept for the next picture is kept for what follows from it, however near the next number is.
TEST_F(ItemsTest, ShadowsFollowTheSmallestChangeOfAThreshold) {
  PointCloud cloud = sheet(0, 1, {255, 255, 255, 255});
  ScalarField weight{"weight", 0, std::vector<float>(cloud.size(), 0)};
  for (const vec3& p : sheet(5, 0.9f, {}).positions) {
    cloud.positions.push_back(p), cloud.normals.push_back({0, 0, 1}), cloud.colors.push_back({0, 0, 0, 255});
    weight.values.push_back(3e-7f);
  }
  cloud.set_scalar(weight);
  RenderSettings settings;
  settings.shadows = Shadows::hard;
  settings.light_text = "dir:0,0,1";
  settings.edl.user = false;
  Camera below_roof = camera_above(10, 2, 64);
  below_roof.position = {0, 0, 4};
  const auto renderer_of = [&](Technique& technique) {
    auto renderer = std::make_unique<Renderer>(context());
    set_parameter(technique, "field", "weight");
    PreparedCloud prepared = analysis::prepare(cloud, technique.needs(), {});
    std::vector<Rgba8> colors = colors_of(prepared.cloud);
    renderer->set_cloud(std::move(prepared), std::move(colors));
    return renderer;
  };
  const auto reused = find_technique("soft").create(), fresh = find_technique("soft").create();
  const auto first = renderer_of(*reused), second = renderer_of(*fresh);
  const auto picture = [&](Renderer& renderer, Technique& technique, const char* threshold) {
    set_parameter(technique, "field_threshold", threshold);
    return renderer.render(technique, below_roof, settings).rgba8;
  };
  const Image<Rgba8> seen_through = picture(*first, *reused, "1e-7"),
                     again = picture(*first, *reused, "4e-7"), solid = picture(*second, *fresh, "4e-7");
  EXPECT_FALSE(std::equal(solid.begin(), solid.end(), seen_through.begin()));
  EXPECT_TRUE(std::equal(solid.begin(), solid.end(), again.begin()));
}

// Points and surface write finished pictures themselves, and charcoal asks what it is drawn on.
TEST_F(ItemsTest, TheBackgroundIsThatOfTheScene) {
  for (const TechniqueInfo& info : all_techniques())
    for (const bool transparent : {false, true}) {
      SCOPED_TRACE(info.name + (transparent ? ", transparent" : ""));
      auto technique = info.create();
      if (info.name == "strokes") set_parameter(*technique, "style", "charcoal");
      Renderer renderer(context());
      show(renderer, sphere_cloud(5000), technique->needs());
      RenderSettings scene = albedo(), own = albedo();
      scene.background = {0.125f, 0.25f, 0.5f};
      scene.transparent = transparent;
      const Item alone{0, technique.get(), &scene}, of_a_rule{0, technique.get(), &own};
      const Camera camera = front_camera(48, 36);
      const RenderOutput expected = renderer.render({&alone, 1}, camera, scene);
      const RenderOutput out = renderer.render({&of_a_rule, 1}, camera, scene);
      EXPECT_TRUE(std::ranges::equal(out.rgba8, expected.rgba8));
      EXPECT_EQ(out.rgba8.at(1, 1).a, transparent ? 0 : 255);
    }
}

/// The walls, floor and ceiling of 8 x 4 x 3, and haze (classification 5) towards +x.
PointCloud room() {
  PointCloud cloud;
  std::mt19937 random(4);
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::normal_distribution<float> normal(0, 0.35f);
  ScalarField classes;
  classes.name = "classification";
  for (int i = 0; i < 40'000; ++i) {
    vec3 p(uniform(random), uniform(random), uniform(random)), n(0);
    p[i % 3] = i % 2 ? 1.0f : -1.0f, n[i % 3] = -p[i % 3];
    cloud.positions.push_back(p * vec3(4, 2, 1.5f));
    cloud.normals.push_back(n);
    classes.values.push_back(0);
  }
  for (int i = 0; i < 4000; ++i) {
    cloud.positions.push_back(vec3(2, 0, 0) + vec3(normal(random), normal(random), normal(random)));
    cloud.normals.push_back({0, 0, 1});
    classes.values.push_back(5);
  }
  cloud.colors.assign(cloud.size(), {200, 200, 200, 255});
  cloud.scalars = {std::move(classes)};
  return cloud;
}

// Whichever of them is drawn last, what was found is the same.
TEST_F(ItemsTest, ViewsTogetherFindOneValue) {
  std::vector<Camera> views(2, camera_at({1, 0, 0}, 64, 64, 90));
  views[0].target = {4, 0, 0}, views[1].target = {-4, 0, 0};
  for (const auto& [name, value] :
       {std::pair{"soft", "opacity"}, {"denoise", "bin_size"}, {"layers", "min_layer_distance"}}) {
    SCOPED_TRACE(name);
    auto technique = find_technique(name).create();
    if (std::string(name) == "soft")
      for (const auto& [each, chosen] : {std::pair{"field", "class"}, {"field_classes", "5"}})
        set_parameter(*technique, each, chosen);
    Renderer renderer(context());
    show(renderer, room(), technique->needs());
    const RenderSettings settings;
    const Item item{0, technique.get(), &settings};
    ParamList parameters;
    technique->describe(parameters);
    const auto found = [&] { return parameters.find(value)->resolved(); };
    std::vector<std::string> alone, together;
    for (int last : {1, 0}) {
      renderer.render(*technique, views[std::size_t(last)], settings);
      alone.push_back(found());
      renderer.render_together({&item, 1}, std::array{views[std::size_t(1 - last)], views[std::size_t(last)]},
                               settings);
      together.push_back(found());
    }
    EXPECT_NE(alone[0], alone[1]) << "the views do not differ enough to tell";
    EXPECT_EQ(together[0], together[1]);
  }
}

// The walls go on where the faces meet, at 45 degrees to either side of the middle.
TEST_F(ItemsTest, DepthShadingOfAPanoramaHasNoSeams) {
  auto technique = find_technique("splats").create();
  Renderer renderer(context());
  show(renderer, room(), technique->needs());
  RenderSettings settings;
  settings.shading = Shading::depth;
  Camera camera = camera_at({1, 0, 0}, 256, 128);
  camera.target = {4, 0, 0};
  RenderWants wants;
  wants.color_linear = true;
  const Item item{0, technique.get(), &settings};
  const Image<vec4> picture =
      render_panorama(renderer, {&item, 1}, camera, {0, 0, 1}, settings, wants).color_linear;
  const auto step = [&](int x) {  // between two columns, over the rows that show walls
    std::vector<float> steps;
    for (int y = 54; y < 74; ++y) steps.push_back(std::abs(picture.at(x + 1, y).g - picture.at(x, y).g));
    return median(steps);
  };
  for (const int seam : {31, 95, 159, 223}) {  // the first column is -180 degrees
    SCOPED_TRACE(seam);
    EXPECT_GT(picture.at(seam, 64).g, 0.01f);
    EXPECT_LT(step(seam), 3 * (step(seam - 3) + step(seam + 3)) + 0.004f);
  }
}

// The faces of a panorama have one light, which is that of no camera.
TEST_F(ItemsTest, APanoramaIsLitFromItsMiddle) {
  auto technique = find_technique("splats").create();
  Renderer renderer(context());
  show(renderer, room(), technique->needs());
  Camera camera = camera_at({1, 0, 0}, 256, 128);
  camera.target = {4, 0, 0};
  const auto lit_by = [&](const char* light) {
    RenderSettings settings;
    settings.light_text = light;
    const Item item{0, technique.get(), &settings};
    return render_panorama(renderer, {&item, 1}, camera, {0, 0, 1}, settings).rgba8;
  };
  const Image<Rgba8> usual = lit_by("shoulder");
  EXPECT_TRUE(std::ranges::equal(usual, lit_by("headlight")));
  EXPECT_FALSE(std::ranges::equal(usual, lit_by("dir:1,0,1")));
}

TEST_F(ItemsTest, ItemsWithoutPointsDrawNothing) {
  const Given sphere{sphere_cloud(5000), "splats", {}};
  const Camera camera = front_camera(64, 48);
  RenderSettings settings;
  settings.shadows = Shadows::hard;
  settings.ground = true;
  const RenderOutput alone = picture({sphere}, camera, settings);
  for (const char* technique : {"points", "soft", "layers", "strokes"}) {
    const RenderOutput with = picture({sphere, {PointCloud(), technique, {}}}, camera, settings);
    EXPECT_TRUE(std::ranges::equal(alone.rgba8, with.rgba8)) << technique;
  }
}

TEST_F(ItemsTest, CloudsOfOneSceneHaveOneOrigin) {
  std::vector<ColoredCloud> clouds(2);
  for (int i = 0; i < 2; ++i) {
    PointCloud cloud = sphere_cloud(100);
    cloud.origin = {double(i), 0, 0};
    clouds[std::size_t(i)] = {analysis::prepare(cloud, {}, {}), colors_of(cloud)};
  }
  Renderer renderer(context());
  EXPECT_THROW(renderer.set_clouds(std::move(clouds)), Error);
}

TEST(DrawRuleTest, TheFirstRuleThatSelectsAPointDrawsIt) {
  PointCloud cloud;
  for (int i = 0; i < 4; ++i) cloud.positions.push_back({float(i), 0, 0});
  const std::vector<DrawRule> rules{DrawRule::parse("x 2..: splats"),
                                    DrawRule::parse("x 1..2: points point_size=3")};
  EXPECT_EQ(first_matches(rules, cloud), (std::vector<std::uint32_t>{2, 1, 0, 0}));
  EXPECT_EQ(rules[1].look(Look("splats"))->parameters.find("point_size")->get(), "3");
  Look base("splats");
  base.set("ambient", "0.7");
  base.set("radius_scale", "3");
  EXPECT_EQ(rules[0].look(base)->parameters.find("ambient")->get(), "0.7") << "one light for all";
  EXPECT_EQ(rules[0].look(base)->parameters.find("radius_scale")->get(),
            Look("splats").parameters.find("radius_scale")->get());
}

TEST(DrawRuleTest, AllSelectedPointsAreSoftUnlessAFieldSaysWhich) {
  using Parameters = decltype(DrawRule::parameters);
  EXPECT_EQ(DrawRule::parse("x 1..: soft opacity=0.2").parameters, (Parameters{{"field", "distance"},
                                                                               {"field_threshold", "-1"},
                                                                               {"modulation_threshold", "-1"},
                                                                               {"opacity", "0.2"}}));
  EXPECT_EQ(DrawRule::parse("x 1..: soft field-threshold=0.3").parameters,
            (Parameters{{"field-threshold", "0.3"}}));
}

TEST_F(ItemsTest, RulesWithNoneLeavePointsOutAndOthersKeepTheirPlaceInTheFile) {
  scene::Scene scene;
  scene.cloud = sphere_cloud(2000);
  const PointCloud all = scene.cloud;
  SessionOptions options;
  options.draw = {DrawRule::parse("z ..0: none"), DrawRule::parse("x 0..: splats")};
  Pose pose = stand_upright(scene, UpAxis::pos_z);
  Session session(context());
  session.set_scene(std::move(scene), pose, options);
  session.measure({});
  ASSERT_EQ(session.parts().size(), 2u);
  std::size_t drawn = 0;
  for (std::size_t k = 0; k < 2; ++k)
    for (std::size_t i = 0; i < session.cloud(k).size(); ++i, ++drawn) {
      EXPECT_GT(session.cloud(k).world(i).z, 0);
      EXPECT_EQ(session.cloud(k).world(i), all.world(session.source(k, i)));
    }
  EXPECT_EQ(drawn, std::size_t(std::count_if(all.positions.begin(), all.positions.end(),
                                             [](const vec3& p) { return p.z > 0; })));
}

TEST(DrawRuleTest, MistakesAreNamed) {
  for (const char* text :
       {"x 1..2", "x 1..2:", "x 1..2: plats", "x 1..2: points size=3", "x 1..2: points point_size",
        "x: points", "x 1..2: points point_size=-4", "x 1..2: none size=1"})
    EXPECT_THROW(DrawRule::parse(text), Error) << text;
}

}  // namespace
