// Binned splats against the oracle, analytic answers and each other.
#include "techniques/denoise/bins.h"

#include "techniques/denoise/worth.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "gl/preferences.h"
#include "passes/splat_cpu.h"
#include "reference/compare.h"
#include "reference/gl_fixture.h"
#include "reference/splat_oracle.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

/// A square of jittered points in the plane y = depth, facing the camera at -Y; `cover` splats over every
/// place.
PointCloud plane_cloud(float depth, Rgba8 color, std::size_t side = 40, double cover = 10, float sigma = 0,
                       unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> jitter(-0.5f, 0.5f);
  std::normal_distribution<float> noise(0, sigma > 0 ? sigma : 1);
  PointCloud cloud;
  const float pitch = 2.0f / float(side);
  for (std::size_t i = 0; i < side * side; ++i) {
    const vec2 at = (vec2(i % side, i / side) + 0.5f + vec2(jitter(random), jitter(random))) * pitch - 1.0f;
    cloud.positions.push_back({at.x, depth + (sigma > 0 ? noise(random) : 0), at.y});
    cloud.normals.push_back({0, -1, 0});
    cloud.radii.push_back(pitch * float(std::sqrt(cover / M_PI)));
    cloud.colors.push_back(color);
  }
  return cloud;
}

void add_disc(PointCloud& cloud, vec3 center, float radius, Rgba8 color) {
  cloud.positions.push_back(center);
  cloud.normals.push_back({0, -1, 0});
  cloud.radii.push_back(radius);
  cloud.colors.push_back(color);
}

PointCloud noisy_sphere(std::size_t count, float sigma, std::size_t outliers, unsigned seed) {
  PointCloud cloud = sphere_cloud(count);
  std::mt19937 random(seed);
  std::normal_distribution<float> noise(0, sigma);
  std::uniform_real_distribution<float> uniform(-1.3f, 1.3f);
  for (std::size_t i = 0; i < count; ++i) cloud.positions[i] += noise(random) * cloud.normals[i];
  for (std::size_t i = 0; i < outliers; ++i) {
    cloud.positions.push_back({uniform(random), uniform(random), uniform(random)});
    cloud.normals.push_back(glm::normalize(vec3(uniform(random), -1.4f, uniform(random))));
    cloud.colors.push_back({90, 90, 90, 255});
  }
  cloud.radii.assign(cloud.size(), 0.08f);
  return cloud;
}

struct OracleOptions {
  double bin_size = 0.1, threshold = 0;
  bool overlapping = false, grid = false;
};

/// The paper's Eqs. 1-6 for one ray, with a map instead of a table.
OracleSurface oracle_denoise(const OracleRay& ray, const std::vector<OracleSplat>& splats, double near_plane,
                             const OracleOptions& o) {
  OracleSurface out;
  const std::vector<OracleHit> hits = oracle_hits(ray, splats, near_plane, &out.fragile);
  if (hits.empty()) return out;
  const double first = hits.front().t, begin = o.grid ? std::floor(first / o.bin_size) * o.bin_size : first;
  if (o.grid && std::abs(first / o.bin_size - std::round(first / o.bin_size)) < 1e-4) out.fragile = true;
  const double steps = o.overlapping ? 2 : 1;
  std::map<long, std::vector<OracleHit>> bins;
  for (const OracleHit& hit : hits) {
    const double place = (hit.t - begin) / o.bin_size * steps;
    if (hit.t != first && std::abs(place - std::round(place)) < 1e-3) out.fragile = true;
    bins[long(std::floor(place))].push_back(hit);
    if (o.overlapping && place >= 1) bins[long(std::floor(place)) - 1].push_back(hit);
  }
  for (const auto& [b, inside] : bins) {
    double weight = 0, t = 0;
    dvec3 color(0), normal(0);
    for (const OracleHit& hit : inside) {
      const OracleSplat& s = splats[hit.splat];
      const double w = wendland(hit.rho);
      weight += w;
      color += w * s.color;
      t += w * hit.t;
      normal += w * (glm::dot(s.normal, ray.direction) > 0 ? -s.normal : s.normal);
    }
    if (std::abs(weight - o.threshold) < 1e-3) out.fragile = true;
    if (weight <= o.threshold) continue;
    out.weight = weight;
    out.color = color / weight;
    out.normal = glm::normalize(normal);
    out.t = t / weight;
    out.depth = out.t * ray.cosine;
    return out;
  }
  return out;
}

Camera straight_camera(int side) {  // one pixel = 2 / side, straight onto the plane y = 0
  Camera camera;
  camera.position = {0, -4, 0};
  camera.projection = Projection::orthographic;
  camera.height_world = 2;
  camera.width = camera.height = side;
  return camera;
}

class Denoise : public GlTest {
 protected:
  Denoise() {
    settings_.transparent = true;
    settings_.shading = Shading::albedo;
    for (auto [name, value] : {std::pair{"antialias", "false"},
                               {"clamp_radius", "false"},
                               {"bin_size", "0.1"},
                               {"weight_threshold", "0.5"}})
      set(name, value);
  }
  void set(const std::string& name, const std::string& value) { set_parameter(*technique_, name, value); }
  RenderOutput render(const PointCloud& cloud, const Camera& camera) {
    return render(*technique_, cloud, camera);
  }
  RenderOutput render(Technique& technique, const PointCloud& cloud, const Camera& camera) {
    Renderer renderer(context());
    show(renderer, cloud, technique.needs());
    return renderer.render(technique, camera, settings_, all_outputs());
  }
  void expect_like_oracle(const PointCloud& cloud, const Camera& asked, const OracleOptions& o) {
    set("bin_size", std::to_string(o.bin_size));
    set("weight_threshold", std::to_string(o.threshold));
    const RenderOutput out = render(cloud, asked);
    Camera camera = asked;
    camera.fit_depth_range(bounds(cloud));
    const std::vector<OracleSplat> splats = oracle_splats(cloud);
    const OracleImages oracle = oracle_images(
        camera, [&](const OracleRay& ray) { return oracle_denoise(ray, splats, splat_near(camera), o); });
    // As for surface splats: normals of 2 x 16 bit shift the hits of tilted discs; fixed point adds 2^-16 a
    // hit.
    const Difference color = compare(out.color_linear, oracle.color, oracle.band, 2e-3);
    EXPECT_LT(color.max, 4e-3);
    EXPECT_LT(color.mean, 5e-5);
    const Difference depth = compare(out.depth, oracle.depth, oracle.band, 1e-3);
    EXPECT_LT(depth.max, 1e-3);
    const Difference normal = compare(out.normal, oracle.normal, oracle.band, 1e-2);
    EXPECT_LT(normal.max, 1e-2);
    EXPECT_LT(color.band, out.depth.size() / 4) << "the band must not swallow the test";
    EXPECT_LT(color.flips, 0.2);
    EXPECT_LT(std::abs(depth.bias), 0.1);
  }
  // Radii as they are in the cloud, as the oracle takes them.
  static std::unique_ptr<Technique> plain_denoise() {
    auto technique = find_technique("denoise").create();
    set_parameter(*technique, "radius_scale", "1");
    return technique;
  }
  std::unique_ptr<Technique> technique_ = plain_denoise();
  RenderSettings settings_;
};

