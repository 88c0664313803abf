#include "passes/shadows.h"

#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <memory>

#include "passes/ground.h"
#include "reference/gl_fixture.h"
#include "techniques/casters.h"

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

  /// As many points as a sheet of `side` has, anywhere on it.
  static PointCloud random_sheet(int side, float extent, float height, float x_from, float x_to) {
    PointCloud cloud;
    std::mt19937 random(12);
    std::uniform_real_distribution<float> uniform(-extent, extent);
    for (int i = 0; i < side * side; ++i) {
      const vec3 p(uniform(random), uniform(random), height);
      if (p.x < x_from || p.x > x_to) continue;
      cloud.positions.push_back(p);
      cloud.normals.push_back({0, 0, 1});
    }
    return cloud;
  }

  /// Shadow factor of the ground in a picture of 100 x 100 pixels that sees `across` of it from above.
  Image<float> ground_factor(GpuCloud& gpu, const RenderSettings& settings, double across) {
    const View view(camera_above(4, across, 100), prepared_.cloud.origin);
    gl::Timers timers(false);
    ShadowMaps maps;
    gl::Texture factor("ground factor", GL_R32F, 100, 100);
    maps.update(std::array{&gpu}, settings, Light::parse(settings.light_text), timers, no_progress(), &view,
                Ground{}, &factor);
    return factor.download<float>();
  }

  /// Shadow factor of every point, in the order of `cloud`.
  std::vector<float> factors(const PointCloud& cloud, const RenderSettings& settings,
                             const std::vector<float>& opacity = {}) {
    prepared_ = analysis::prepare(cloud, {}, {});
    GpuCloud gpu(prepared_, colors_of(prepared_.cloud), 7000);
    std::vector<float> casters;
    for (std::uint32_t source : prepared_.cloud.source_index)
      if (!opacity.empty()) casters.push_back(opacity[source]);
    gpu.set_casters(make_casters(gpu, casters));
    gl::Timers timers(false);
    ShadowMaps maps;
    maps.update(std::array{&gpu}, settings, Light::parse(settings.light_text), timers, no_progress());
    std::vector<float> result(cloud.size());
    for (GpuCloud::Chunk& chunk : gpu.chunks()) {
      std::vector<float> values(chunk.count);
      chunk.shadow.buffer().download(values.data(), values.size() * sizeof(float));
      for (std::uint32_t i = 0; i < chunk.count; ++i)
        result[prepared_.cloud.source_index[chunk.first + i]] = values[i];
    }
    return result;
  }

  /// Shadow factors of the points of several clouds of one origin, each in its own order.
  static std::vector<std::vector<float>> factors_of(const std::vector<PointCloud>& clouds,
                                                    const RenderSettings& settings) {
    std::vector<PreparedCloud> prepared;
    for (const PointCloud& cloud : clouds) prepared.push_back(analysis::prepare(cloud, {}, {}));
    std::vector<std::unique_ptr<GpuCloud>> gpu;
    std::vector<GpuCloud*> all;
    for (const PreparedCloud& each : prepared)
      all.push_back(gpu.emplace_back(std::make_unique<GpuCloud>(each, colors_of(each.cloud))).get());
    gl::Timers timers(false);
    ShadowMaps maps;
    maps.update(all, settings, Light::parse(settings.light_text), timers, no_progress());
    std::vector<std::vector<float>> result;
    for (std::size_t k = 0; k < gpu.size(); ++k) {
      std::vector<float>& of = result.emplace_back(clouds[k].size());
      for (GpuCloud::Chunk& chunk : gpu[k]->chunks()) {
        std::vector<float> values(chunk.count);
        chunk.shadow.buffer().download(values.data(), values.size() * sizeof(float));
        for (std::uint32_t i = 0; i < chunk.count; ++i)
          of[prepared[k].cloud.source_index[chunk.first + i]] = values[i];
      }
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
      const double distance =
          glm::length(glm::cross(to_light, to_center));  // of the ray from the sphere's centre
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
  // So it is where nobody knows the normals: the map knows how steep its surface is (81 degrees).
  PointCloud bare = cloud;
  bare.normals.clear();
  for (const char* text : {"dir:0,0,1", "dir:1,0,1", "dir:0.5,1,0.25", "dir:0.9,0.4,0.15"}) {
    const std::vector<float> m = factors(bare, hard(text));
    EXPECT_EQ(std::count_if(m.begin(), m.end(), [](float v) { return v < 1; }), 0) << text << ", no normals";
  }
  factors(cloud, hard("dir:0,0,1"));  // `prepared_` has them again
  // A texel spans up to texel / tan(elevation) in depth: without the scaling, with d_min of one spacing,
  // there is acne.
  RenderSettings tight = hard("dir:0.5,1,0.25");
  tight.shadow_distance.user = 0.2f * prepared_.median_spacing;
  const std::vector<float> m = factors(cloud, tight);
  EXPECT_GT(std::count_if(m.begin(), m.end(), [](float v) { return v < 1; }), 100);
}

// Points a thousand diagonals away neither take the texels of the map nor widen the light.
TEST_F(ShadowTest, StraysDarkenNothing) {
  PointCloud cloud = sheet(120, 2, 0);
  append(cloud, sphere_cloud(6000, 0.5f, vec3(0, 0, 1)));
  for (const char* text : {"dir:0.3,0.2,1", "1,2,6", "0.2,0.1,2"})
    for (const Shadows kind : {Shadows::hard, Shadows::soft}) {
      RenderSettings settings = hard(text);
      settings.shadows = kind;
      settings.light_samples = 4;
      const std::vector<float> alone = factors(cloud, settings);
      PointCloud with = cloud, strays;
      strays.positions = {{5000, 0, 0}, {-3000, 3000, 100}};
      strays.normals.assign(2, {0, 0, 1});
      append(with, strays);
      const std::vector<float> m = factors(with, settings);
      std::size_t different = 0;
      for (std::size_t i = 0; i < alone.size(); ++i) different += std::abs(m[i] - alone[i]) > 0.3f;
      // The strays' own spacings move the median by a thousandth, and so the outlines of hard shadows.
      EXPECT_LE(different, alone.size() / 25) << text;
      for (std::size_t i = alone.size(); i < m.size(); ++i) EXPECT_EQ(m[i], 1) << text;
    }
}

// A dense ball on ground that reaches 200 times as far and gets sparser: a map of 4096 texels cannot have
// those that the ball asks for. What the light reaches stays lit, and the shadow of the ball is there.
TEST_F(ShadowTest, MapsThatAreTooCoarseDarkenNothing) {
  PointCloud cloud = sphere_cloud(60000, 0.5f, vec3(0, 0, 1.5f));
  const std::size_t ball = cloud.size();
  PointCloud ground;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int i = 0; i < 40000; ++i) {
    const double r = std::pow(100.0, uniform(random)), angle = 6.283185307179586 * uniform(random);
    ground.positions.push_back(vec3(float(r * std::cos(angle)), float(r * std::sin(angle)), 0));
    ground.normals.push_back({0, 0, 1});
  }
  append(cloud, ground);
  for (const bool has_normals : {true, false})
    for (const char* text : {"dir:1,0,1", "60,10,60"}) {
      if (!has_normals) cloud.normals.clear();
      const std::vector<float> m = factors(cloud, hard(text));
      const Light light = Light::parse(text);
      std::size_t lit = 0, falsely_dark = 0, shadowed = 0, dark = 0;
      for (std::size_t i = 0; i < cloud.size(); ++i) {
        const dvec3 p(cloud.positions[i]), center(0, 0, 1.5);
        const dvec3 to_light = text[0] == 'd' ? light.vector : glm::normalize(light.vector - p);
        const double from_axis = glm::length(glm::cross(to_light, center - p));
        if (i < ball ? glm::dot(p - center, to_light) > 0.1 : from_axis > 0.7)
          ++lit, falsely_dark += m[i] < 0.99f;
        else if (i >= ball && from_axis < 0.3)
          ++shadowed, dark += m[i] < 0.01f;
      }
      EXPECT_GT(shadowed, 200u) << text;
      EXPECT_EQ(falsely_dark, 0u) << text << (has_normals ? "" : ", no normals") << ", of " << lit;
      EXPECT_GE(dark, shadowed * 0.99) << text << (has_normals ? "" : ", no normals");
    }
}

