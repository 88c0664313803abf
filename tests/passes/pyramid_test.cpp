#include "passes/pyramid.h"

#include <numeric>

#include "reference/gl_fixture.h"
#include "reference/screen_oracle.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

class Pyramids : public GlTest {};

Camera test_camera(int width, int height, Projection projection) {
  Camera camera = front_camera(width, height);
  camera.projection = projection;
  camera.height_world = 3;
  camera.near_plane = 1;
  camera.far_plane = 10;
  return camera;
}

/// Depths between 2 and 6 on about `share` of the pixels.
Image<float> scattered(int width, int height, double share) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  Image<float> depth(width, height, INFINITY);
  for (float& z : depth) {
    const double chance = uniform(random), value = uniform(random);
    if (chance < share) z = float(2 + 4 * value);
  }
  return depth;
}

TEST_F(Pyramids, NearestPyramidHoldsTheNearestPointOfEverySquare) {
  const Image<float> depth = scattered(128, 64, 0.02);
  for (Projection projection : {Projection::perspective, Projection::orthographic}) {
    const Camera camera = test_camera(128, 64, projection);
    NearestPyramid pyramid;
    pyramid.points(128, 64).upload(eye_positions(camera, depth, 0.25f));
    pyramid.build();
    for (int l = 0; l < NearestPyramid::levels; ++l) {
      const auto texels = pyramid.level(l).download<vec4>();
      ASSERT_EQ(texels.width(), 128 >> l);
      ASSERT_EQ(texels.height(), 64 >> l);
      for (int y = 0; y < texels.height(); ++y)
        for (int x = 0; x < texels.width(); ++x) {
          const auto expected = nearest_in_square(camera, depth, x, y, l);
          const vec4 texel = texels.at(x, y);
          ASSERT_EQ(texel.w > 0, expected.has_value()) << l << " " << x << " " << y;
          if (!expected) continue;
          ASSERT_EQ(texel.w, 0.25f);
          for (int k = 0; k < 3; ++k) ASSERT_EQ(texel[k], float((*expected)[k]));
        }
    }
  }
}

TEST_F(Pyramids, SizesArePaddedToWhatHalvesExactly) {
  EXPECT_EQ(NearestPyramid::padded(1), 64);
  EXPECT_EQ(NearestPyramid::padded(64), 64);
  EXPECT_EQ(NearestPyramid::padded(65), 128);
}

/// Runs the passes on one channel of each image; channel x of `a` and of `b` are checked against each other.
Image<double> run_pull_push(const Weighted& samples, ScreenPassKind kind = ScreenPassKind::automatic) {
  const int w = samples.value.width(), h = samples.value.height();
  Image<vec4> a(w, h), b(w, h);
  for (std::size_t i = 0; i < a.size(); ++i) {
    const float weight = float(samples.weight.data()[i]), value = float(samples.value.data()[i]);
    a.data()[i] = vec4(value * weight, 0, 0, weight);
    b.data()[i] = vec4(0, 0, value, 0);
  }
  PullPush pull_push(kind);
  gl::Texture seeds_a("a", GL_RGBA32F, w, h), seeds_b("b", GL_RGBA32F, w, h);
  seeds_a.upload(a);
  seeds_b.upload(b);
  pull_push.run(seeds_a, seeds_b);
  const auto filled_a = pull_push.filled()[0].a.download<vec4>(),
             filled_b = pull_push.filled()[0].b.download<vec4>();
  Image<double> result(w, h);
  for (std::size_t i = 0; i < result.size(); ++i) {
    result.data()[i] = filled_a.data()[i].x;
    // The same sums, but for where the weight of a sample is multiplied in: one rounding of each.
    EXPECT_NEAR(filled_a.data()[i].x, filled_b.data()[i].z, 4e-7);
  }
  return result;
}

double smooth_field(double x, double y) { return 0.5 + 0.25 * std::sin(x / 28) + 0.25 * std::cos(y / 28); }

Weighted sampled_field(int width, int height, double share) {
  Weighted samples{Image<double>(width, height), Image<double>(width, height)};
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (uniform(random) < share) {
        samples.value.at(x, y) = smooth_field(x, y);
        samples.weight.at(x, y) = 1;
      }
  return samples;
}

TEST_F(Pyramids, PullPushIsThatOfTheEquations) {
  // Odd sizes, so that every level rounds up somewhere; fractional weights as well.
  Weighted samples = sampled_field(57, 35, 0.1);
  for (std::size_t i = 0; i < samples.weight.size(); i += 3) samples.weight.data()[i] *= 0.4;
  const Image<double> expected = pull_push(samples);
  for (ScreenPassKind kind : {ScreenPassKind::fragment, ScreenPassKind::compute}) {
    const Image<double> actual = run_pull_push(samples, kind);
    // 6 levels of sums of 16 floats around 1: some tens of roundings of 6e-8.
    for (std::size_t i = 0; i < actual.size(); ++i) ASSERT_NEAR(actual.data()[i], expected.data()[i], 2e-6);
  }
}