TEST_F(Denoise, IsTheFoldOverTheBins) {
  const PointCloud cloud = noisy_sphere(1500, 0.03f, 300, 1);
  for (double threshold : {0.5, 2.0}) {  // 0: ThresholdZeroEqualsSplats
    SCOPED_TRACE(threshold);
    expect_like_oracle(cloud, front_camera(64, 48), {0.1, threshold});
  }
}

TEST_F(Denoise, OverlappingBinsAndGridAreFoldsToo) {
  const PointCloud cloud = noisy_sphere(1500, 0.03f, 300, 2);
  set("overlapping", "true");
  expect_like_oracle(cloud, front_camera(64, 48), {.threshold = 0.8, .overlapping = true});
  set("anchor", "grid");
  expect_like_oracle(cloud, front_camera(48, 36), {.threshold = 0.8, .overlapping = true, .grid = true});
  set("overlapping", "false");
  expect_like_oracle(cloud, front_camera(48, 36), {.threshold = 0.8, .grid = true});
}

// T = 0 takes the first bin, which is what three-pass splatting takes with epsilon = Delta.
TEST_F(Denoise, ThresholdZeroEqualsSplats) {
  auto splats = find_technique("splats").create();
  set_parameter(*splats, "radius_scale", "1");
  set_parameter(*splats, "epsilon", "0.1");
  set_parameter(*splats, "antialias", "false");
  set_parameter(*splats, "clamp_radius", "false");
  set("weight_threshold", "1e-9");  // through the table, where every hit is more than this
  for (const PointCloud& cloud : {noisy_sphere(4000, 1e-6f, 0, 3), noisy_sphere(4000, 0.03f, 400, 3)}) {
    const RenderOutput a = render(cloud, front_camera(96, 64)),
                       b = render(*splats, cloud, front_camera(96, 64));
    std::size_t different = 0;
    for (std::size_t i = 0; i < a.rgba8.size(); ++i) {
      const Rgba8 p = a.rgba8.data()[i], q = b.rgba8.data()[i];
      ASSERT_EQ(p.a, q.a);
      const int most = std::max({std::abs(p.r - q.r), std::abs(p.g - q.g), std::abs(p.b - q.b)});
      different += most > 1;
    }
    // A hit whose distance rounds onto the border between the bins is kept by one of the two: float has 2^-22
    // of the distance, a bin is 0.1, so that far less than one pixel in a thousand holds such a hit.
    EXPECT_LE(different, a.rgba8.size() / 1000);
    for (const char* threshold : {"0", "auto"}) {  // and at 0, whichever slider says it, to the bit
      set("weight_threshold", threshold);
      set("strictness", "0");
      const RenderOutput c = render(cloud, front_camera(96, 64));
      for (std::size_t i = 0; i < b.depth.size(); ++i) {
        ASSERT_EQ(b.color_linear.data()[i], c.color_linear.data()[i]);
        ASSERT_EQ(b.depth.data()[i], c.depth.data()[i]);
        ASSERT_EQ(b.normal.data()[i], c.normal.data()[i]);
      }
    }
    set("weight_threshold", "1e-9");
  }
}

// Hardly any evidence asked for: the first bin, with what is in it, and no weight too large for the table.
TEST_F(Denoise, StrictnessNearZeroShowsTheFirstBin) {
  const PointCloud cloud = noisy_sphere(4000, 0.03f, 400, 3);
  set("prefilter", "false");
  set("weight_threshold", "1e-9");
  const RenderOutput first = render(cloud, front_camera(96, 64));
  set("weight_threshold", "auto");
  for (const char* strictness : {"1e-7", "1e-30"}) {
    SCOPED_TRACE(strictness);
    set("strictness", strictness);
    const RenderOutput out = render(cloud, front_camera(96, 64));
    EXPECT_TRUE(out.notes.empty()) << out.notes.front();
    std::size_t different = 0;
    for (std::size_t i = 0; i < out.rgba8.size(); ++i) {
      const Rgba8 p = first.rgba8.data()[i], q = out.rgba8.data()[i];
      // Sums are in units of the table's weights, which are others.
      different +=
          std::max({std::abs(p.r - q.r), std::abs(p.g - q.g), std::abs(p.b - q.b)}) > 1 || p.a != q.a;
    }
    EXPECT_EQ(different, 0u);
  }
}

