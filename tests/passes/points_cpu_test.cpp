// Points to pixels by the processor against that by shaders: the same nearest points in every case they
// distinguish.
#include <bit>
#include <cmath>
#include <random>

#include "passes/points_to_pixels.h"
#include "reference/strays.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

class PointsCpuTest : public GlTest {
 protected:
  /// A sphere in an even cloud of strays, some points twice, some without a normal.
  PointsCpuTest() {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> uniform(-1, 1);
    PointCloud cloud = sphere_among_strays(random);
    for (std::size_t k = 0; k < 3000; k += 10) cloud.positions[4000 + k] = cloud.positions[k];
    prepared_ = analysis::prepare(std::move(cloud), Attribute::normal, {});
    for (std::size_t i = 0; i < prepared_.cloud.size(); i += 50) prepared_.cloud.normals[i] = vec3(0);
    for (std::size_t i = 0; i < prepared_.cloud.size(); ++i) {
      dots_.push_back({0.5f + std::abs(uniform(random)), 0.5f + 0.5f * uniform(random)});
      opacity_.push_back(0.5f + 0.5f * uniform(random));
    }
    gpu_ = std::make_unique<GpuCloud>(prepared_, colors_of(prepared_.cloud), 2500);  // in several chunks
  }
  View view() {
    Camera camera = camera_;
    camera.fit_depth_range(gpu_->bounds());
    return {camera, prepared_.cloud.origin};
  }
  /// How many pixels show another point, or the same farther away than a few roundings.
  std::size_t differing(const gl::Texture* reference = nullptr, const CasterRange* casters = nullptr) {
    Image<std::uint32_t> bits[2], index[2];
    for (int k = 0; k < 2; ++k) {
      const WithPreference<gl::Place> with(&gl::Preferences::points,
                                           k == 0 ? gl::Place::gpu : gl::Place::cpu);
      PointsToPixels to_pixels;
      PixelLayer layer;
      gl::Timers timers(false);
      to_pixels.draw(*gpu_, view(), footprint_, layer, timers, reference, 0.01f, casters);
      bits[k] = layer.depth_bits.download<std::uint32_t>(), index[k] = layer.index.download<std::uint32_t>();
    }
    std::size_t covered = 0, differ = 0;
    for (std::size_t i = 0; i < bits[0].size(); ++i) {
      covered += bits[0].data()[i] != 0xffffffffu;
      const float a = std::bit_cast<float>(bits[0].data()[i]), b = std::bit_cast<float>(bits[1].data()[i]);
      const bool alike = bits[0].data()[i] == bits[1].data()[i] || std::abs(a - b) <= 1e-6f * a;
      differ += !alike || index[0].data()[i] != index[1].data()[i];
    }
    EXPECT_GT(covered, bits[0].size() / 100);
    return differ;
  }
  /// Resolves the same points by shaders and by the processor.
  void expect_same_attributes(bool with_normals) {
    footprint_ = {SizeMode::world, 0.05f};
    PixelLayer layers[2];
    for (int k = 0; k < 2; ++k) {
      const WithPreference<gl::Place> with(&gl::Preferences::points,
                                           k == 0 ? gl::Place::gpu : gl::Place::cpu);
      PointsToPixels to_pixels;
      gl::Timers timers(false);
      to_pixels.draw(*gpu_, view(), footprint_, layers[k], timers);
      to_pixels.resolve(*gpu_, view(), layers[k], timers, with_normals);
    }
    const auto farthest = [](const Image<vec4>& a, const Image<vec4>& b) {
      float away = 0;
      for (std::size_t i = 0; i < a.size(); ++i)
        away = std::max(away, glm::length(a.data()[i] - b.data()[i]));
      return away;
    };
    // A driver's power of 2.4 is good to some 1e-4, normals are unit vectors of floats.
    EXPECT_LT(farthest(layers[0].albedo.download<vec4>(), layers[1].albedo.download<vec4>()), 5e-4f);
    const Image<float> a = layers[0].depth.download<float>(), b = layers[1].depth.download<float>();
    for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(a.data()[i], b.data()[i]) << i;
    if (!with_normals) return;
    const Image<vec4> normals = layers[1].normal.download<vec4>();
    EXPECT_LT(farthest(layers[0].normal.download<vec4>(), normals), 1e-5f);
    std::size_t known = 0;
    for (const vec4& n : normals) known += glm::length(vec3(n)) > 0.5f;
    EXPECT_GT(known, normals.size() / 100);
  }
  /// Drivers take powers of two, mixes and planes with other roundings: a rim flips now and then.
  std::size_t few() const { return std::size_t(camera_.width * camera_.height) / 1000; }