// Points of a sparse cloud beside a dense one are as wide as their spacing, whatever the texels: a pole casts
// no shadow wider than that, and no light falls through a sheet.
TEST_F(ShadowTest, SparseCloudsCastAsWideAsTheirSpacing) {
  // 0.1 apart beside 0.001 apart: of the dense one's texels, 0.0015, a map would need 23000 a side.
  PointCloud dense = sheet(100, 0.05f, 0.05f), ground = sheet(240, 12, 0);
  const std::size_t plane = ground.size();
  for (float z = 0; z < 4; z += 0.05f)
    for (float angle = 0; angle < 6; ++angle) {
      ground.positions.push_back(vec3(0.1f * std::cos(angle), 0.1f * std::sin(angle), z));
      ground.normals.push_back({std::cos(angle), std::sin(angle), 0});
    }
  for (vec3& p : dense.positions) p += vec3(4, 4, 0);
  const std::vector<float> m = factors_of({dense, ground}, hard("dir:-1,0,1"))[1];
  std::size_t shadowed = 0, beside = 0;
  for (std::size_t i = 0; i < plane; ++i) {
    const vec3 p = ground.positions[i];
    if (p.x < 0.5f || p.x > 3) continue;
    shadowed += std::abs(p.y) < 0.1f && m[i] < 0.5f;
    beside += std::abs(p.y) > 0.1f + 0.15f && m[i] < 0.99f;  // a disc reaches 1.5 spacings beyond the pole
  }
  EXPECT_GT(shadowed, 10u);
  EXPECT_EQ(beside, 0u);

  // Discs a hundred texels wide: light fell through between them.
  const PointCloud patch = sheet(100, 0.1f, 0), roof = sheet(20, 2, 1);
  const std::vector<float> below = factors_of({patch, roof}, hard("dir:0,0,1"))[0];
  EXPECT_GE(std::count(below.begin(), below.end(), 0.0f), std::ptrdiff_t(below.size() * 99 / 100));
}