// One point far away makes no bin of a hundred units.
TEST_F(Denoise, AStrayDoesNotWidenTheBins) {
  PointCloud cloud = plane_cloud(0, {255, 0, 0, 255}, 60, 2);
  append(cloud, plane_cloud(0.5f, {0, 0, 255, 255}, 60, 2));
  set("bin_size", "auto");
  set("weight_threshold", "auto");
  set("antialias", "true");
  const auto bin_size = [&](float farthest) {
    PointCloud all = cloud;
    if (farthest > 0) {
      all.positions.push_back({0, farthest, 0});
      all.normals.push_back({0, -1, 0});
      all.colors.push_back({0, 255, 0, 255});
      if (!all.radii.empty()) all.radii.push_back(all.radii.front());
    }
    const RenderOutput out = render(all, front_camera(96, 72));
    EXPECT_LT(out.color_linear.at(48, 36).b, 0.01f) << "the sheets mix";
    ParamList parameters;
    technique_->describe(parameters);
    return std::stof(parameters.find("bin_size")->resolved());
  };
  const float usual = bin_size(0);
  EXPECT_LT(usual, 0.3f);
  for (const float farthest : {2e2f, 2e4f, 2e6f})
    EXPECT_NEAR(bin_size(farthest), usual, 0.1f * usual) << farthest;
}

// Where the points thin out, too: discs of both have one limit.
TEST_F(Denoise, StrictnessZeroEqualsSplatsOnSparseParts) {
  PointCloud cloud;
  std::mt19937 random(4);
  std::uniform_real_distribution<float> across(-1, 1);
  for (int i = 0; i < 20'000; ++i) {  // on the right a ninth of the points, of three times the radius
    const vec3 p(across(random), 0, across(random));
    if (p.x > 0 && i % 9 != 0) continue;
    cloud.positions.push_back(p);
    cloud.normals.push_back({0, -1, 0});
    cloud.colors.push_back({std::uint8_t(i % 200), 80, 80, 255});
  }
  auto splats = find_technique("splats").create();
  auto denoise = find_technique("denoise").create();
  set_parameter(*splats, "epsilon", "0.1");
  set_parameter(*denoise, "bin_size", "0.1");
  set_parameter(*denoise, "strictness", "0");
  const Camera camera = front_camera(96, 64);
  const RenderOutput a = render(*splats, cloud, camera), b = render(*denoise, cloud, camera);
  for (std::size_t i = 0; i < a.depth.size(); ++i) {
    ASSERT_EQ(a.color_linear.data()[i], b.color_linear.data()[i]) << i;
    ASSERT_EQ(a.depth.data()[i], b.depth.data()[i]) << i;
  }
}

TEST_F(Denoise, HashedEqualsDenseWithoutOverflow) {
  const PointCloud cloud = noisy_sphere(3000, 0.05f, 600, 4);
  for (const char* threshold : {"0.3", "1.5", "auto"}) {
    SCOPED_TRACE(threshold);
    set("weight_threshold", threshold);
    set("hash_bits", "6");
    set("bins", "hashed");
    const RenderOutput hashed = render(cloud, front_camera(72, 48));
    for (const std::string& note : hashed.notes) EXPECT_NE(note.find("outliers"), std::string::npos) << note;
    set("bins", "dense");
    const RenderOutput dense = render(cloud, front_camera(72, 48));
    for (std::size_t i = 0; i < dense.depth.size(); ++i) {
      ASSERT_EQ(hashed.depth.data()[i], dense.depth.data()[i]);
      ASSERT_EQ(hashed.color_linear.data()[i], dense.color_linear.data()[i]);
    }
  }
}

// The size of the table is no choice of the user's: a full one grows until every bin has room.
TEST_F(Denoise, FullTablesGiveTheSameBits) {
  set("weight_threshold", "2");
  const PointCloud cloud = noisy_sphere(3000, 0.05f, 1500, 4);
  set("hash_bits", "6");
  const RenderOutput roomy = render(cloud, front_camera(72, 48));
  set("hash_bits", "1");
  for (int run = 0; run < 20; ++run) {
    const RenderOutput full = render(cloud, front_camera(72, 48));
    EXPECT_TRUE(full.notes.empty());
    for (std::size_t i = 0; i < full.depth.size(); ++i) {
      ASSERT_EQ(roomy.color_linear.data()[i], full.color_linear.data()[i]);
      ASSERT_EQ(roomy.depth.data()[i], full.depth.data()[i]);
      ASSERT_EQ(roomy.normal.data()[i], full.normal.data()[i]);
    }
  }
}

// One stray splat in front of a plane that twenty splats cover (20/7 on average, nowhere less than 1).
TEST_F(Denoise, SingleOutlierDisappears) {
  PointCloud cloud = plane_cloud(0, {0, 255, 0, 255}, 40, 20);
  add_disc(cloud, {0, -1, 0}, 0.3f, {255, 0, 0, 255});
  const Camera camera = straight_camera(61);
  const double weight_half = 0.5;
  for (const char* threshold : {"0", "0.5", "1", "auto"}) {
    SCOPED_TRACE(threshold);
    set("weight_threshold", threshold);
    const RenderOutput out = render(cloud, camera);
    for (int y = 5; y < 56; ++y)
      for (int x = 5; x < 56; ++x) {
        const double rho = std::hypot(x - 30, y - 30) * (2.0 / 61) / 0.3;
        if (std::abs(rho - 1) < 0.02 || std::abs(wendland(std::min(rho, 1.0)) - weight_half) < 0.02) continue;
        const bool stray = rho < 1 && (threshold == std::string("0") ||
                                       (threshold == std::string("0.5") && wendland(rho) > 0.5));
        const vec4 c = out.color_linear.at(x, y);
        ASSERT_EQ(c.a, 1.0f);
        ASSERT_EQ(c.r > 0.5f, stray) << x << "," << y;
        ASSERT_EQ(c.g > 0.5f, !stray);
      }
  }
}

