#include "passes/shadows.h"

#include "reference/gl_fixture.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

class ShadowTest : public GlTest {
 protected:
  /// A square of jittered points around the origin, normal +Z, at `height`.
  static PointCloud sheet(int side, float extent, float height, float x_from = -1e9f, float x_to = 1e9f) {
    PointCloud cloud;
    std::mt19937 random(11);
    std::uniform_real_distribution<float> jitter(0, 1);
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        const float x = extent * ((float(i) + jitter(random)) / float(side) * 2 - 1);
        const float y = extent * ((float(j) + jitter(random)) / float(side) * 2 - 1);
        if (x < x_from || x > x_to) continue;
        cloud.positions.push_back({x, y, height});
        cloud.normals.push_back({0, 0, 1});
      }
    return cloud;
  }

  /// Shadow factor of every point, in the order of `cloud`.
  std::vector<float> factors(const PointCloud& cloud, const RenderSettings& settings) {
    prepared_ = analysis::prepare(cloud, {}, {});
    GpuCloud gpu(prepared_, colors_of(prepared_.cloud), 7000);
    gl::Timers timers(false);
    ShadowMaps maps;
    maps.update(gpu, settings, Light::parse(settings.light_text), timers, no_progress());
    std::vector<float> result(cloud.size());
    for (GpuCloud::Chunk& chunk : gpu.chunks()) {
      std::vector<float> values(chunk.count);
      chunk.shadow.buffer().download(values.data(), values.size() * sizeof(float));
      for (std::uint32_t i = 0; i < chunk.count; ++i)
        result[prepared_.cloud.source_index[chunk.first + i]] = values[i];
    }
    return result;
  }

  static RenderSettings hard(const std::string& light) {
    RenderSettings settings;
    settings.shadows = Shadows::hard;
    settings.light_text = light;
    return settings;
  }
  PreparedCloud prepared_;
};

// A sphere over a plane: lit flags agree with the analytic outline outside a band of two texels.
TEST_F(ShadowTest, OutlineOfASphereIsTheAnalyticOne) {
  PointCloud cloud = sheet(160, 2, 0);
  const std::size_t plane = cloud.size();
  append(cloud, sphere_cloud(20000, 0.5f, vec3(0, 0, 1)));
  const dvec3 light(1, 2, 6);
  for (const char* text : {"1,2,6", "dir:0.3,0.2,1"}) {
    const bool is_point = text[0] != 'd';
    const std::vector<float> m = factors(cloud, hard(text));
    const double band = 2 * ShadowMaps::texel_spacings * prepared_.median_spacing;
    std::size_t dark = 0, wrong = 0, tested = 0;
    for (std::size_t i = 0; i < plane; ++i) {
      const dvec3 p(cloud.positions[i]);
      const dvec3 to_light = glm::normalize(is_point ? light - p : dvec3(0.3, 0.2, 1));
      const dvec3 to_center = dvec3(0, 0, 1) - p;
      const double distance = glm::length(glm::cross(to_light, to_center));  // of the ray from the sphere's centre
      if (std::abs(distance - 0.5) < band) continue;
      ++tested;
      dark += distance < 0.5;
      wrong += (m[i] < 0.5f) != (distance < 0.5);
    }
    EXPECT_GT(dark, 500u) << text;
    EXPECT_GT(tested, plane * 3 / 4);
    // The map has 11 % empty texels of which the filter leaves a few: 1 % may be lit through the sphere.
    EXPECT_LE(wrong, dark / 100 + 1) << text;
  }
}

// No acne: one plane under a tilted light is fully lit, and it is the scaling by the normal that does it.
TEST_F(ShadowTest, ATiltedPlaneIsFullyLit) {
  PointCloud cloud = sheet(120, 1, 0);
  for (const char* text : {"dir:0,0,1", "dir:1,0,1", "dir:1,0.3,0.5", "dir:0.5,1,0.25", "0.5,0,0.4"}) {
    const std::vector<float> m = factors(cloud, hard(text));
    EXPECT_EQ(std::count_if(m.begin(), m.end(), [](float v) { return v < 1; }), 0) << text;
  }
  // A texel spans up to texel / tan(elevation) in depth: without the scaling, with d_min of one spacing, there is acne.
  RenderSettings tight = hard("dir:0.5,1,0.25");
  tight.shadow_distance.user = 0.2f * prepared_.median_spacing;
  const std::vector<float> m = factors(cloud, tight);
  EXPECT_GT(std::count_if(m.begin(), m.end(), [](float v) { return v < 1; }), 100);
}