  PreparedCloud prepared_;
  std::vector<vec2> dots_;
  std::vector<float> opacity_;
  std::unique_ptr<GpuCloud> gpu_;
  Camera camera_ = camera_at({0.4, -2.5, 0.5}, 301, 187);
  Footprint footprint_;
};

}  // namespace

TEST_F(PointsCpuTest, SizesInPixelsAndScene) {
  for (const float size : {1.0f, 2.0f, 5.5f, 30.0f}) {
    footprint_ = {SizeMode::pixels, size};
    EXPECT_EQ(differing(), 0u) << size;
  }
  footprint_ = {SizeMode::world, 0.05f};
  EXPECT_EQ(differing(), 0u);
  footprint_.single_px = 5;
  EXPECT_EQ(differing(), 0u);
  footprint_.oriented = true;
  EXPECT_LE(differing(), few());
  footprint_ = {SizeMode::pixels, 200};
  footprint_.most_px = 40;
  EXPECT_EQ(differing(), 0u);
}

TEST_F(PointsCpuTest, SizesOfTheSpacing) {
  footprint_ = {SizeMode::adaptive, 2};
  EXPECT_LE(differing(), few());
  footprint_.wide_px = 4;
  EXPECT_LE(differing(), few());
  gpu_->set_field(gpu_->make_values("spacings", std::vector<float>(prepared_.cloud.size(), 0.04f)));
  footprint_.spacing_is_field = true;
  EXPECT_LE(differing(), few());
}

TEST_F(PointsCpuTest, Dots) {
  gpu_->set_field(gpu_->make_values("dots", dots_));
  footprint_ = {SizeMode::adaptive, 2.5f};
  footprint_.wide_px = 8, footprint_.dot_share = 0.6f, footprint_.sparse_px = 3;
  footprint_.least_dot_px = 1.9f, footprint_.most_dot_px = 5;
  EXPECT_LE(differing(), few());
}

TEST_F(PointsCpuTest, DiscsInThePlaneOfTheirNormals) {
  footprint_ = {SizeMode::world, 0.08f};
  footprint_.oriented = true;
  EXPECT_LE(differing(), few());
  footprint_.size = 0.008f;  // many in each pixel
  EXPECT_LE(differing(), few());
}

TEST_F(PointsCpuTest, FromEveryCamera) {
  footprint_ = {SizeMode::world, 0.03f};
  camera_ = camera_at({0.05, -0.3, 0}, 301, 187, 110);  // among the points
  EXPECT_LE(differing(), few());
  camera_ = camera_at({0.4, -2.5, 0.5}, 301, 187);
  camera_.projection = Projection::orthographic;
  camera_.height_world = 2;
  EXPECT_LE(differing(), few());
  footprint_.oriented = true;
  EXPECT_LE(differing(), few());
  camera_ = camera_at({0.4, -2.5, 0.5}, 640, 480).tile(250, 130, 200, 160);
  EXPECT_LE(differing(), few());
}

// Of points in several chunks, with and without normals and shadows.
TEST_F(PointsCpuTest, Attributes) {
  expect_same_attributes(true);
  expect_same_attributes(false);
  gpu_->set_shadow(opacity_);
  expect_same_attributes(true);
  camera_.projection = Projection::orthographic;
  camera_.height_world = 2;
  expect_same_attributes(true);
  camera_ = camera_at({0.4, -2.5, 0.5}, 640, 480).tile(250, 130, 200, 160);
  expect_same_attributes(true);
}