TEST_F(Denoise, ShuffledPointsGiveTheSameBits) {
  // At T = 0 it is splats that are drawn, whose float sums know the order in their last bits.
  for (const char* threshold : {"1e-9", "1", "auto"})
    for (const char* overlapping : {"false", "true"}) {
      SCOPED_TRACE(std::string(threshold) + " " + overlapping);
      set("weight_threshold", threshold);
      set("overlapping", overlapping);
      PreparedCloud prepared = analysis::prepare(noisy_sphere(4000, 0.04f, 400, 5), technique_->needs(), {});
      prepared.batches.resize(1);
      const Bounds box = bounds(prepared.cloud);
      prepared.batches[0] = {0, std::uint32_t(prepared.cloud.size()), vec3(box.min), vec3(box.max)};
      prepared.batches[0].set_even_spacing(prepared.median_spacing);
      std::vector<std::uint32_t> order(prepared.cloud.size());
      std::iota(order.begin(), order.end(), 0u);
      std::shuffle(order.begin(), order.end(), std::mt19937(7));
      PreparedCloud shuffled = prepared;
      shuffled.cloud = select(prepared.cloud, order);
      for (std::size_t i = 0; i < prepared.support.size(); ++i)
        shuffled.support[i] = prepared.support[order[i]];
      auto picture = [&](const PreparedCloud& cloud) {
        Renderer renderer(context());
        renderer.set_cloud(cloud, colors_of(cloud.cloud));
        return renderer.render(*technique_, front_camera(72, 48), settings_, all_outputs());
      };
      const RenderOutput a = picture(prepared), b = picture(shuffled);
      for (const std::string& note : a.notes) EXPECT_NE(note.find("outliers"), std::string::npos) << note;
      for (std::size_t i = 0; i < a.depth.size(); ++i) {
        ASSERT_EQ(a.color_linear.data()[i], b.color_linear.data()[i]);
        ASSERT_EQ(a.depth.data()[i], b.depth.data()[i]);
        ASSERT_EQ(a.normal.data()[i], b.normal.data()[i]);
      }
    }
}

TEST_F(Denoise, FloatAtomicsGiveTheSamePicture) {
  if (!context().limits().float_atomics) GTEST_SKIP() << "the driver has no float atomics";
  const PointCloud cloud = noisy_sphere(3000, 0.03f, 300, 6);
  const RenderOutput exact = render(cloud, front_camera(72, 48));
  settings_.fast = true;
  const RenderOutput as_fast_as_can_be = render(cloud, front_camera(72, 48));
  struct ByShaders {  // native loops have no atomics
    gl::Place before = std::exchange(gl::preferences().splats, gl::Place::gpu);
    ~ByShaders() { gl::preferences().splats = before; }
  };
  RenderOutput fast;
  {
    const ByShaders here;
    fast = render(cloud, front_camera(72, 48));
  }
  if (SplatCpu::is_used()) {  // and are faster: nothing changes
    for (std::size_t i = 0; i < exact.depth.size(); ++i)
      ASSERT_EQ(exact.color_linear.data()[i], as_fast_as_can_be.color_linear.data()[i]);
  }
  std::size_t different = 0;
  for (std::size_t i = 0; i < exact.depth.size(); ++i)
    // Weights in steps of 2^-16 (1.5e-5 a hit) and sums of 2^24: 1e-4 is several times that.
    different += !(glm::length(exact.color_linear.data()[i] - fast.color_linear.data()[i]) < 1e-4f);
  EXPECT_LE(different, 3u) << "sums within a rounding of the threshold";
}

/// The table itself, below the technique.
class Table : public GlTest {
 protected:
  denoise::BinOptions options_{.bin_size = 0.1f, .weight_threshold = 0.5f};
  Image<vec4> choose(const PointCloud& cloud, const Camera& asked) {
    prepared_ = analysis::prepare(cloud, Attribute::normal | Attribute::radius, {});
    return choose(asked);
  }
  Image<vec4> choose(const Camera& asked) {
    GpuCloud gpu(prepared_, colors_of(prepared_.cloud));
    Camera camera = asked;
    camera.fit_depth_range(gpu.bounds());
    const View view(camera, prepared_.cloud.origin);
    if (!worth_.empty()) gpu.set_field(gpu.make_values("worth", worth_));
    const SplatBatches batches = choose_batches(gpu, view, shape_);
    gl::Timers timers(false);
    surface_.draw_nearest(gpu, view, shape_, batches);
    target_ = Target(camera.width, camera.height);
    table_.draw({gpu, view, shape_, batches, surface_.nearest_t(), options_, timers}, false,
                {target_.color, target_.depth, target_.normal});
    return table_.choice().download<vec4>();
  }
  /// Weights of a pixel by bin.
  std::map<std::uint32_t, double> bins(int x, int y, int width) {
    const std::size_t slots = std::size_t(table_.slots()),
                      base = (std::size_t(y) * std::size_t(width) + std::size_t(x)) * slots;
    std::vector<std::uint32_t> weights(slots), keys(slots);
    table_.weights().buffer().download(weights.data(), 4 * slots, 4 * base);
    table_.keys().buffer().download(keys.data(), 4 * slots, 4 * base);
    std::map<std::uint32_t, double> found;
    for (std::size_t s = 0; s < slots; ++s)
      if (keys[s]) {
        EXPECT_EQ(found.count(keys[s] - 1), 0u) << "a bin has one slot";
        found[keys[s] - 1] = weights[s] / 65536.0;
      }
    return found;
  }
  /// `check` by name for a noisy sphere under all options that loops and shaders distinguish.
  template <class Check>
  void for_each_kind(const Check& check) {
    prepared_ =
        analysis::prepare(noisy_sphere(3000, 0.05f, 1500, 4), Attribute::normal | Attribute::radius, {});
    check("hashed");
    options_.overlapping = true;
    check("overlapping");
    options_.anchor = denoise::Anchor::grid;
    check("on a grid");
    options_.layout = denoise::Layout::dense;
    options_.dense_bins = 16;
    check("dense");
    options_.overlapping = false;
    for (std::size_t i = 0; i < prepared_.cloud.size(); ++i) worth_.push_back(0.1f + 0.9f * float(i % 7) / 6);
    options_.covers = 10, options_.surface_share = 0.2f;
    shape_.part = SplatPart::above, shape_.field_threshold = 0.3f, shape_.prefilter_px = 1;
    check("of worth");
  }
  PreparedCloud prepared_;
  SplatShape shape_;
  std::vector<float> worth_;  ///< of the points, as a field
  SplatSurface surface_;
  denoise::BinTable table_;
  Target target_;
};

