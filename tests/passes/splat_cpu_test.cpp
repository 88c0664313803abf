// Surface splatting by the processor against that by shaders: the same surface in every case they
// distinguish.
#include <random>

#include "passes/splat_surface.h"
#include "reference/strays.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

struct Surface {
  Image<vec4> albedo, normal;
  Image<float> depth, nearest;
};

class SplatCpuTest : public GlTest {
 protected:
  /// Discs of all sizes and directions, some on thin sheets, some dots, some without a normal.
  SplatCpuTest() {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> uniform(-1, 1);
    PointCloud cloud = sphere_among_strays(random);
    cloud.radii.assign(4000, 0.03f);
    while (cloud.radii.size() < cloud.size()) cloud.radii.push_back(0.02f + 0.1f * std::abs(uniform(random)));
    prepared_ = analysis::prepare(std::move(cloud), Attribute::normal, {});
    for (std::size_t i = 0; i < prepared_.cloud.size(); i += 50) prepared_.cloud.normals[i] = vec3(0);
    for (std::size_t i = 0; i < prepared_.cloud.size(); ++i) {
      prepared_.on_surface.push_back(std::clamp(1.5f * uniform(random), -1.0f, 1.0f));
      values_.push_back(0.5f + 0.5f * uniform(random));
    }
    prepared_.radius_limit = 0.1f;
    gpu_ = std::make_unique<GpuCloud>(prepared_, colors_of(prepared_.cloud), 2500);  // in several chunks
    shape_.dots = true, shape_.prefilter_px = 1, shape_.radius_limit = 0.1f, shape_.widest_px = 12;
    shape_.radius_scale = 1.5f;
    blend_.epsilon = 0.03f, blend_.epsilon_radii = 0.8f;
  }
  Surface draw(gl::Place place) {
    const WithPreference<gl::Place> with(&gl::Preferences::splats, place);
    Camera camera = camera_;
    camera.fit_depth_range(gpu_->bounds());
    const View view(camera, prepared_.cloud.origin);
    SplatSurface surface;
    gl::Texture albedo, depth, normal;
    gl::Timers timers(false);
    surface.draw(*gpu_, view, shape_, blend_, {albedo, depth, normal}, timers);
    return {albedo.download<vec4>(), normal.download<vec4>(), depth.download<float>(),
            surface.nearest_t().download<float>()};
  }
  /// Two programs may round t differently, which flips a pixel where t meets the nearest + epsilon or a rim:
  /// at most one in a thousand; elsewhere sums differ by roundings.
  void expect_alike(const char* which) {
    SCOPED_TRACE(which);
    const Surface a = draw(gl::Place::gpu), b = draw(gl::Place::cpu);
    std::size_t covered = 0, flips = 0;
    for (std::size_t i = 0; i < a.depth.size(); ++i) {
      const float of_a = a.depth.data()[i], of_b = b.depth.data()[i];
      covered += std::isfinite(of_a);
      const bool same_depth = of_a == of_b || std::abs(of_a - of_b) < 1e-5f * of_a;
      const vec4 color = glm::abs(a.albedo.data()[i] - b.albedo.data()[i]),
                 normal = glm::abs(a.normal.data()[i] - b.normal.data()[i]);
      const float nearest_a = a.nearest.data()[i], nearest_b = b.nearest.data()[i];
      const bool same_nearest = nearest_a == nearest_b || std::abs(nearest_a - nearest_b) < 1e-5f * nearest_a;
      flips += !same_depth || !same_nearest || glm::any(glm::greaterThan(color, vec4(1e-4f))) ||
               glm::any(glm::greaterThan(normal, vec4(1e-3f)));
    }
    EXPECT_GT(covered, a.depth.size() / 5);
    EXPECT_LE(flips, a.depth.size() / 1000);
  }

  PreparedCloud prepared_;
  std::vector<float> values_;
  std::unique_ptr<GpuCloud> gpu_;
  Camera camera_ = camera_at({0.4, -2.5, 0.5}, 301, 187);
  SplatShape shape_;
  SplatBlend blend_;
};

}  // namespace

TEST_F(SplatCpuTest, DrawsWhatShadersDraw) {
  expect_alike("as by default");
  blend_.epsilon_radii = 0;
  expect_alike("one epsilon");
  blend_.kernel = SplatKernel::gaussian;
  expect_alike("the other kernel");
  blend_.opaque = true;
  expect_alike("the nearest alone");
  shape_ = {};
  expect_alike("discs as they are");
}