TEST_F(PointsCpuTest, BehindAReferenceCutAndByOpacity) {
  footprint_ = {SizeMode::pixels, 4};
  Image<float> limit(camera_.width, camera_.height, 2.4f);
  for (int x = 0; x < limit.width() / 2; ++x) limit.at(x, 90) = std::numeric_limits<float>::infinity();
  gl::Texture reference("reference", GL_R32F, limit.width(), limit.height());
  reference.upload(limit);
  EXPECT_EQ(differing(&reference), 0u);
  GpuCloud::Cut cut;
  cut.planes = {vec4(1, 0, 0, -0.5f)};
  cut.up = vec3(0, 0, 1), cut.u = vec4(1, 0, 0, 1), cut.v = vec4(0, 1, 0, 1);
  cut.across = 2, cut.heights = {0.3f, std::numeric_limits<float>::infinity(), 0.1f, 0.4f};
  gpu_->set_cut(cut);
  EXPECT_EQ(differing(&reference), 0u);
  auto casters = std::make_shared<GpuCloud::Casters>();
  casters->opacity = gpu_->make_values("opacity", opacity_);
  gpu_->set_casters(casters);
  const CasterRange some{0.3f, 0.8f};
  EXPECT_EQ(differing(nullptr, &some), 0u);
}

// The nearest bins of each pixel, each with its nearest point, behind a limit.
TEST_F(PointsCpuTest, Lists) {
  footprint_ = {SizeMode::pixels, 6};
  const int width = camera_.width, height = camera_.height * PointsToPixels::list_length;
  Image<float> limit(width, camera_.height, 1.9f);
  gl::Texture reference("reference", GL_R32F, width, camera_.height);
  reference.upload(limit);
  Image<std::uint32_t> bits[2], index[2];
  for (int k = 0; k < 2; ++k) {
    const WithPreference<gl::Place> with(&gl::Preferences::points, k == 0 ? gl::Place::gpu : gl::Place::cpu);
    PointsToPixels to_pixels;
    gl::Timers timers(false);
    gl::Texture depths("depths", GL_R32UI, width, height), indices("indices", GL_R32UI, width, height);
    depths.clear_uint(0xffffffffu), indices.clear_uint(0xffffffffu);
    to_pixels.draw_lists(*gpu_, view(), footprint_, 0.125f, depths, indices, timers, &reference);
    bits[k] = depths.download<std::uint32_t>(), index[k] = indices.download<std::uint32_t>();
  }
  std::size_t fourth = 0, differ = 0;
  for (std::size_t i = 0; i < bits[0].size(); ++i) {
    fourth += i >= bits[0].size() / 4 * 3 && bits[0].data()[i] != 0xffffffffu;
    differ += bits[0].data()[i] != bits[1].data()[i] || index[0].data()[i] != index[1].data()[i];
  }
  EXPECT_GT(fourth, 1000u);
  EXPECT_EQ(differ, 0u);
}

// Depths of other clouds stay where they are nearer.
TEST_F(PointsCpuTest, AddsToWhatIsThere) {
  footprint_ = {SizeMode::pixels, 3};
  const WithPreference<gl::Place> with(&gl::Preferences::points, gl::Place::cpu);
  PointsToPixels to_pixels;
  gl::Texture before("bits", GL_R32UI, camera_.width, camera_.height);
  before.clear_uint(std::bit_cast<std::uint32_t>(2.4f));
  to_pixels.add_depth(*gpu_, view(), footprint_, before);
  gl::Texture alone;
  to_pixels.draw_depth(*gpu_, view(), footprint_, alone);
  const auto both = before.download<std::uint32_t>(), own = alone.download<std::uint32_t>();
  for (std::size_t i = 0; i < both.size(); ++i)
    ASSERT_EQ(both.data()[i], std::min(own.data()[i], std::bit_cast<std::uint32_t>(2.4f))) << i;
}