/// By shaders, and by the loops that fill it where OpenGL is software.
class TableBy : public Table, public ::testing::WithParamInterface<gl::Place> {
  const WithPreference<gl::Place> with_{&gl::Preferences::splats, GetParam()};
};
INSTANTIATE_TEST_SUITE_P(, TableBy, ::testing::Values(gl::Place::gpu, gl::Place::cpu),
                         [](const auto& of) { return of.param == gl::Place::gpu ? "gpu" : "cpu"; });

// The loops that fill it where OpenGL is software, against the shaders. No bin counts, so that none is left
// out.
TEST_F(Table, IsThatOfShaders) {
  constexpr int width = 64, height = 48;
  options_.weight_threshold = 1000;
  const auto expect_alike = [&](const char* which) {
    std::vector<double> weights[2];
    for (const gl::Place place : {gl::Place::gpu, gl::Place::cpu}) {
      const WithPreference<gl::Place> with(&gl::Preferences::splats, place);
      choose(front_camera(width, height));
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          std::vector<double> of_pixel(400, 0.0);
          if (options_.layout == denoise::Layout::dense) {
            std::vector<std::uint32_t> slots(std::size_t(table_.slots()));
            table_.weights().buffer().download(slots.data(), 4 * slots.size(),
                                               4 * slots.size() * std::size_t(y * width + x));
            std::transform(slots.begin(), slots.end(), of_pixel.begin(), [](auto w) { return w / 65536.0; });
          } else {
            for (const auto& [b, weight] : bins(x, y, width)) of_pixel.at(b) = weight;
          }
          auto& all = weights[place == gl::Place::cpu];
          all.insert(all.end(), of_pixel.begin(), of_pixel.end());
        }
    }
    // Each of some ten hits is rounded to 2^-16; one that lies on a border falls to either side.
    std::size_t filled = 0, differ = 0;
    for (std::size_t i = 0; i < weights[0].size(); ++i)
      filled += weights[0][i] > 0, differ += std::abs(weights[0][i] - weights[1][i]) > 1e-3;
    EXPECT_GT(filled, 2000u) << which;
    EXPECT_LE(differ, filled / 500) << which;
  };
  for_each_kind(expect_alike);
}

// What is in the chosen bins likewise. A hit on a border falls to either side, and with a few others in its
// pixel it moves their mean: one pixel in a hundred may differ by more than roundings.
TEST_F(Table, SumsAreThoseOfShaders) {
  const auto expect_alike = [&](const char* which) {
    std::vector<vec4> seen[2];
    for (const gl::Place place : {gl::Place::gpu, gl::Place::cpu}) {
      const WithPreference<gl::Place> with(&gl::Preferences::splats, place);
      const Image<vec4> chosen = choose(front_camera(64, 48)), albedo = target_.color.download<vec4>(),
                        normal = target_.normal.download<vec4>();
      const Image<float> depth = target_.depth.download<float>();
      std::size_t holes = 0;
      for (std::size_t i = 0; i < chosen.size(); ++i) {
        const bool is_there = albedo.data()[i].a > 0;
        holes += is_there != (chosen.data()[i].x >= 0);
        seen[place == gl::Place::cpu].push_back(albedo.data()[i]);
        seen[place == gl::Place::cpu].push_back(vec4(vec3(normal.data()[i]), is_there ? depth.data()[i] : 0));
      }
      EXPECT_EQ(holes, 0u) << which;
    }
    std::size_t differ = 0, shown = 0;
    for (std::size_t i = 0; i < seen[0].size(); ++i) {
      shown += seen[0][i] != vec4(0);
      differ += !(glm::length(seen[0][i] - seen[1][i]) <= 1e-4f);
    }
    EXPECT_GT(shown, 1500u) << which;
    EXPECT_LE(differ, shown / 100) << which;
  };
  for_each_kind(expect_alike);
  prepared_.cloud.normals.assign(prepared_.cloud.size(), vec3(0));
  expect_alike("without normals");
}

// A table that is full grows: the order of the points matters nowhere.
TEST_P(TableBy, GrowsUntilTheOrderDoesNotMatter) {
  options_.hash_bits = 2;
  options_.weight_threshold = 2;
  const Camera camera = front_camera(64, 48);
  const Image<vec4> before = choose(noisy_sphere(3000, 0.05f, 1500, 4), camera);
  EXPECT_EQ(table_.counts().overflow, 0u);
  EXPECT_GT(table_.slots(), 4);
  std::size_t most = 0;
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) most = std::max(most, bins(x, y, 64).size());
  EXPECT_GT(most, 4u) << "the cloud fills more than the table had";

  prepared_.batches.resize(1);
  const Bounds box = bounds(prepared_.cloud);
  prepared_.batches[0] = {0, std::uint32_t(prepared_.cloud.size()), vec3(box.min), vec3(box.max)};
  prepared_.batches[0].set_even_spacing(prepared_.median_spacing);
  std::vector<std::uint32_t> order(prepared_.cloud.size());
  std::iota(order.begin(), order.end(), 0u);
  std::shuffle(order.begin(), order.end(), std::mt19937(7));
  prepared_.cloud = select(prepared_.cloud, order);
  const Image<vec4> after = choose(camera);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) ASSERT_EQ(before.at(x, y), after.at(x, y)) << x << "," << y;
}