// The points of a caster near a point light lie as many texels apart as they are nearer to it.
TEST_F(ShadowTest, CastersNearALightLetNoneThrough) {
  for (const double share : {0.5, 1.0 / 3, 0.1}) {  // of the distance from the light to the ground
    PointCloud cloud = sheet(160, 2, 0);
    const std::size_t plane = cloud.size();
    append(cloud, random_sheet(160, 2, float(8 * (1 - share)), float(-share), float(share)));
    for (const bool has_normals : {true, false}) {
      if (!has_normals) cloud.normals.clear();
      const std::vector<float> m = factors(cloud, hard("0,0,8"));
      std::size_t dark = 0, lit = 0, beside = 0, shadowed = 0;
      for (std::size_t i = 0; i < plane; ++i) {
        const vec3 p = cloud.positions[i];
        if (std::abs(p.x) < 0.8f && std::abs(p.y) < 1.8f) ++dark, lit += m[i] > 0.5f;
        // A point reaches 1.3 spacings beyond the rim, seen from the light as far as it is nearer.
        if (std::abs(p.x) > 1 + 2 * 0.025 / share) ++beside, shadowed += m[i] < 0.99f;
      }
      EXPECT_GT(dark, 5000u);
      EXPECT_LE(lit, dark / 100) << share << has_normals;
      EXPECT_LE(shadowed, beside / 500) << share << has_normals;
    }
  }
}

