#include <algorithm>
#include <bit>
#include <map>

#include "core/error.h"
#include "passes/points_to_pixels.h"
#include "reference/gl_fixture.h"
#include "reference/layers_oracle.h"
#include "synth/synth.h"
#include "techniques/layers/opacity.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

using Values = std::map<std::string, std::string>;

class LayersTest : public GlTest {
 protected:
  LayersTest() : renderer_(context()), technique_(find_technique("layers").create()) {}

  RenderOutput render(const Camera& camera, const Values& values, Shading shading = Shading::albedo) {
    technique_ = find_technique("layers").create();
    for (const auto& [name, value] : values) set_parameter(*technique_, name, value);
    RenderSettings settings;
    settings.transparent = true;
    settings.shading = shading;
    return renderer_.render(*technique_, camera, settings, all_outputs());
  }

  /// Random points on the square |x|, |y| <= extent at height z, facing up.
  static PointCloud sheet(std::size_t count, float extent, float z, Rgba8 color) {
    PointCloud cloud;
    std::mt19937 random(std::uint32_t(count) + std::uint32_t(100 * z));
    std::uniform_real_distribution<float> uniform(-extent, extent);
    for (std::size_t i = 0; i < count; ++i) {
      cloud.positions.push_back({uniform(random), uniform(random), z});
      cloud.normals.push_back({0, 0, 1});
      cloud.colors.push_back(color);
    }
    return cloud;
  }
  /// Parallel sheets one below the other, seen from above by `above()`.
  static PointCloud sheets(int count, Rgba8 color = {200, 100, 50, 255}) {
    PointCloud cloud;
    for (int k = 0; k < count; ++k) append(cloud, sheet(12000, 1, -0.3f * float(k), color));
    return cloud;
  }
  static Camera above(int size = 48) {
    Camera camera;
    camera.position = {0, 0, 4};
    camera.up = {0, 1, 0};
    camera.projection = Projection::orthographic;
    camera.height_world = 1.2;
    camera.width = camera.height = size;
    return camera;
  }
  static PointCloud tori(int points) {
    synth::SampleOptions options;
    options.points = points;
    options.normals.user = true;
    return synth::sample(synth::make_scene("tori"), options);
  }
  static double linear(int code) { return std::pow((code / 255.0 + 0.055) / 1.055, 2.4); }

  Renderer renderer_;
  std::unique_ptr<Technique> technique_;
};

/// Of a note "6 layers, 2 visits of the points (cascade)".
int visits(const std::string& note) { return std::stoi(note.substr(note.find(", ") + 2)); }

/// Distances along the view axis at which the ray through a pixel's centre meets the tori.
std::vector<double> roots(const synth::Scene& scene, const Camera& camera, int x, int y) {
  const Intrinsics k = camera.intrinsics();
  const dmat4 world = camera.inverse_view();
  const dvec3 slope((x + 0.5 - k.cx) / k.fx, -(y + 0.5 - k.cy) / k.fy, -1);
  const synth::Ray ray{camera.position, glm::normalize(dvec3(world * glm::dvec4(slope, 0)))};
  std::vector<double> depths;
  for (const synth::Hit& hit : scene.intersect_all(ray)) depths.push_back(hit.t / glm::length(slope));
  return depths;
}