// What a small picture needed may be more than there is room for in a large one, which then has what fits.
TEST_F(Table, GrownInASmallPictureServesALargeOne) {
  options_.hash_bits = 2;
  options_.weight_threshold = 30;  // no bin counts, so that all of them stay
  PointCloud cloud;
  for (int k = 0; k < 120; ++k) add_disc(cloud, {0, 0.2f * float(k), 0}, 0.05f, {200, 100, 50, 255});
  add_disc(cloud, {100, 0, 0}, 0.05f, {200, 100, 50, 255});
  Camera camera = straight_camera(31);
  choose(cloud, camera);
  ASSERT_EQ(table_.slots(), 128);
  const std::int64_t room = gl::limits().max_texture_buffer_size;
  if (room > std::int64_t(1) << 28) GTEST_SKIP() << "this driver's largest table takes gigabytes";
  camera.width = 1024;
  camera.height = int(room / 1024 / 128) + 1;
  camera.position.x = camera.target.x = 100;
  options_.weight_threshold = 0.5f;
  const Image<vec4> choice = choose(camera);
  EXPECT_EQ(table_.slots(), 64);
  EXPECT_EQ(choice.at(camera.width / 2, camera.height / 2).x, 0) << "the first bin";
}

// What lies beyond the dense bins goes to the last one only, though bins overlap: the one before it ends
// where it ends.
TEST_P(TableBy, TheLastDenseBinAloneTakesTheRest) {
  options_.layout = denoise::Layout::dense;
  options_.dense_bins = 4;
  options_.overlapping = true;
  options_.weight_threshold = 1000;
  PointCloud cloud;
  add_disc(cloud, {0, 0, 0}, 0.3f, {200, 100, 50, 255});
  for (float behind : {0.5f, 0.7f, 0.9f}) add_disc(cloud, {0, behind, 0}, 0.3f, {200, 100, 50, 255});
  const Camera camera = straight_camera(21);
  choose(cloud, camera);
  std::uint32_t weights[4];
  table_.weights().buffer().download(weights, sizeof weights, 4 * 4 * (21 * 10 + 10));
  EXPECT_NEAR(weights[0] / 65536.0, 1, 1e-4);
  EXPECT_EQ(weights[1], 0u);
  EXPECT_EQ(weights[2], 0u) << "bin 2 is [0.1, 0.2)";
  EXPECT_NEAR(weights[3] / 65536.0, 3, 1e-4);
}

// The bin tracked while adding is the nearest one of the finished table.
TEST_P(TableBy, TrackedBinIsTheNearestAboveTheThreshold) {
  const PointCloud cloud = noisy_sphere(2000, 0.05f, 800, 8);
  for (float threshold : {0.0f, 0.2f, 0.5f}) {
    options_.weight_threshold = threshold;
    const Image<vec4> choice = choose(cloud, front_camera(40, 30));
    int holes = 0;
    for (int y = 0; y < 30; ++y)
      for (int x = 0; x < 40; ++x) {
        double expected = -1;
        for (const auto& [b, weight] : bins(x, y, 40))
          if (weight > threshold) {
            expected = b;
            break;
          }
        ASSERT_EQ(choice.at(x, y).x, expected) << x << "," << y;
        holes += expected < 0;
      }
    EXPECT_LT(holes, 40 * 30 - 100) << "the sphere covers 260 pixels";
  }
  EXPECT_EQ(table_.counts().overflow, 0u);
}

TEST_P(TableBy, CoincidentSplatsAddUp) {
  const Camera camera = straight_camera(21);
  for (int n : {1, 2, 7, 200}) {
    PointCloud cloud;
    for (int i = 0; i < n; ++i) add_disc(cloud, {0, 0, 0}, 0.3f, {200, 100, 50, 255});
    options_.weight_threshold = 0;
    // rho = 0 at the middle pixel up to 2e-7, where the weight is flat: w = 1 - 10 rho^2.
    EXPECT_FLOAT_EQ(choose(cloud, camera).at(10, 10).y, float(n));
    options_.weight_threshold = float(n);
    EXPECT_EQ(choose(cloud, camera).at(10, 10).x, -1) << "the threshold is strict";
  }
}

TEST_F(Denoise, SeparatePlanesNeverMix) {
  PointCloud cloud = plane_cloud(0, {255, 0, 0, 255}, 30, 8, 0.01f, 1);
  append(cloud, plane_cloud(0.25f, {0, 0, 255, 255}, 30, 8, 0.01f, 2));
  const Camera camera = straight_camera(64);
  for (const char* bins : {"hashed", "dense"})
    for (const char* overlapping : {"false", "true"})
      for (const char* threshold : {"0", "0.5", "1.5", "auto"}) {
        set("bins", bins);
        set("overlapping", overlapping);
        set("weight_threshold", threshold);
        const RenderOutput out = render(cloud, camera);
        for (const vec4& c : out.color_linear) ASSERT_TRUE(c.r == 0 || c.b == 0) << c.r << " " << c.b;
        int front = 0;
        for (int y = 4; y < 60; ++y)
          for (int x = 4; x < 60; ++x) front += out.color_linear.at(x, y).r > 0;
        // Jittered points weigh 8/7 on average, in one place of twenty less than half of it, and mostly less
        // than 1.5. `auto` takes what is weak within three bins of something heavier for its noise, as these
        // planes may be.
        const std::map<std::string, double> least{{"0", 1}, {"0.5", 0.9}, {"1.5", 0}, {"auto", 0.97}};
        EXPECT_GE(front, least.at(threshold) * 56 * 56) << bins << " " << overlapping << " " << threshold;
      }
  // Further apart the front one is shown everywhere.
  PointCloud apart = plane_cloud(0, {255, 0, 0, 255}, 30, 8, 0.01f, 1);
  append(apart, plane_cloud(0.6f, {0, 0, 255, 255}, 30, 8, 0.01f, 2));
  set("weight_threshold", "auto");
  set("overlapping", "false");
  const RenderOutput out = render(apart, camera);
  for (int y = 4; y < 60; ++y)
    for (int x = 4; x < 60; ++x) {
      ASSERT_GT(out.color_linear.at(x, y).r, 0) << x << "," << y;
      ASSERT_EQ(out.color_linear.at(x, y).b, 0) << x << "," << y;
    }
}