// A part of a cloud that is sparser than the rest casts the shadow that its surface does.
TEST_F(ShadowTest, SparsePartsLetNoneThrough) {
  for (const int times : {2, 5, 10}) {
    const int side = 600;
    PointCloud cloud = sheet(side, 2, 0);
    const std::size_t plane = cloud.size();
    append(cloud, random_sheet(3 * side / times, 6, 1.5f, -6, 1));
    const float own = 4.0f / float(side) * float(times);
    for (const bool has_normals : {true, false}) {
      if (!has_normals) cloud.normals.clear();
      const std::vector<float> m = factors(cloud, hard("dir:0,0,1"));
      std::size_t dark = 0, lit = 0, beside = 0, shadowed = 0;
      for (std::size_t i = 0; i < plane; ++i) {
        const vec3 p = cloud.positions[i];
        if (p.x < 1 - 2 * own) ++dark, lit += m[i] > 0.5f;
        if (p.x > 1 + 1.4f * own) ++beside, shadowed += m[i] < 0.99f;
      }
      EXPECT_GT(dark, 5000u);
      // Among points ten times as dense its batches have points of both, and spacings in between.
      EXPECT_LE(lit, dark * (times < 10 ? 1 : 3) / 100) << times << has_normals;
      EXPECT_LE(shadowed, beside / 500) << times << has_normals;
    }
  }
}

// A wall that is cut off casts nothing, whether shadows were found before or not.
TEST_F(ShadowTest, WhatIsCutOffCastsNothing) {
  PointCloud cloud = sheet(60, 1, 0);
  const std::size_t plane = cloud.size();
  append(cloud, sheet(60, 1, 1));
  prepared_ = analysis::prepare(cloud, {}, {});
  GpuCloud gpu(prepared_, colors_of(prepared_.cloud), 7000);
  const RenderSettings settings = hard("dir:0,0,1");
  gl::Timers timers(false);
  ShadowMaps maps;
  const auto dark_points = [&] {
    maps.update(std::array{&gpu}, settings, Light::parse(settings.light_text), timers, no_progress());
    std::size_t dark = 0;
    for (GpuCloud::Chunk& chunk : gpu.chunks()) {
      std::vector<float> values(chunk.count);
      chunk.shadow.buffer().download(values.data(), values.size() * sizeof(float));
      for (std::uint32_t i = 0; i < chunk.count; ++i)
        dark += prepared_.cloud.source_index[chunk.first + i] < plane && values[i] < 0.5f;
    }
    return dark;
  };
  EXPECT_GT(dark_points(), plane * 9 / 10);
  const float middle = 0.5f - float(prepared_.cloud.origin.z);
  gpu.set_cut({{{0, 0, 1, -middle}}});  // what is above
  EXPECT_EQ(dark_points(), 0u);
  gpu.set_cut({});
  EXPECT_GT(dark_points(), plane * 9 / 10);
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
    const double mean = sum[std::size_t(bin)] / count[std::size_t(bin)],
                 p = expected[std::size_t(bin)] / count[std::size_t(bin)];
    // Three sigma of 64 independent samples, and the edge itself is uncertain by one texel of the map (0.05).
    EXPECT_NEAR(mean, p, 3 * std::sqrt(std::max(p * (1 - p), 0.01) / 64) + 0.05) << bin;
  }
}