TEST_F(SplatCpuTest, FromEveryCamera) {
  camera_ = camera_at({0.05, -0.3, 0}, 301, 187, 110);
  expect_alike("among the points");
  camera_ = camera_at({0.4, -2.5, 0.5}, 301, 187);
  camera_.projection = Projection::orthographic;
  camera_.height_world = 2;
  expect_alike("orthographic");
  camera_ = camera_at({0.4, -2.5, 0.5}, 640, 480).tile(250, 130, 200, 160);
  expect_alike("a tile");
  gpu_->set_shadow(values_);
  camera_ = camera_at({0.4, -2.5, 0.5}, 60, 701, 70);
  expect_alike("of three stripes");
}

TEST_F(SplatCpuTest, WithPartsCutsAndShadows) {
  gpu_->set_shadow(values_);
  expect_alike("shadows");
  GpuCloud::Cut cut;
  cut.planes = {vec4(1, 0, 0, -0.5f)};
  cut.up = vec3(0, 0, 1), cut.u = vec4(1, 0, 0, 1), cut.v = vec4(0, 1, 0, 1);
  cut.across = 2, cut.heights = {0.3f, std::numeric_limits<float>::infinity(), 0.1f, 0.4f};
  gpu_->set_cut(cut);
  expect_alike("cut");
  gpu_->set_field(gpu_->make_values("a test's", values_));
  shape_.field_threshold = 0.4f;
  for (const SplatPart part : {SplatPart::above, SplatPart::not_above}) {
    shape_.part = part;
    expect_alike("a part");
  }
}

// Most of them behind a wall with a window: what is hidden when it is visited is left out.
TEST_F(SplatCpuTest, BehindWhatHidesThem) {
  PointCloud cloud = sphere_cloud(30'000, 0.8f);
  for (int z = -60; z <= 60; ++z)
    for (int x = -60; x <= 60; ++x)
      if (std::max(std::abs(x), std::abs(z - 10)) > 8) {
        cloud.positions.push_back({0.02f * float(x), -1, 0.02f * float(z)});
        cloud.normals.push_back({0, -1, 0});
        cloud.colors.push_back({std::uint8_t(2 * x + 128), 90, std::uint8_t(2 * z + 128), 255});
      }
  cloud.radii.assign(cloud.size(), 0.02f);
  prepared_ = analysis::prepare(std::move(cloud), {}, {});
  prepared_.radius_limit = 0.1f;
  gpu_ = std::make_unique<GpuCloud>(prepared_, colors_of(prepared_.cloud));
  camera_ = camera_at({0.2, -3, 0.1}, 301, 187);
  expect_alike("a wall");
  camera_.projection = Projection::orthographic;
  camera_.height_world = 2;
  expect_alike("orthographic");
}

// Splats of two parts of a cloud, each added up behind the nearest hits of both.
TEST_F(SplatCpuTest, AddsUpBehindTheNearestOfAllParts) {
  const WithPreference<gl::Place> with(&gl::Preferences::splats, gl::Place::cpu);
  const Surface whole = draw(gl::Place::cpu);
  camera_.fit_depth_range(gpu_->bounds());
  const View view(camera_, prepared_.cloud.origin);
  gpu_->set_field(gpu_->make_values("a test's", values_));
  shape_.field_threshold = 0.5f;
  gl::Timers timers(false);
  Image<float> nearest(view.width(), view.height(), std::numeric_limits<float>::infinity());
  for (const SplatPart part : {SplatPart::above, SplatPart::not_above}) {
    shape_.part = part;
    SplatSurface surface;
    surface.find_nearest(*gpu_, view, shape_, blend_, timers);
    const Image<float> own = surface.nearest_t().download<float>();
    for (std::size_t i = 0; i < own.size(); ++i)
      nearest.data()[i] = std::min(nearest.data()[i], own.data()[i]);
  }
  Image<vec4> color(view.width(), view.height());
  for (const SplatPart part : {SplatPart::above, SplatPart::not_above}) {
    shape_.part = part;
    SplatSurface surface;  // that has not seen the first round
    surface.accumulate(*gpu_, view, shape_, blend_, nearest, timers);
    const Image<vec4> own = surface.color_sum().download<vec4>();
    for (std::size_t i = 0; i < own.size(); ++i) color.data()[i] += own.data()[i];
  }
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    ASSERT_EQ(nearest.data()[i], whole.nearest.data()[i]) << i;
    const vec4 mean = color.data()[i].a > 0 ? color.data()[i] / color.data()[i].a : vec4(0);
    ASSERT_LT(glm::length(mean - whole.albedo.data()[i]), 1e-5f) << i;  // sums in another order
  }
}