TEST_F(Denoise, MissShowsBackgroundOrTheLastBin) {
  PointCloud cloud = plane_cloud(0, {255, 0, 0, 255}, 20, 4);
  append(cloud, plane_cloud(0.5f, {0, 0, 255, 255}, 20, 4));
  set("weight_threshold", "1000");
  for (const char* bins : {"hashed", "dense"}) {
    set("bins", bins);
    set("miss", "background");
    EXPECT_EQ(render(cloud, straight_camera(32)).color_linear.at(16, 16), vec4(0));
    set("miss", "last_bin");
    const vec4 c = render(cloud, straight_camera(32)).color_linear.at(16, 16);
    EXPECT_EQ(c.r, 0);
    EXPECT_EQ(c.b, 1);
  }
}

// First slots and numbers of distinct slots from the definition slot = (b 2654435769 mod 2^32) >> (32 - B).
TEST(DenoiseHash, HasTheKnownSequences) {
  auto first = [](int bits, std::uint32_t count) {
    std::vector<std::uint32_t> slots;
    for (std::uint32_t b = 0; b < count; ++b) slots.push_back(denoise::fibonacci_slot(b, bits));
    return slots;
  };
  EXPECT_EQ(first(3, 8), (std::vector<std::uint32_t>{0, 4, 1, 6, 3, 0, 5, 2}));
  EXPECT_EQ(first(4, 16), (std::vector<std::uint32_t>{0, 9, 3, 13, 7, 1, 11, 5, 15, 8, 2, 12, 6, 0, 10, 4}));
  const std::size_t distinct[] = {2, 3, 7, 15, 28, 55, 113, 221};
  for (int bits = 1; bits <= 8; ++bits) {
    std::vector<std::uint32_t> slots = first(bits, 1u << bits);
    std::sort(slots.begin(), slots.end());
    EXPECT_EQ(std::size_t(std::unique(slots.begin(), slots.end()) - slots.begin()), distinct[bits - 1]);
  }
  // The product wraps at 2^32 as in 64-bit arithmetic.
  for (std::uint32_t b : {2u, 123456789u, 0xfffffffeu})
    EXPECT_EQ(denoise::fibonacci_slot(b, 5),
              std::uint32_t(((std::uint64_t(b) * 2654435769u) & 0xffffffffu) >> 27));
}

// Depth error over the pixels of a noisy plane with 5 % outliers in front of it; holes are counted apart.
TEST_F(Denoise, DepthErrorFallsAsTheThresholdRises) {
  PointCloud cloud = plane_cloud(0, {180, 180, 180, 255}, 60, 10, 0.01f, 3);
  std::mt19937 random(11);
  std::uniform_real_distribution<float> uniform(-1, 1);
  for (int i = 0; i < 180; ++i)
    add_disc(cloud, {uniform(random), -0.75f + 0.5f * uniform(random), uniform(random)}, cloud.radii[0],
             {90, 90, 90, 255});
  const Camera camera = straight_camera(80);
  auto error = [&](const RenderOutput& out, double* holes = nullptr) {
    double sum = 0;
    int count = 0, missed = 0;
    for (int y = 8; y < 72; ++y)
      for (int x = 8; x < 72; ++x) {
        if (std::isinf(out.depth.at(x, y))) {
          ++missed;
          continue;
        }
        sum += std::abs(out.depth.at(x, y) - 4);
        ++count;
      }
    if (holes) *holes = missed / (64.0 * 64);
    return sum / count;
  };
  auto splats = find_technique("splats").create();
  set_parameter(*splats, "radius_scale", "1");
  set_parameter(*splats, "epsilon", "0.04");
  set_parameter(*splats, "antialias", "false");
  set_parameter(*splats, "clamp_radius", "false");
  const double ewa = error(render(*splats, cloud, camera));
  set("bin_size", "0.04");
  double before = ewa, holes = 0;
  for (const char* threshold : {"0.05", "0.2", "0.5", "0.9"}) {
    set("weight_threshold", threshold);
    const double now = error(render(cloud, camera), &holes);
    EXPECT_LT(now, before) << threshold;
    before = now;
  }
  EXPECT_LT(before, 0.1 * ewa);
  EXPECT_LT(holes, 0.25);
  set("weight_threshold", "4");
  error(render(cloud, camera), &holes);
  EXPECT_GT(holes, 0.9) << "holes appear in the end";
  set("weight_threshold", "auto");
  EXPECT_LT(error(render(cloud, camera), &holes), 0.5 * ewa);
  EXPECT_LT(holes, 0.02);
}

// Outliers all around, nothing chosen by hand.
TEST_F(Denoise, DefaultsRemoveOutliersAndKeepTheSurface) {
  technique_ = find_technique("denoise").create();
  PointCloud cloud = sphere_cloud(30000, 1);
  std::mt19937 random(13);
  std::uniform_real_distribution<float> uniform(-1.6f, 1.6f);
  for (int i = 0; i < 2500; ++i) {
    cloud.positions.push_back({uniform(random), uniform(random), uniform(random)});
    cloud.normals.push_back(vec3(0));
    cloud.colors.push_back({90, 90, 90, 255});
  }
  const Camera camera = front_camera(128, 96, 5);
  const RenderOutput out = render(cloud, camera);
  int kept = 0, surface = 0, stray = 0, around = 0;
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 128; ++x) {
      const OracleRay ray = oracle_ray(camera, x + 0.5, y + 0.5);
      const double along = -glm::dot(ray.origin, ray.direction);
      const double closest2 = glm::dot(ray.origin, ray.origin) - along * along;
      if (closest2 < 0.98 * 0.98) {
        ++surface;
        const double t = along - std::sqrt(1 - closest2);
        kept += std::abs(out.depth.at(x, y) - t * ray.cosine) < 0.05;
      } else if (closest2 > 1.05 * 1.05) {  // three spacings of 0.02 beyond the rim
        ++around;
        stray += !std::isinf(out.depth.at(x, y));
      }
    }
  EXPECT_GT(kept, 0.99 * surface);
  EXPECT_LT(stray, 0.002 * around);
  EXPECT_NEAR(double(out.outliers), 2500, 250) << "some lie on the sphere";
  EXPECT_TRUE(std::any_of(out.notes.begin(), out.notes.end(), [&](const std::string& note) {
    return note.find(std::to_string(out.outliers) + " of 32500 points") != std::string::npos;
  }));
  set("prefilter", "false");
  EXPECT_EQ(render(cloud, camera).outliers, 0u);
}