// The width of a penumbra, from a tenth to nine tenths of the light, is that of the closed form within 10 %,
// which tells a light from one of twice the size.
TEST_F(ShadowTest, PenumbraIsAsWideAsTheLightAsks) {
  const double light_height = 8, edge_height = 1, size = 3;
  PointCloud cloud = sheet(200, 2, 0);
  const std::size_t plane = cloud.size();
  append(cloud, sheet(200, 2, float(edge_height), -1e9f, 0));
  // A tenth of a disc of radius 1 lies beyond this distance from its centre: acos(u) - u sqrt(1 - u^2) = pi
  // / 10.
  const double tenth = 0.6870;
  const double diagonal = glm::length(dvec3(4, 4, 1));  // where the disc of a directional light stands
  for (const auto& [text, closed_form] :
       {std::pair("0,0,8", tenth * size * edge_height / (light_height - edge_height)),
        std::pair("dir:0,0,1", tenth * size * edge_height / diagonal)}) {
    const auto width = [&](double diameter) {
      RenderSettings settings = hard(text);
      settings.shadows = Shadows::soft;
      settings.light_samples = 100;
      settings.light_size.user = float(diameter);
      const std::vector<float> m = factors(cloud, settings);
      // Mean factor along x, in bins of two spacings.
      std::vector<double> sum(100, 0), count(100, 0);
      for (std::size_t i = 0; i < plane; ++i) {
        if (std::abs(cloud.positions[i].y) > 1) continue;
        const std::size_t bin = std::size_t((cloud.positions[i].x + 2) * 25);
        if (bin < 100) sum[bin] += m[i], count[bin] += 1;
      }
      const auto place_of = [&](double level) {  // in units of x; the factor rises along x
        for (std::size_t bin = 1; bin < 100; ++bin) {
          const double a = sum[bin - 1] / count[bin - 1], b = sum[bin] / count[bin];
          if (a < level && b >= level) return (double(bin) - (b - level) / (b - a)) / 25;
        }
        return 1e9;
      };
      return place_of(0.9) - place_of(0.1);
    };
    EXPECT_NEAR(width(size) / closed_form, 1, 0.1) << text;
    EXPECT_GT(width(2 * size) / closed_form, 1.5) << text;
  }
}

// Several light maps are tested in one visit of the points, whatever the light and the casters: each of them
// counts as it does alone.
TEST_F(ShadowTest, SoftShadowsAreTheMeanOfTheirSamples) {
  PointCloud cloud = sheet(120, 2, 0);
  append(cloud, sphere_cloud(8000, 0.5f, vec3(0, 0, 1)));
  append(cloud, sheet(60, 1, 1.8f));
  std::vector<float> see_through(cloud.size(), 1.0f);
  std::fill(see_through.end() - 60 * 60, see_through.end(), 0.4f);
  const Bounds box = bounds(cloud);
  const int count = 7;  // more than one visit tests, and no multiple of it
  for (const char* text : {"dir:0.3,0.2,1", "1,2,6", "0.1,0.2,1.7"})  // the last one: six faces
    for (const std::vector<float>& opacity : {std::vector<float>(), see_through}) {
      RenderSettings settings = hard(text);
      settings.shadows = Shadows::soft;
      settings.light_samples = count;
      settings.light_size.user = 0.5f;
      const std::vector<float> soft = factors(cloud, settings, opacity);
      std::vector<double> mean(cloud.size(), 0);
      for (const Light& sample : ShadowMaps::light_samples(Light::parse(text), box, 0.5, count)) {
        char one[128];
        std::snprintf(one, sizeof one, "%s%.17g,%.17g,%.17g", text[0] == 'd' ? "dir:" : "", sample.vector.x,
                      sample.vector.y, sample.vector.z);
        const std::vector<float> m = factors(cloud, hard(one), opacity);
        for (std::size_t i = 0; i < m.size(); ++i) mean[i] += m[i] / double(count);
      }
      std::size_t different = 0, partly = 0;
      for (std::size_t i = 0; i < soft.size(); ++i) {
        different += std::abs(soft[i] - mean[i]) > 1e-5;
        partly += soft[i] > 0.01f && soft[i] < 0.99f;
      }
      EXPECT_LE(different, soft.size() / 1000) << text << (opacity.empty() ? "" : " see-through");
      EXPECT_GT(partly, 300u) << text;
    }
}