// Whole pictures against the papers' text in double. Float and double put points that lie on the border of
// two pixels, and depths that lie on a threshold, on different sides; the filters carry that to the
// neighbours.
TEST_F(LayersTest, PictureIsThatOfTheOracle) {
  PointCloud cloud = tori(15000);
  Camera camera = front_camera(72, 54, 3.4);
  camera.position.z = 2;
  const std::vector<float> opacities{0.3f, 0.5f, 0.9f};
  const ScalarField layer = *cloud.scalar("layer");
  std::vector<layers_oracle::Point> points;
  const dmat4 view = camera.view(cloud.origin);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Rgba8 c = cloud.colors[i];
    points.push_back({dvec3(view * glm::dvec4(cloud.positions[i], 1)),
                      {linear(c.r), linear(c.g), linear(c.b)},
                      opacities[std::size_t(layer.values[i])],
                      dvec3(view * glm::dvec4(cloud.normals[i], 0))});
  }
  show(renderer_, cloud, {});
  for (int variant = 0; variant < 3; ++variant) {
    layers_oracle::Options o;
    o.d_min = 0.1;
    o.layers = variant == 0 ? 6 : 3;
    o.background_iterations = 1 + variant;
    o.occluded_iterations = variant;
    o.smoothing_iterations = variant;
    o.scale_by_angle = variant != 1;
    o.antialias = variant != 0;
    const int guard = 30;
    const layers_oracle::Result expected =
        layers_oracle::render(points, camera.with_guard_band(guard), guard, o);
    const RenderOutput actual =
        render(camera, {{"layers", std::to_string(o.layers)},
                        {"opacity", "0.3,0.5,0.9"},
                        {"min_layer_distance", "0.1"},
                        {"background_iterations", std::to_string(o.background_iterations)},
                        {"occluded_iterations", std::to_string(o.occluded_iterations)},
                        {"smoothing_iterations", std::to_string(o.smoothing_iterations)},
                        {"scale_by_angle", o.scale_by_angle ? "true" : "false"},
                        {"antialias", o.antialias ? "true" : "false"},
                        {"point_shape", "round"},
                        {"point_size", "0.01"}});
    int differ = 0, depths_differ = 0, covered = 0;
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        covered += expected.color.at(x, y).a > 0;
        differ += glm::length(glm::dvec4(actual.color_linear.at(x, y)) - expected.color.at(x, y)) > 1e-4;
        const double d = expected.depth.at(x, y);
        depths_differ +=
            std::isinf(d) ? !std::isinf(actual.depth.at(x, y)) : std::abs(actual.depth.at(x, y) - d) > 1e-4;
      }
    EXPECT_GT(covered, 1000);
    EXPECT_LE(differ, covered / 100) << "variant " << variant;
    EXPECT_LE(depths_differ, covered / 200) << "variant " << variant;
  }
}

// Through the common core of the tubes a ray meets each torus twice; later layers are empty.
TEST_F(LayersTest, NestedToriHaveSixLayersInOrder) {
  const synth::Scene scene = synth::make_scene("tori");
  show(renderer_, tori(150000), {});
  Camera camera;
  camera.position = {0, -2.5, 2.5};
  camera.target = {0, -1, 0};
  camera.fov_y = glm::radians(12.0);  // a pixel is smaller than a spacing
  camera.width = camera.height = 64;
  const float d_min = 3 * renderer_.prepared().median_spacing;
  std::vector<Image<float>> depths;
  for (int n = 1; n <= 7; ++n) depths.push_back(render(camera, {{"show_layer", std::to_string(n)}}).depth);
  int rays = 0, right = 0, empty_after = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const std::vector<double> truth = roots(scene, camera, x, y);
      if (truth.size() != 6) continue;
      // Away from silhouettes, where layers are thinner than d_min or a pixel sees both sides of an edge.
      bool is_clear = true;
      for (std::size_t k = 1; k < 6; ++k) is_clear = is_clear && truth[k] - truth[k - 1] > 2 * d_min;
      for (auto [dx, dy] : {std::pair{2, 0}, {-2, 0}, {0, 2}, {0, -2}})
        is_clear = is_clear && roots(scene, camera, x + dx, y + dy).size() == 6;
      if (!is_clear) continue;
      ++rays;
      bool is_right = true;
      for (std::size_t k = 0; k < 6; ++k)
        is_right = is_right && std::abs(depths[k].at(x, y) - truth[k]) < d_min;
      right += is_right;
      empty_after += std::isinf(depths[6].at(x, y));
    }
  EXPECT_GT(rays, 150);
  // Points are scattered at random: exp(-pi) = 4 % of the places of a layer are in no disc, and few of those
  // gaps are too wide for the filters.
  EXPECT_GT(right, rays * 0.97);
  EXPECT_GT(empty_after, rays * 0.97);
}

TEST_F(LayersTest, InTheirPlaneTheToriHaveTwelveLayers) {
  const synth::Scene scene = synth::make_scene("tori");
  show(renderer_, tori(150000), {});
  Camera camera;
  camera.position = {0, -4, 0};
  camera.fov_y = glm::radians(2.0);  // around the axis, where surfaces face the view
  camera.width = camera.height = 24;
  const float d_min = 3 * renderer_.prepared().median_spacing;
  int rays = 0, right = 0;
  std::vector<Image<float>> depths;
  for (int n = 1; n <= 13; ++n) depths.push_back(render(camera, {{"show_layer", std::to_string(n)}}).depth);
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 24; ++x) {
      const std::vector<double> truth = roots(scene, camera, x, y);
      ASSERT_EQ(truth.size(), 12u);
      ++rays;
      bool is_right = std::isinf(depths[12].at(x, y));
      for (std::size_t k = 0; k < 12; ++k)
        is_right = is_right && std::abs(depths[k].at(x, y) - truth[k]) < d_min;
      right += is_right;
    }
  EXPECT_GT(right, rays * 0.88);  // 0.99 a layer
}