// Two walls side by side, 200 units apart along the view, and a gap between them: with a depth edge every
// filled pixel is one wall or the other, in depth and colour alike, and where the gap ends stays so; without,
// the gap is filled with what is neither.
TEST_F(Pyramids, NothingIsMixedAcrossADepthEdge) {
  constexpr int side = 64;
  Image<vec4> depths(side, side), colors(side, side);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      if ((x >= 27 && x < 38) || uniform(random) > 0.5) continue;
      depths.at(x, y) = x < 27 ? vec4(2, 0, 0, 1) : vec4(202, 0, 0, 1);
      colors.at(x, y) = vec4(x < 27 ? 0.2f : 0.8f, 0, 0, 0);
    }
  gl::Texture a("a", GL_RGBA32F, side, side), b("b", GL_RGBA32F, side, side);
  a.upload(depths);
  b.upload(colors);
  const View view(test_camera(side, side, Projection::orthographic), dvec3(0));
  view.bind();
  PullPush pull_push;
  const auto neither = [&](float depth_edge) {
    pull_push.run(a, b, depth_edge);
    const auto filled = pull_push.filled()[0].a.download<vec4>(),
               color = pull_push.filled()[0].b.download<vec4>();
    int count = 0;
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const float depth = filled.at(x, y).x, shade = color.at(x, y).x;
        // Sums of some tens of floats.
        const bool is_near = std::abs(depth - 2) < 1e-4f && std::abs(shade - 0.2f) < 1e-5f,
                   is_far = std::abs(depth - 202) < 1e-2f && std::abs(shade - 0.8f) < 1e-5f;
        count += !is_near && !is_far;
        if (depth_edge > 0 && x < 27) EXPECT_TRUE(is_near) << x << "," << y;
        if (depth_edge > 0 && x >= 38) EXPECT_TRUE(is_far) << x << "," << y;
      }
    return count;
  };
  // The coarsest square is a picture wide, 3 units, and 4 x 6 times that are less than 200.
  EXPECT_EQ(neither(6), 0);
  EXPECT_GT(neither(0), side * 11 / 2);
}

TEST_F(Pyramids, PullPushKeepsConstantsAndSamples) {
  Weighted constant = sampled_field(100, 80, 0.01);
  for (double& v : constant.value) v = v != 0 ? 0.7 : 0;
  for (double v : run_pull_push(constant)) ASSERT_NEAR(v, 0.7, 1e-6);  // as the paper's notes ask

  const Weighted samples = sampled_field(100, 80, 0.05);
  const Image<double> filled = run_pull_push(samples);
  for (std::size_t i = 0; i < filled.size(); ++i)
    if (samples.weight.data()[i] == 1) ASSERT_EQ(float(filled.data()[i]), float(samples.value.data()[i]));
}

TEST_F(Pyramids, OneSampleFloodsTheImageAndNoneLeavesItEmpty) {
  Weighted one{Image<double>(61, 33), Image<double>(61, 33)};
  for (double v : run_pull_push(one)) ASSERT_EQ(v, 0);
  one.value.at(3, 30) = 0.35;
  one.weight.at(3, 30) = 1;
  for (double v : run_pull_push(one)) ASSERT_NEAR(v, 0.35, 1e-6);
}

double rms_error(const Image<double>& filled) {
  double sum = 0;
  for (int y = 0; y < filled.height(); ++y)
    for (int x = 0; x < filled.width(); ++x) sum += std::pow(filled.at(x, y) - smooth_field(x, y), 2);
  return std::sqrt(sum / double(filled.size()));
}

// The gain is what keeps coarse levels from leaking through. Its measured effect on another smooth field:
// .176 to .021, .141 to .006 and .064 to .0025; half of that must be there on any.
TEST_F(Pyramids, PullPushFollowsASmoothField) {
  const struct {
    double share, rms, effect;
  } rows[] = {
      {0.01, 0.021, 2 * .021 / .176}, {0.05, 0.006, 2 * .006 / .141}, {0.2, 0.0025, 2 * .0025 / .064}};
  for (auto [share, rms, effect] : rows) {
    const Image<double> filled = run_pull_push(sampled_field(128, 128, share));
    EXPECT_LT(rms_error(filled), 1.5 * rms) << share;
    EXPECT_LT(rms_error(filled), effect * rms_error(pull_push(sampled_field(128, 128, share), 1))) << share;
  }
}

}  // namespace