/// Two walls facing the camera, the right one with a sixteenth of the density of the left, and outliers all
/// around.
PointCloud walls_of_two_densities() {
  PointCloud cloud = plane_cloud(0, {0, 200, 0, 255}, 80, 10);
  const PointCloud sparse = plane_cloud(0.5f, {0, 0, 200, 255}, 20, 10, 0, 2);
  for (std::size_t i = 0; i < sparse.size(); ++i)
    add_disc(cloud, sparse.positions[i] + vec3(3, 0, 0), sparse.radii[i], sparse.colors[i]);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(-1, 1);
  for (int i = 0; i < 400; ++i)
    add_disc(cloud, {1.5f + 2.5f * uniform(random), 2 * uniform(random), uniform(random)}, 0.1f,
             {200, 0, 0, 255});
  cloud.radii.clear();
  return cloud;
}

// A sparse surface is no crowd of outliers: what counts is how full the space is, not how dense the cloud.
TEST(DenoiseSupport, IsLocal) {
  const PreparedCloud prepared = analysis::prepare(walls_of_two_densities(), Attribute::support, {});
  const std::vector<float>& support = prepared.support;
  std::map<char, std::pair<int, int>> kept;  // by colour: supported, all
  for (std::size_t i = 0; i < support.size(); ++i) {
    const Rgba8 c = prepared.cloud.colors[i];
    auto& [supported, all] = kept[c.r ? 'r' : c.g ? 'g' : 'b'];
    supported += support[i] > 0.5f;
    ++all;
  }
  ASSERT_EQ(kept['b'].second, 400);
  // Corners have neighbours on two sides only.
  EXPECT_GT(kept['g'].first, 0.999 * kept['g'].second);
  EXPECT_GT(kept['b'].first, 0.98 * kept['b'].second);
  // Of the volume, 5 % lies within 0.1 of a wall, where an outlier is hard to tell from its points.
  EXPECT_LT(kept['r'].first, 0.08 * kept['r'].second);
}

// Whatever made a disc smaller than its part of the surface, its splats are worth what is missing of it.
TEST(DenoiseSupport, WorthIsTheAreaThatIsNotDrawn) {
  PreparedCloud prepared;
  prepared.cloud.positions.resize(6);
  prepared.cloud.radii = {1, 4, 0.5f, 0.5f, 2, 0.001f};
  prepared.shrunk = {1, 1, 0.5f, 0.1f, 0.5f, 0.001f};
  const std::vector<float> support{1, 1, 1, 0.5f, 0.05f, 1};
  const std::vector<float> worth = denoise::splat_worth(prepared, support, 0.1f, 2);
  // Whole; cut to half; shrunk to half; to a tenth, half supported; not supported; shrunk to nothing.
  const std::vector<float> expected{1, 4, 4, 50, 0.05f, 100};
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(worth[i], expected[i], 1e-4f * expected[i]) << i;
  prepared.shrunk.clear();  // the file's own radii
  EXPECT_FLOAT_EQ(denoise::splat_worth(prepared, support, 0.1f, 2)[3], 0.5f);
}

TEST_F(Denoise, DefaultsKeepSparseSurfaces) {
  technique_ = find_technique("denoise").create();
  set_parameter(*technique_, "clamp_radius",
                "false");  // the discs of the sparse wall are four times the median
  Camera camera = straight_camera(60);
  camera.position = {3, -6, 0};
  camera.target = {3, 0, 0};
  const RenderOutput out = render(walls_of_two_densities(), camera);
  int blue = 0;
  for (int y = 6; y < 54; ++y)
    for (int x = 6; x < 54; ++x) blue += out.color_linear.at(x, y).b > 0.3f;
  // Outliers that touch the wall tint it.
  EXPECT_GT(blue, 0.95 * 48 * 48);
}

// Discs of a part forty times as sparse as the median are as large there as in splats, and leave no holes.
TEST_F(Denoise, DefaultsKeepPartsFarSparserThanTheMedian) {
  technique_ = find_technique("denoise").create();
  PointCloud cloud;
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(0, 1);
  const auto add_square = [&](vec3 corner, float side, int points, Rgba8 color) {
    const float step = side / float(points);
    for (int i = 0; i < points * points; ++i) {
      const float x = float(i % points) + uniform(random), z = float(i / points) + uniform(random);
      cloud.positions.push_back(corner + step * vec3(x, 0, z));
      cloud.normals.push_back({0, -1, 0});
      cloud.colors.push_back(color);
    }
  };
  add_square({-2, 0, -2}, 4, 180, {0, 0, 200, 255});
  add_square({-1.9f, -2, -1.9f}, 0.1f, 200, {0, 200, 0, 255});
  Camera camera = straight_camera(60);
  camera.position = {0.5f, -0.6f, 0};
  camera.target = {0.5f, 0, 0};
  camera.height_world = 0.4;  // three pixels a spacing
  const RenderOutput out = render(cloud, camera);
  int blue = 0;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 60; ++x) blue += out.color_linear.at(x, y).b > 0.3f;
  EXPECT_EQ(blue, 60 * 60);
}

TEST_F(Denoise, ShadingWeightGrowsWithTheWeight) {
  PointCloud cloud = plane_cloud(0, {255, 0, 0, 255}, 30, 4);
  settings_.shading = Shading::weight;
  set("weight_threshold", "0");
  const vec4 few = render(cloud, straight_camera(33)).color_linear.at(16, 16);
  for (float& radius : cloud.radii) radius *= 2;
  const vec4 many = render(cloud, straight_camera(33)).color_linear.at(16, 16);
  EXPECT_EQ(few.r, few.b);
  EXPECT_GT(many.g, few.g);
}

}  // namespace