// k equal layers over a background: c (1 - (1-a)^k) + bg (1-a)^k.
TEST_F(LayersTest, EqualLayersBlendAsTheFormulaSays) {
  show(renderer_, sheets(5), {});
  for (double alpha : {0.3, 0.7})
    for (int layers : {1, 3, 5, 8}) {
      const RenderOutput out =
          render(above(), {{"layers", std::to_string(layers)}, {"opacity", std::to_string(alpha)}});
      const double coverage = 1 - std::pow(1 - alpha, std::min(layers, 5));
      for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 48; ++x) {
          const vec4 c = out.color_linear.at(x, y);
          ASSERT_NEAR(c.a, coverage, 1e-5);  // some roundings of 1e-7
          ASSERT_NEAR(c.r, coverage * linear(200), 1e-5);
        }
    }
}

// Without an opacity the last surface is opaque: what it hides is the page, not another surface.
TEST_F(LayersTest, TheLastSurfaceIsOpaqueUnlessOpacityIsGiven) {
  PointCloud cloud;
  for (int k = 0; k < 3; ++k)
    append(cloud, sheet(12000, 1, -0.3f * float(k), Rgba8(std::uint8_t(250 - 70 * k), 90, 90, 255)));
  show(renderer_, cloud, {});
  const double c[3] = {linear(250), linear(180), linear(110)};
  const std::vector<std::pair<Values, double>> cases{
      {{}, 0.5 * c[0] + 0.25 * c[1] + 0.25 * c[2]},
      {{{"layers", "2"}}, 0.5 * c[0] + 0.5 * c[1]},
      {{{"layers", "1"}}, c[0]},
      {{{"layers", "9"}, {"antialias", "false"}}, 0.5 * c[0] + 0.25 * c[1] + 0.25 * c[2]},
      {{{"opacity", "0.3"}, {"opaque_last", "true"}}, 0.3 * c[0] + 0.7 * 0.3 * c[1] + 0.49 * c[2]},
  };
  for (const auto& [values, expected] : cases) {
    const RenderOutput out = render(above(), values);
    for (const vec4& pixel : out.color_linear) {
      ASSERT_NEAR(pixel.a, 1, 1e-5);  // some roundings of 1e-7
      ASSERT_NEAR(pixel.r, expected, 1e-5);
    }
  }
  EXPECT_NEAR(render(above(), {{"opacity", "0.5"}}).color_linear.at(24, 24).a, 0.875, 1e-5);
  EXPECT_NEAR(render(above(), {{"opaque_last", "false"}}).color_linear.at(24, 24).a, 0.875, 1e-5);
}

// The outline of a surface behind another one lets no page shine through, and the outline of the picture is
// smooth.
TEST_F(LayersTest, OnlyTheOutlineOfThePictureIsBlendedWithThePage) {
  PointCloud cloud = sheet(60000, 0.5f, 0, {200, 200, 200, 255});
  append(cloud, sheet(60000, 0.25f, -0.3f, {20, 20, 20, 255}));
  show(renderer_, cloud, {});
  const RenderOutput out = render(above(96), {});
  int partly = 0;
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 96; ++x) {
      const double away = std::max(std::abs(x - 47.5), std::abs(y - 47.5)) / 80;  // the sheet reaches 0.5
      const float a = out.color_linear.at(x, y).a;
      if (away < 0.46) ASSERT_NEAR(a, 1, 1e-5) << x << " " << y;
      if (away > 0.54) ASSERT_EQ(a, 0);
      partly += a > 0.01f && a < 0.99f;
    }
  EXPECT_GT(partly, 4 * 60);  // a pixel or more along most of four edges of 80
  EXPECT_NEAR(out.color_linear.at(48, 48).r, 0.5 * (linear(200) + linear(20)), 1e-5);
  EXPECT_NEAR(out.color_linear.at(48, 20).r, linear(200), 1e-5);
}