TEST_F(ShadowTest, ALightInsideTheCloudUsesSixFaces) {
  const Bounds box{{-2, -2, -2}, {2, 2, 2}};
  EXPECT_EQ(ShadowMaps::light_cameras(Light::parse("0,0,0.5"), box, 0.1).size(), 6u);
  EXPECT_EQ(ShadowMaps::light_cameras(Light::parse("0,0,9"), box, 0.1).size(), 1u);
  PointCloud cloud = sphere_cloud(30000, 2);
  append(cloud, sphere_cloud(3000, 0.3f, vec3(1, 0, 0)));
  const std::vector<float> m = factors(cloud, hard("0,0,0.1"));
  // The rim of the small sphere, halfway to the large one, is known to two texels there.
  const double band = 2 * 0.5 * ShadowMaps::texel_spacings * prepared_.median_spacing;
  std::size_t dark = 0, wrong = 0, tested = 0;
  for (std::size_t i = 0; i < 30000; ++i) {
    const dvec3 p(cloud.positions[i]), ray = glm::normalize(p - dvec3(0, 0, 0.1));
    const double distance = glm::length(glm::cross(ray, dvec3(1, 0, -0.1)));
    const bool is_shadowed = p.x > 0 && distance < 0.3;
    if (p.x > 0 && std::abs(distance - 0.3) < band) continue;
    ++tested, dark += is_shadowed;
    wrong += m[i] != (is_shadowed ? 0.0f : 1.0f);
  }
  EXPECT_GT(dark, 300u);
  EXPECT_GT(tested, 29000u);
  EXPECT_EQ(wrong, 0u) << "of " << dark << " in the shadow and " << tested;
}

// A ground plane, unlike a point, may look into a texel that no point fell into.
TEST_F(ShadowTest, NoLightLeaksOntoTheGround) {
  // 5000 points cast some 4.5 of them, front and back, into a texel: 1 % of 570 texels stay empty.
  prepared_ = analysis::prepare(sphere_cloud(5000, 0.5f, vec3(0, 0, 1)), {}, {});
  GpuCloud gpu(prepared_, colors_of(prepared_.cloud));
  const Image<float> lit = ground_factor(gpu, hard("dir:0,0,1"), 2);
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 100; ++x) {
      const double r = std::hypot(x - 49.5, y - 49.5) / 50;
      if (r < 0.44) ASSERT_NEAR(lit.at(x, y), 0, 1e-6) << r;  // a texel of 0.04 inside the outline
      if (r > 0.6) ASSERT_NEAR(lit.at(x, y), 1, 1e-6) << r;
    }
}

// Haze has no depth: colour without a surface stands before the plane, and is as bright as without it.
TEST_F(ShadowTest, TheGroundIsSeenThroughHaze) {
  const View view(camera_above(4, 2, 16), dvec3(0));
  gl::Texture color("color", GL_RGBA32F, 16, 16), depth("depth", GL_R32F, 16, 16),
      factor("factor", GL_R32F, 16, 16), out("out", GL_RGBA32F, 16, 16);
  const vec4 haze(0.2f, 0.3f, 0.1f, 0.4f);
  color.clear(haze);
  factor.clear(vec4(0));
  const float shadow = 0.75f;  // ground.glsl
  struct Case {
    float depth;
    vec4 expected;
  };
  for (const Case& each : {Case{INFINITY, vec4(vec3(haze), 0.4f + 0.6f * shadow)},
                           Case{3, vec4(vec3(haze), 0.4f + 0.6f * shadow)},     // a surface before the plane
                           Case{5, vec4(vec3(haze) * (1 - shadow), 0.85f)}}) {  // and one below
    depth.clear(vec4(each.depth));
    GroundPlane().run(view, Ground{}, dvec3(0), color, depth, factor, out);
    const Image<vec4> drawn = out.download<vec4>();
    for (const vec4& c : drawn)
      for (int k = 0; k < 4; ++k) ASSERT_NEAR(c[k], each.expected[k], 1e-6) << each.depth << " " << k;
  }
}