// The penumbra of a straight edge under a disc-shaped light is the share of the disc that is seen.
TEST_F(ShadowTest, PenumbraIsTheVisibleShareOfTheLight) {
  const double light_height = 8, edge_height = 1, light_radius = 2;
  PointCloud cloud = sheet(140, 2, 0);
  const std::size_t plane = cloud.size();
  append(cloud, sheet(140, 2, float(edge_height), -1e9f, 0));  // the occluder covers x < 0
  RenderSettings settings = hard("0,0,8");
  settings.shadows = Shadows::soft;
  settings.light_samples = 64;
  settings.light_size.user = float(2 * light_radius);
  const std::vector<float> m = factors(cloud, settings);
  std::vector<double> sum(8, 0), expected(8, 0);
  std::vector<int> count(8, 0);
  for (std::size_t i = 0; i < plane; ++i) {
    const double x = cloud.positions[i].x;
    if (std::abs(x) > 0.4 || std::abs(cloud.positions[i].y) > 1) continue;
    // (x,0) sees the light's point u when x + (u - x) h / H > 0; the share of the disc with u > cut:
    const double cut = std::clamp(x * (1 - light_height / edge_height) / light_radius, -1.0, 1.0);
    const double seen = (std::acos(cut) - cut * std::sqrt(1 - cut * cut)) / 3.141592653589793;
    const std::size_t bin = std::size_t(std::min(7.0, (x + 0.4) * 10));
    sum[bin] += m[i];
    expected[bin] += seen;
    ++count[bin];
  }
  for (int bin = 0; bin < 8; ++bin) {
    const double mean = sum[std::size_t(bin)] / count[std::size_t(bin)], p = expected[std::size_t(bin)] / count[std::size_t(bin)];
    // Three sigma of 64 independent samples, and the edge itself is uncertain by one texel of the map (0.05).
    EXPECT_NEAR(mean, p, 3 * std::sqrt(std::max(p * (1 - p), 0.01) / 64) + 0.05) << bin;
  }
}

TEST_F(ShadowTest, ALightInsideTheCloudUsesSixFaces) {
  const Bounds box{{-2, -2, -2}, {2, 2, 2}};
  EXPECT_EQ(ShadowMaps::light_cameras(Light::parse("0,0,0.5"), box, 0.1).size(), 6u);
  EXPECT_EQ(ShadowMaps::light_cameras(Light::parse("0,0,9"), box, 0.1).size(), 1u);
  PointCloud cloud = sphere_cloud(30000, 2);
  append(cloud, sphere_cloud(3000, 0.3f, vec3(1, 0, 0)));
  const std::vector<float> m = factors(cloud, hard("0,0,0.1"));
  std::size_t lit = 0, dark = 0;
  for (std::size_t i = 0; i < 30000; ++i) {
    const dvec3 p(cloud.positions[i]), ray = glm::normalize(p - dvec3(0, 0, 0.1));
    const double distance = glm::length(glm::cross(ray, dvec3(1, 0, -0.1)));
    if (p.x > 0 && distance < 0.2) dark += m[i] == 0;
    else if (distance > 0.45 || p.x < 0) lit += m[i] == 1;
    else ++lit;
  }
  EXPECT_GT(dark, 30u);
  EXPECT_GT(lit + dark, 29500u);  // edges of the six faces and the rim of the small sphere
}

// A ground plane, unlike a point, may look into a texel that no point fell into.
TEST_F(ShadowTest, NoLightLeaksOntoTheGround) {
  // 5000 points cast some 4.5 of them, front and back, into a texel: 1 % of 570 texels stay empty.
  prepared_ = analysis::prepare(sphere_cloud(5000, 0.5f, vec3(0, 0, 1)), {}, {});
  GpuCloud gpu(prepared_, colors_of(prepared_.cloud));
  Camera camera;
  camera.position = {0, 0, 4};
  camera.up = {0, 1, 0};
  camera.projection = Projection::orthographic;
  camera.height_world = 2;
  camera.width = camera.height = 100;
  const View view(camera, prepared_.cloud.origin);
  const RenderSettings settings = hard("dir:0,0,1");
  gl::Timers timers(false);
  ShadowMaps maps;
  gl::Texture factor("ground factor", GL_R32F, 100, 100);
  maps.update(gpu, settings, Light::parse(settings.light_text), timers, no_progress(), &view, Ground{}, &factor);
  const Image<float> lit = factor.download<float>();
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 100; ++x) {
      const double r = std::hypot(x - 49.5, y - 49.5) / 50;
      if (r < 0.44) ASSERT_NEAR(lit.at(x, y), 0, 1e-6) << r;  // a texel of 0.04 inside the outline
      if (r > 0.6) ASSERT_NEAR(lit.at(x, y), 1, 1e-6) << r;
    }
}

}  // namespace