TEST_F(LayersTest, NothingShowsThroughAnOpaqueLayer) {
  PointCloud cloud = sheets(6);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (cloud.positions[i].z < -1.4f) cloud.colors[i] = {0, 255, 0, 255};  // the sixth
  ScalarField depth_order{"file", 0, {}, StoredType::float32};
  for (const vec3& p : cloud.positions) depth_order.values.push_back(std::round(-p.z / 0.3f));
  cloud.set_scalar(depth_order);
  show(renderer_, cloud, {});
  const RenderOutput opaque =
      render(above(), {{"layers", "8"}, {"opacity", "0.1,0.1,0.1,0.1,1,1"}, {"antialias", "false"}});
  const RenderOutput clear = render(above(), {{"layers", "8"}, {"opacity", "0.1,0.1,0.1,0.1,0.1,1"}});
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 48; ++x) {
      ASSERT_NEAR(opaque.color_linear.at(x, y).g, linear(100), 1e-5);
      ASSERT_GT(clear.color_linear.at(x, y).g, linear(100) + 0.3);  // 0.9^5 = 0.59 of the green one
    }
  render(above(), {{"layers", "8"}, {"opacity", "0.1,0.1,0.1,0.1,1,1"}, {"antialias", "false"}});
  EXPECT_EQ(technique_->notes().at(0).substr(0, 8),
            "5 layers");  // ended behind the fifth, not after the eighth
}

TEST_F(LayersTest, CascadeGivesThePicturesOfPasses) {
  for (int points : {3000, 60000}) {
    show(renderer_, tori(points), {}, 20000);
    for (const char* size : {"0.01", "2"})
      for (const char* angle : {"false", "true"}) {
        Camera camera = front_camera(72, 54, 3.4);
        camera.position.z = 2;
        Values values{
            {"layers", "7"}, {"opacity", "0.3,0.5,0.6"}, {"point_size", size}, {"scale_by_angle", angle}};
        values["peeling"] = "passes";
        const RenderOutput passes = render(camera, values, Shading::lit);
        const std::string passes_note = technique_->notes().at(0);
        values["peeling"] = "cascade";
        const RenderOutput cascade = render(camera, values, Shading::lit);
        const std::string cascade_note = technique_->notes().at(0);
        for (std::size_t i = 0; i < passes.color_linear.size(); ++i) {
          ASSERT_EQ(passes.color_linear.data()[i], cascade.color_linear.data()[i]);
          ASSERT_EQ(passes.depth.data()[i], cascade.depth.data()[i]);
          ASSERT_EQ(passes.normal.data()[i], cascade.normal.data()[i]);
        }
        EXPECT_EQ(visits(passes_note), std::stoi(passes_note));
        EXPECT_LE(visits(cascade_note), visits(passes_note));
        if (points == 3000 && size[0] == '0') EXPECT_LE(visits(cascade_note), 3) << cascade_note;
      }
  }
}

// Lists stand below each other in a texture, which has no room for those of a high picture.
TEST_F(LayersTest, HighPicturesAreDrawnInPasses) {
  show(renderer_, tori(3000), {});
  Camera camera = front_camera(24, gl::limits().max_texture_size / 2, 3.4);  // tori three quarters as high
  ASSERT_FALSE(renderer_.is_tiled(camera));
  Values values{{"layers", "3"}, {"peeling", "passes"}};
  const RenderOutput passes = render(camera, values);
  values["peeling"] = "cascade";
  const RenderOutput high = render(camera, values);
  EXPECT_TRUE(std::ranges::equal(passes.color_linear, high.color_linear));
  EXPECT_NE(technique_->notes().at(0).find("(passes)"), std::string::npos) << technique_->notes().at(0);
  camera.height = 54;
  render(camera, values);
  EXPECT_NE(technique_->notes().at(0).find("(cascade)"), std::string::npos) << technique_->notes().at(0);
}