// Each of the six maps of a light inside the cloud counts for the ground that it sees.
TEST_F(ShadowTest, ALightInsideTheCloudShinesOnTheGroundOnce) {
  PointCloud cloud = sphere_cloud(5000, 0.5f, vec3(0, 0, 1));
  append(cloud, sheet(20, 0.2f, 3));
  for (const bool see_through : {false, true}) {
    prepared_ = analysis::prepare(cloud, {}, {});
    GpuCloud gpu(prepared_, colors_of(prepared_.cloud));
    if (see_through) gpu.set_casters(make_casters(gpu, std::vector<float>(cloud.size(), 0.5f)));
    ASSERT_EQ(ShadowMaps::light_cameras(Light::parse("0,0,2.5"), gpu.bounds(), 0.1).size(), 6u);
    const Image<float> lit = ground_factor(gpu, hard("0,0,2.5"), 6);
    // The light 1.5 above the centre of a sphere of 0.5 throws its outline 2.5 tan(asin(1/3)) = 0.884 wide;
    // the faces meet on the ground 2.5 from the middle.
    for (int y = 0; y < 100; ++y)
      for (int x = 0; x < 100; ++x) {
        const double r = std::hypot(x - 49.5, y - 49.5) * 6 / 100;
        if (r < 0.75) ASSERT_NEAR(lit.at(x, y), see_through ? 0.25 : 0, 1e-5) << r;
        if (r > 1.05) ASSERT_NEAR(lit.at(x, y), 1, 1e-5) << r << " " << x << " " << y;
      }
  }
}

// Seen from the light, every surface of opacity a lets 1 - a pass, and what it lets pass is multiplied.
TEST_F(ShadowTest, SeeThroughCastersDarkenByTheirOpacity) {
  struct Caster {
    float height, opacity;
  };
  const std::vector<std::pair<std::vector<Caster>, double>> cases{
      {{{1, 0.2f}}, 0.8},
      {{{1, 0.2f}, {1.4f, 0.2f}}, 0.64},
      {{{1, 0.5f}, {1.4f, 0.5f}, {1.8f, 0.5f}}, 0.125},
      {{{1, 0.3f}, {1.4f, 0.6f}}, 0.7 * 0.4},
      {{{0.6f, 0.2f}, {0.9f, 0.2f}, {1.2f, 0.2f}, {1.5f, 0.2f}, {1.8f, 0.2f}},
       0.32768},      // more than one visit tests
      {{{1, 0}}, 1},  // removed
      {{{1, 0.2f}, {1.4f, 0}}, 0.8},
      {{{1, 0.2f}, {1.4f, 1}}, 0},  // solid behind and in front
      {{{1, 1}, {1.4f, 0.2f}}, 0},
      {{{1, 0.2f}, {-1, 0.5f}}, 0.8},  // the last one lies behind the plane
  };
  // Two layers under every light, the others under one of them each: the maps of one take seconds.
  const std::vector<const char*> lights{"dir:0,0,1", "dir:0.5,0.3,1", "dir:1,0,0.6", "1,0,9"};
  for (std::size_t c = 0; c < cases.size(); ++c)
    for (std::size_t l = 0; l < lights.size(); ++l) {
      if (c != 1 && l != c % lights.size()) continue;
      const auto& [casters, expected] = cases[c];
      const char* const text = lights[l];
      PointCloud cloud = sheet(100, 1, 0);
      const std::size_t plane = cloud.size();
      std::vector<float> opacity(plane, 1.0f);
      for (const Caster& caster : casters) {
        append(cloud, sheet(200, 4, caster.height));
        opacity.resize(cloud.size(), caster.opacity);
      }
      const std::vector<float> m = factors(cloud, hard(text), opacity);
      double sum = 0;
      std::size_t right = 0;
      for (std::size_t i = 0; i < plane; ++i) {
        sum += m[i] / double(plane);
        right += std::abs(m[i] - expected) < 1e-5;  // some roundings of 1e-7
      }
      // Empty texels that the filters leave: below 1 % (the outline test above).
      EXPECT_GE(right, plane * 0.99) << text << " " << expected << " got " << sum << ", casters "
                                     << casters.size();
      EXPECT_NEAR(sum, expected, 0.01) << text;
      // A sheet does not darken itself, nor what is in front of it.
      std::size_t own = 0, own_right = 0;
      double in_front = 1;
      for (const Caster& other : casters)
        if (other.height > casters[0].height) in_front *= 1 - other.opacity;
      for (std::size_t i = plane; i < plane + 200 * 200; ++i) {
        if (std::abs(cloud.positions[i].x) > 1 || std::abs(cloud.positions[i].y) > 1) continue;
        ++own;
        own_right += std::abs(m[i] - in_front) < 1e-5;
      }
      EXPECT_GE(own_right, own * 0.99) << text << " own, expected " << in_front;
    }
}