// At the size of the paper's largest scene: hundreds of points a pixel, far more than a list holds.
TEST_F(LayersTest, CascadeGivesThePictureOfPassesAtSixMillionPoints) {
  synth::SampleOptions options;
  options.points = 6'000'000;
  show(renderer_, synth::sample(synth::make_scene("tori"), options), {});
  Camera camera = front_camera(160, 120, 3.4);
  camera.position.z = 2;
  for (const char* size : {"0.01", "2"}) {
    Values values{{"layers", "6"}, {"opacity", "0.3,0.5,0.6"}, {"point_size", size}, {"peeling", "passes"}};
    const RenderOutput passes = render(camera, values, Shading::lit);
    const std::string passes_note = technique_->notes().at(0);
    values["peeling"] = "cascade";
    const RenderOutput cascade = render(camera, values, Shading::lit);
    EXPECT_TRUE(std::ranges::equal(passes.color_linear, cascade.color_linear));
    EXPECT_TRUE(std::ranges::equal(passes.depth, cascade.depth));
    EXPECT_TRUE(std::ranges::equal(passes.normal, cascade.normal));
    // Not two empty pictures: the tori cover a third of this one.
    EXPECT_GT(std::ranges::count_if(passes.depth, [](float d) { return !std::isinf(d); }), 160 * 120 / 4);
    EXPECT_LE(visits(technique_->notes().at(0)), visits(passes_note));
  }
}

// The lists of a pixel hold its nearest different depths, ascending, with the lowest source index of each.
TEST_F(LayersTest, ListsHoldTheNearestDepths) {
  PointCloud cloud = tori(20000);
  for (std::size_t i = 0; i < 2000; ++i) cloud.positions[i] = cloud.positions[i + 2000];  // equal depths
  PreparedCloud prepared = analysis::prepare(cloud, {}, {});
  GpuCloud gpu(prepared, colors_of(prepared.cloud), 6000);
  const Camera camera = [&] {
    Camera c = front_camera(32, 24, 3.4);
    c.fit_depth_range(gpu.bounds());
    return c;
  }();
  const View view(camera, prepared.cloud.origin);
  constexpr int length = PointsToPixels::list_length;
  gl::Texture depths("depths", GL_R32UI, 32, 24 * length), indices("indices", GL_R32UI, 32, 24 * length);
  depths.clear_uint(0xffffffffu);
  indices.clear_uint(0xffffffffu);
  PointsToPixels to_pixels;
  gl::Timers timers(false);
  const float bin = 1 / 64.0f;
  to_pixels.draw_lists(gpu, view, {SizeMode::pixels, 1}, bin, depths, indices, timers);

  // The same by peeling: from the next bin on.
  const Image<std::uint32_t> found = depths.download<std::uint32_t>(),
                             sources = indices.download<std::uint32_t>();
  gl::Texture limit("limit", GL_R32F, 32, 24);
  Image<float> behind(32, 24, 0.0f);
  int full = 0;
  for (int k = 0; k < length; ++k) {
    limit.upload(behind);
    PixelLayer layer;
    to_pixels.draw(gpu, view, {SizeMode::pixels, 1}, layer, timers, &limit);
    const Image<std::uint32_t> bits = layer.depth_bits.download<std::uint32_t>();
    const Image<std::uint32_t> index = layer.index.download<std::uint32_t>();
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < 32; ++x) {
        ASSERT_EQ(found.at(x, y + 24 * k), bits.at(x, y)) << x << " " << y << " entry " << k;
        ASSERT_EQ(sources.at(x, y + 24 * k), index.at(x, y));
        const bool is_empty = bits.at(x, y) == 0xffffffffu;
        behind.at(x, y) =
            is_empty ? INFINITY : (std::floor(std::bit_cast<float>(bits.at(x, y)) / bin) + 1) * bin;
        full += !is_empty && k == length - 1;
      }
  }
  EXPECT_GT(full, 100);
}

// What lies on a picture's border is the same as in the middle of a larger picture.
TEST_F(LayersTest, BorderDoesNotShow) {
  show(renderer_, tori(20000), {});
  Camera camera = front_camera(48, 48, 2.2);
  camera.position.z = 1.2;
  const Values values{
      {"layers", "4"}, {"opacity", "0.5"}, {"background_iterations", "2"}, {"occluded_iterations", "2"}};
  const RenderOutput small = render(camera, values), large = render(camera.with_guard_band(40), values);
  int differ = 0;
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 48; ++x)
      differ += glm::length(small.color_linear.at(x, y) - large.color_linear.at(x + 40, y + 40)) > 1e-4f;
  // The other principal point rounds some points into the next pixel; without a guard band 94 border pixels
  // differ in every layer.
  EXPECT_LE(differ, 48 * 48 / 200);
}

TEST_F(LayersTest, SteepSurfaceIsOneLayer) {
  PointCloud cloud = sheet(60000, 1, 0, {200, 200, 200, 255});
  show(renderer_, cloud, {});
  Camera camera = above(64);
  const double angle = glm::radians(78.0);
  camera.position = {0, -4 * std::sin(angle), 4 * std::cos(angle)};
  camera.up = {0, 0, 1};
  camera.height_world = 0.3;
  auto second = [&](const char* shape, const char* scale) {
    const RenderOutput out =
        render(camera, {{"show_layer", "2"}, {"scale_by_angle", scale}, {"point_shape", shape}});
    return std::count_if(out.depth.begin(), out.depth.end(), [](float d) { return !std::isinf(d); });
  };
  // A pixel of 0.3 / 64 sees 0.022 of the surface along the view, a disc of two spacings (0.008) 0.08.
  EXPECT_GT(second("round", "false"), 64 * 64 / 4);
  EXPECT_EQ(second("round", "true"), 0);
  // Discs in the surface lie at its depths; a pixel that was filled lies 0.022 in front of them, which is
  // more than 1.5 spacings and 1.25 px (ADR 214) unless divided by the cosine.
  EXPECT_LE(second("disc", "false"), 64 * 64 / 100);
  EXPECT_EQ(second("disc", "true"), 0);
}

TEST_F(LayersTest, NormalsComeFromTheImageWhereTheCloudHasNone) {
  PointCloud cloud = sphere_cloud(30000);
  const PointCloud with = cloud;
  cloud.normals.clear();
  show(renderer_, cloud, {});
  for (Projection projection : {Projection::perspective, Projection::orthographic}) {
    Camera camera = front_camera(96, 96, 3);
    camera.projection = projection;
    camera.height_world = 2.4;
    const RenderOutput out = render(camera, {{"layers", "1"}}, Shading::lit);
    const dmat4 world = camera.inverse_view();
    const Intrinsics k = camera.intrinsics();
    std::vector<double> errors;
    for (int y = 0; y < 96; ++y)
      for (int x = 0; x < 96; ++x) {
        const double d = out.depth.at(x, y);
        if (std::isinf(d)) continue;
        const double s = projection == Projection::perspective ? d : 1;
        const dvec3 eye((x + 0.5 - k.cx) / k.fx * s, -(y + 0.5 - k.cy) / k.fy * s, -d);
        const dvec3 normal = glm::normalize(dvec3(world * glm::dvec4(eye, 1)));
        if (glm::dot(normal, glm::normalize(camera.position)) < 0.5) continue;  // not the rim
        errors.push_back(
            glm::degrees(std::acos(std::min(glm::dot(normal, dvec3(out.normal.at(x, y))), 1.0))));
      }
    ASSERT_GT(errors.size(), 1000u);
    std::nth_element(errors.begin(), errors.begin() + std::ptrdiff_t(errors.size() / 2), errors.end());
    // Discs of two spacings (0.04) give a pixel the depth of a point up to 0.02 away: some 3 degrees over 5
    // pixels of 0.025.
    EXPECT_LT(errors[errors.size() / 2], 6);
  }
}

// What is peeled is gone, however little is asked to lie between two layers.
TEST_F(LayersTest, AMinimalDistanceOfZeroStillGoesOn) {
  PointCloud cloud;
  cloud.positions = {{0, 0, 0}, {0, 0, -0.5f}, {0, 0, -1}};
  cloud.normals.assign(3, {0, 0, 1});
  cloud.colors = {{250, 0, 0, 255}, {0, 250, 0, 255}, {0, 0, 250, 255}};
  show(renderer_, cloud, {});
  for (const char* distance : {"0", "1e-12"})
    for (const char* peeling : {"passes", "cascade"})
      for (int layer = 1; layer <= 3; ++layer) {
        SCOPED_TRACE(std::string(distance) + " " + peeling + " layer " + std::to_string(layer));
        const RenderOutput out = render(above(9), {{"min_layer_distance", distance},
                                                   {"peeling", peeling},
                                                   {"point_shape", "round"},
                                                   {"point_size", "0.01"},
                                                   {"background_iterations", "0"},
                                                   {"occluded_iterations", "0"},
                                                   {"antialias", "false"},
                                                   {"show_layer", std::to_string(layer)}});
        EXPECT_FLOAT_EQ(out.depth.at(4, 4), 4 + 0.5f * float(layer - 1));
        for (int k = 0; k < 3; ++k) EXPECT_EQ(out.color_linear.at(4, 4)[k] > 0.5f, k == layer - 1) << k;
      }
}