// The ground under see-through casters, and casters on two sides of the limits of GPU buffers (7000 points).
TEST_F(ShadowTest, SeeThroughCastersDarkenTheGround) {
  PointCloud cloud = sheet(200, 1, 1);
  append(cloud, sheet(200, 1, 1.5f));
  prepared_ = analysis::prepare(cloud, {}, {});
  GpuCloud gpu(prepared_, colors_of(prepared_.cloud), 7000);
  gpu.set_casters(make_casters(gpu, std::vector<float>(cloud.size(), 0.3f)));
  const Image<float> lit = ground_factor(gpu, hard("dir:0,0,1"), 4);
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 100; ++x) {
      const double away = std::max(std::abs(x - 49.5), std::abs(y - 49.5)) / 25;  // the sheets reach 1
      if (away < 0.94) ASSERT_NEAR(lit.at(x, y), 0.49, 1e-5) << away;
      if (away > 1.06) ASSERT_NEAR(lit.at(x, y), 1, 1e-6) << away;
    }
}

/// What the process has in memory, bytes.
std::size_t resident_bytes() {
  malloc_trim(0);
  std::ifstream statm("/proc/self/statm");
  std::size_t pages = 0, resident = 0;
  statm >> pages >> resident;
  return resident * std::size_t(sysconf(_SC_PAGESIZE));
}

// Light maps of 4096 x 4096 texels: without shadows nothing of them is kept.
TEST_F(ShadowTest, MapsGoWithTheShadows) {
  if (!gl::limits().software) GTEST_SKIP() << "the memory of a GPU is not the process's";
  // As dense as a scan that is a hundred times larger; a part of it is far away.
  PointCloud cloud = sheet(60, 0.02f, 0), far = sheet(60, 0.02f, 1);
  for (vec3& p : far.positions) p += vec3(20, 20, 0);
  append(cloud, far);
  prepared_ = analysis::prepare(cloud, {}, {});
  GpuCloud gpu(prepared_, colors_of(prepared_.cloud), 7000);
  gl::Timers timers(false);
  ShadowMaps maps;
  const RenderSettings settings = hard("dir:0,0,1");
  const std::size_t before = resident_bytes(), map = std::size_t(64) << 20;
  maps.update(std::array{&gpu}, settings, Light::parse(settings.light_text), timers, no_progress());
  glFinish();
  const std::size_t with_maps = resident_bytes();
  EXPECT_GT(with_maps, before + 5 * map / 2) << "depth, bits and a copy; the test would prove nothing";
  maps.clear(std::array{&gpu});
  glFinish();
  // llvmpipe holds on to textures that were drawn into until it draws again, in each of its scenes.
  const PreparedCloud small = analysis::prepare(sheet(10, 1, 0), {}, {});
  GpuCloud other(small, colors_of(small.cloud), 7000);
  ShadowMaps others;
  for (int i = 0; i < 4; ++i) {
    const std::string light = "dir:0," + std::to_string(i) + ",1";
    others.update(std::array{&other}, hard(light), Light::parse(light), timers, no_progress());
    glFinish();
  }
  EXPECT_LT(resident_bytes(), with_maps - 5 * map / 2);
  // And shadows come back.
  maps.update(std::array{&gpu}, settings, Light::parse(settings.light_text), timers, no_progress());
  EXPECT_TRUE(gpu.has_shadow());
}

}  // namespace