// A mean of the colours of two classes would be that of a third, or of none.
TEST_F(LayersTest, ClassesDoNotMix) {
  PointCloud cloud = sheet(20000, 1, 0, {255, 0, 0, 255});
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (cloud.positions[i].x + 0.3f * cloud.positions[i].y > 0) cloud.colors[i] = {0, 0, 255, 255};
  show(renderer_, cloud, {});
  RenderSettings settings;
  settings.transparent = true;
  settings.shading = Shading::albedo;
  settings.palette = {{1, 0, 0}, {0, 0, 1}};
  for (const char* layers : {"1", "4"}) {
    set_parameter(*technique_, "layers", layers);
    set_parameter(*technique_, "smoothing_iterations", "3");
    const RenderOutput out = renderer_.render(*technique_, above(64), settings, all_outputs());
    std::size_t red = 0, blue = 0;
    for (const vec4& c : out.color_linear) {
      red += c == vec4(1, 0, 0, 1);
      blue += c == vec4(0, 0, 1, 1);
    }
    EXPECT_GT(std::min(red, blue), 1000u);
    EXPECT_EQ(red + blue, out.color_linear.size());
  }
}

TEST_F(LayersTest, OneLayerIsShownAlone) {
  PointCloud cloud = sheets(1, {250, 0, 0, 255});
  append(cloud, sheet(12000, 1, -0.5f, {0, 250, 0, 255}));
  show(renderer_, cloud, {});
  for (int n : {1, 2, 3}) {
    const RenderOutput out =
        render(above(), {{"show_layer", std::to_string(n)}, {"opacity", "0.2"}, {"layers", "1"}});
    const vec4 c = out.color_linear.at(24, 24);
    EXPECT_NEAR(c.a, n < 3 ? 1 : 0, 1e-6);
    EXPECT_NEAR(c.r, n == 1 ? linear(250) : 0, 1e-5);
    EXPECT_NEAR(c.g, n == 2 ? linear(250) : 0, 1e-5);
    if (n < 3)
      EXPECT_NEAR(out.depth.at(24, 24), n == 1 ? 4 : 4.5, 0.02);  // a disc is as deep as its radius
    else
      EXPECT_TRUE(std::isinf(out.depth.at(24, 24)));
  }
}

TEST(LayersInMotion, AreTwoUnlessOneIsShown) {
  const auto layers_of = [](const Values& own) -> std::string {
    const auto technique = find_technique("layers").create();
    for (const auto& [name, value] : own) set_parameter(*technique, name, value);
    for (const auto& [name, value] : technique->in_motion())
      if (name == "layers") return value;
    return "";
  };
  EXPECT_EQ(layers_of({{"layers", "8"}}), "2");
  EXPECT_EQ(layers_of({{"layers", "1"}}), "");
  EXPECT_EQ(layers_of({{"show_layer", "3"}}), "");
}

TEST(OpacityTest, ListFollowsTheScalarsValues) {
  const float nan = std::nanf("");
  const ScalarField classes{"classification", 0, {6, 2, 2, nan, 64}, StoredType::uint8};
  EXPECT_EQ(layers::opacities(classes, {0.1f, 0.5f, 1.0f}),
            (std::vector<float>{0.5f, 0.1f, 0.1f, 1.0f, 1.0f}));
  EXPECT_THROW(layers::opacities(classes, {0.1f, 0.5f}), Error);
  EXPECT_THROW(layers::opacities(classes, {0.1f, 0.5f, 0.2f, 0.3f}), Error);
}

TEST(OpacityTest, FileComesBeforePieceBeforeClass) {
  PointCloud cloud;
  EXPECT_THROW(layers::opacity_scalar(cloud, "auto"), Error);
  for (const char* name : {"classification", "layer", "file"}) {
    cloud.set_scalar({name, 0, {}, StoredType::float32});
    EXPECT_EQ(layers::opacity_scalar(cloud, "auto").name, name);
  }
  EXPECT_EQ(layers::opacity_scalar(cloud, "layer").name, "layer");
  EXPECT_THROW(layers::opacity_scalar(cloud, "intensity"), Error);
}

}  // namespace
