// Eye-dome lighting, ambient occlusion and radiance scaling, of shapes whose relief is known.
#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "passes/relief.h"
#include "reference/gl_fixture.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

constexpr int size = 128;
constexpr double pixel = 1.0 / 32;  // scene units
constexpr float nothing = INFINITY;

class ReliefTest : public GlTest {
 protected:
  using DepthOf = std::function<double(int x, int y)>;
  using NormalOf = std::function<dvec3(int x, int y)>;

  /// The shade of a colour over depths seen from straight above, of a side of `scale * size` px or of a tile
  /// of so much of a picture 720 px high.
  Image<float> shade_of(
      const DepthOf& depth_of, int scale = 1, const NormalOf& normal_of = [](int, int) { return dvec3(0); },
      bool is_tile = false, float color_of_all = 1) {
    const int side = scale * size;
    Image<float> depth(side, side);
    Image<vec4> normal(side, side);
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        depth.at(x, y) = float(depth_of(x / scale, y / scale));
        normal.at(x, y) = vec4(vec3(normal_of(x / scale, y / scale)), 1);
      }
    gl::Texture color("color", GL_RGBA32F, side, side), depth_image("depth", GL_R32F, side, side),
        normal_image("normal", GL_RGBA32F, side, side), out("out", GL_RGBA32F, side, side);
    color.clear(vec4(vec3(color_of_all), 1));
    depth_image.upload(depth), normal_image.upload(normal);
    const Camera camera = is_tile ? camera_above(10, 720 * pixel, 720 * scale).tile(0, 0, side, side)
                                  : camera_above(10, size * pixel, side);
    relief.run(View(camera, dvec3(0)), options, color, depth_image, normal_image, out);
    const Image<vec4> shaded = out.download<vec4>();
    Image<float> shade(side, side);
    for (std::size_t i = 0; i < shade.size(); ++i) shade.data()[i] = shaded.data()[i].x / color_of_all;
    return shade;
  }
  static double mean(const Image<float>& shade, int first, int last) {  // of columns
    double sum = 0;
    for (int y = 32; y < size - 32; ++y)
      for (int x = first; x < last; ++x) sum += double(shade.at(x, y)) / (last - first) / (size - 64);
    return sum;
  }

  Relief relief;
  Relief::Options options;
};

}  // namespace

// Eight neighbours on a circle of 1.4 px, three of which lie beyond a straight edge.
TEST_F(ReliefTest, LinesAlongStepsOfAnyHeightAreAlike) {
  options.edl_strength = 0.4f;
  const auto step_to = [&](double far) {
    return shade_of([&](int x, int) { return x < size / 2 ? 8 : far; });
  };
  const Image<float> low = step_to(9), high = step_to(400);
  for (int x = 0; x < size; ++x) EXPECT_NEAR(low.at(x, size / 2), high.at(x, size / 2), 1e-5) << x;
  const double exponent = 3.0 / 8 * 0.008 * 300 * 0.4 * 2.2;
  EXPECT_NEAR(high.at(size / 2, size / 2), std::exp(-1.2 * (1 - std::exp(-exponent / 1.2))), 1e-4);
  EXPECT_EQ(high.at(size / 2 - 1, size / 2), 1) << "in front";
  EXPECT_EQ(high.at(size / 2 + 2, size / 2), 1);
  const Image<float> beside_nothing =
      shade_of([](int x, int) { return x < size / 2 ? 8.0 : double(nothing); });
  EXPECT_EQ(beside_nothing.at(size / 2 - 1, size / 2), 1);
}

// Steps of any direction take about as much light as rings around everything did (0.44 to 0.48 px of it), and
// so does a wire.
TEST_F(ReliefTest, LinesAlongStepsOfAnyDirectionAreAlike) {
  options.edl_strength = 0.4f;
  for (const double angle : {0.0, 5.0, 11.0, 17.0, 22.5, 30.0, 37.0, 45.0}) {
    const double c = std::cos(angle / 180 * M_PI), s = std::sin(angle / 180 * M_PI);
    const Image<float> step =
        shade_of([&](int x, int y) { return (x - 64.2) * c + (y - 64.1) * s < 0 ? 8 : 9; });
    const double taken = c * size * (1 - mean(step, 0, size));  // across the step, px
    EXPECT_GT(taken, 0.36) << angle;
    EXPECT_LT(taken, 0.48) << angle;
  }
  const Image<float> wire = shade_of([](int x, int) { return x == size / 2 ? 8 : 9; });
  EXPECT_GT(size * (1 - mean(wire, 0, size)), 0.6) << "on both sides";
}

// What lies behind all that is around it is a dark dot, not a black one.
TEST_F(ReliefTest, DotsBehindTheirNeighboursKeepTheirColour) {
  options.edl_strength = 0.4f, options.occlusion = 1;
  const Image<float> shade = shade_of([](int x, int y) { return x % 8 == 4 && y % 8 == 4 ? 9 : 8; });
  EXPECT_GT(shade.at(68, 68), 0.3f);
  EXPECT_LT(shade.at(68, 68), 0.7f);
}

// Dots of 3 px at depths of their own: what is drawn between them is no outline of anything. Some lie by
// chance as deep as those beside them; rings around each take 0.22.
TEST_F(ReliefTest, LeavesHaveNoRings) {
  options.edl_strength = 0.4f;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(6, 9);
  std::vector<double> depths(size * size);
  for (double& depth : depths) depth = any(random);
  const Image<float> leaves =
      shade_of([&](int x, int y) { return depths[std::size_t(y / 3 * size + x / 3)]; });
  EXPECT_GT(mean(leaves, 32, 96), 0.89);
}

TEST_F(ReliefTest, PlanesAndSpheresAreOpen) {
  options.edl_strength = 0.4f, options.occlusion = 1;
  for (const double slope : {0.0, 0.5, 1.0, 2.0, 3.0}) {
    const Image<float> shade = shade_of(
        [&](int x, int y) { return 20 + slope * pixel * (0.8 * (x - size / 2) + 0.6 * (y - size / 2)); });
    float darkest = 1;
    for (int y = 16; y < size - 16; ++y)
      for (int x = 16; x < size - 16; ++x) darkest = std::min(darkest, shade.at(x, y));
    // Squares of the steepest mix depths as far apart as another surface may begin: 4.4 % at 72 degrees.
    EXPECT_GE(darkest, 1 - 0.015 * slope) << slope;
  }
  options.edl_strength = 0;  // its outline is a line
  const Image<float> sphere = shade_of([](int x, int y) {
    const double u = (x + 0.5 - size / 2) * pixel, v = (y + 0.5 - size / 2) * pixel, d = 3.24 - u * u - v * v;
    return d > 0 ? 9 - std::sqrt(d) : double(nothing);
  });
  // Within 3 px of the rim squares are cut by it, and the steepest depths of the sphere are what they mix.
  const auto depth_of_rim = [](int x, int y) {
    return 57.6 - std::hypot(x + 0.5 - size / 2, y + 0.5 - size / 2);
  };
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const double inside = depth_of_rim(x, y);
      if (inside > 0)
        ASSERT_GT(sphere.at(x, y), inside < 3 ? 0.94f : 0.98f) << x << ' ' << y << ' ' << inside;
    }
}

// Squares of the coarsest octave are 32 px wide: in a hollow none of them may be seen.
TEST_F(ReliefTest, OcclusionHasNoSteps) {
  options.edl_strength = 0, options.occlusion = 1;
  const Image<float> shade = shade_of([](int x, int y) {
    const double u = (x - 64) * pixel, v = (y - 20) * pixel;
    return 9 + 0.3 * u * u - 0.2 * v * v + 0.4 * v;  // a saddle: hollow along x
  });
  float most = 0;
  for (int y = 20; y < size - 20; ++y)
    for (int x = 20; x < size - 20; ++x)
      most = std::max({most, std::abs(shade.at(x + 1, y) - shade.at(x, y)),
                       std::abs(shade.at(x, y + 1) - shade.at(x, y))});
  EXPECT_LT(shade.at(64, size / 2), 0.99f) << "there is something to see";
  EXPECT_LT(most, 0.008f) << "two of 255 levels between neighbours";
}

// At the bottom of a valley between slopes of 45 degrees the four slices are open by cos^2 of half of what
// both sides rise: 90 degrees across it, 0 along it, twice atan(sqrt(1/2)) in between.
TEST_F(ReliefTest, AValleyIsAsDarkAsItsClosedForm) {
  options.occlusion = 1;
  const auto valley = [](int x, int) { return 8 - pixel * std::abs(x + 0.5 - size / 2); };
  const double diagonal = std::pow(std::cos(std::atan(std::sqrt(0.5))), 2);
  const double bottom = (0.5 + 1 + 2 * diagonal) / 4;
  const Image<float> shade = shade_of(valley);
  EXPECT_NEAR(mean(shade, size / 2 - 1, size / 2 + 1), bottom, 0.06);  // squares of 2 px end beside it
  EXPECT_GT(mean(shade, size / 2 + 12, size / 2 + 16), bottom + 0.05);
  EXPECT_LT(mean(shade, size / 2 + 12, size / 2 + 16), 0.98) << "coarser octaves reach farther";
  options.occlusion = 0.5f;
  EXPECT_NEAR(mean(shade_of(valley), size / 2 - 1, size / 2 + 1),
              0.5 + 0.5 * mean(shade, size / 2 - 1, size / 2 + 1), 1e-4);
}

// A block 320 px before a wall, of which only 96 to 192 px reach: between the two there is no slope that was
// measured.
TEST_F(ReliefTest, WhatIsOutOfReachTakesNoLight) {
  options.occlusion = 1;
  const Image<float> shade = shade_of([](int x, int y) { return x < 64 && y < 96 ? 2 : 12; });
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      // Squares of 2 px that the edge cuts are the block's.
      if (x >= 66 || y >= 98) ASSERT_GT(shade.at(x, y), 0.999f) << x << ' ' << y;
}

// Of a plane with the noise of a depth camera, here 1.5 px, nothing is drawn; a step of ten times that is.
TEST_F(ReliefTest, NoiseIsNoRelief) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 1.5 * pixel);
  const auto rough = [&](int x, int) { return (x < size / 2 ? 8 : 8 + 15 * pixel) + noise(random); };
  options.edl_strength = 0.4f, options.occlusion = 0.7f;
  EXPECT_LT(mean(shade_of(rough), 16, 48), 0.95) << "of which the picture alone tells a part";
  options.noise = float(1.5 * pixel);
  const Image<float> shade = shade_of(rough);
  EXPECT_GT(mean(shade, 16, 48), 0.98);
  EXPECT_LT(mean(shade, size / 2, size / 2 + 1), 0.8);
}

// A print shows what the preview showed.
TEST_F(ReliefTest, LargePicturesAreShadedAsSmallOnes) {
  options.edl_strength = 0.4f, options.occlusion = 0.7f, options.scaling = 0.25f;
  const auto hills = [](int x, int y) { return 9 + 0.3 * std::sin(0.2 * x) * std::sin(0.17 * y) + (x > 90); };
  const auto turned = [](int x, int y) {
    return glm::normalize(dvec3(0.5 * std::cos(0.2 * x) * std::sin(0.17 * y), 0.4 * std::sin(0.2 * x), 1));
  };
  const Image<float> small = shade_of(hills, 1, turned, true, 0.5f),
                     large = shade_of(hills, 4, turned, true, 0.5f);
  double difference = 0, relief_seen = 0;
  for (int y = 16; y < size - 16; ++y)
    for (int x = 16; x < size - 16; ++x) {
      double sum = 0;
      for (int k = 0; k < 16; ++k) sum += double(large.at(4 * x + k % 4, 4 * y + k / 4)) / 16;
      difference += std::abs(sum - double(small.at(x, y)));
      relief_seen += std::abs(1 - double(small.at(x, y)));
    }
  EXPECT_GT(relief_seen, 200);
  EXPECT_LT(difference, 0.35 * relief_seen);  // stairs of the enlarged depths have lines of their own
}

namespace {

/// A ball, or a bowl, of a radius in px around the middle of the picture.
double ball(int x, int y, double radius) {
  const double u = x + 0.5 - size / 2, v = y + 0.5 - size / 2;
  return std::sqrt(std::max(radius * radius - u * u - v * v, 0.0));
}
dvec3 normal_of_ball(int x, int y, double radius) {
  return dvec3(x + 0.5 - size / 2, size / 2 - y - 0.5, ball(x, y, radius)) / radius;
}
bool is_on_ball(int x, int y, double radius) {  // with all that its normals are compared with
  return std::hypot(x + 0.5 - size / 2, y + 0.5 - size / 2) < radius - 9;
}

}  // namespace

// On a ball of R px normals open by 2 r / R over r px to both sides, along both axes; over 2, 3, 4, 6 and 8
// px by 9.2 / R in the mean.
TEST_F(ReliefTest, RidgesAreLightenedAndValleysDarkenedByTheirClosedForm) {
  options.scaling = 0.25f;
  for (const double radius : {40.0, 60.0, 300.0})
    for (const int side : {1, -1}) {
      const Image<float> shade = shade_of(
          [&](int x, int y) { return 12 - side * pixel * ball(x, y, radius); }, 1,
          [&](int x, int y) { return normal_of_ball(x, y, radius) * dvec3(side, side, 1); }, false, 0.3f);
      for (int y = 10; y < size - 10; ++y)
        for (int x = 10; x < size - 10; ++x) {
          if (!is_on_ball(x, y, radius)) continue;
          const double slanted = ball(x, y, radius) / radius, angle = side * 9.2 / radius * slanted;
          ASSERT_NEAR(shade.at(x, y), std::exp(0.25 * std::tanh(angle / 0.35)), 2e-4)
              << radius << ' ' << side << ' ' << x << ' ' << y;
        }
    }
}

TEST_F(ReliefTest, RidgesAreNeitherNoiseNorFinerThanThePoints) {
  options.scaling = 0.25f;
  const double radius = 200;
  const auto at_middle = [&] {
    return double(shade_of([&](int x, int y) { return 12 - pixel * ball(x, y, radius); }, 1,
                           [&](int x, int y) { return normal_of_ball(x, y, radius); }, false, 0.3f)
                      .at(size / 2, size / 2));
  };
  const auto gain = [](double angle) { return std::exp(0.25 * std::tanh(angle / 0.35)); };
  EXPECT_NEAR(at_middle(), gain(9.2 / radius), 1e-4);
  options.median_spacing = float(4 * pixel);  // of which 8 px are enough, 6 px half, 4 px none
  EXPECT_NEAR(at_middle(), gain((16.0 + 0.5 * 12) / 5 / radius), 1e-4);
  // Dots of one normal each have no borders: within them nothing turns.
  const Image<float> dots = shade_of(
      [&](int x, int y) { return 12 - pixel * ball(x, y, radius); }, 1,
      [&](int x, int y) { return normal_of_ball(x / 4 * 4 + 1, y / 4 * 4 + 1, radius); }, false, 0.3f);
  for (int y = size / 2; y < size / 2 + 8; ++y)
    for (int x = size / 2; x < size / 2 + 8; ++x)
      EXPECT_NEAR(dots.at(x, y), gain((16.0 + 0.5 * 12) / 5 / radius), 0.004) << x << ' ' << y;
  options.median_spacing = float(9 * pixel);
  EXPECT_EQ(at_middle(), 1);
  options.median_spacing = 0;
  // Arcs of 16 px rise by 64 / 2R = .16 px, those of 12 px by .09, of 8 px by .04.
  options.noise = float(0.06 * pixel);
  EXPECT_NEAR(at_middle(), gain((16 / radius - 4 * 0.06 / 8 + 12 / radius - 4 * 0.06 / 6) / 5), 1e-4);
  options.noise = float(0.17 * pixel);
  EXPECT_EQ(at_middle(), 1);
}

TEST_F(ReliefTest, RidgesEndWhereTheSurfaceDoes) {
  options.scaling = 1;
  // A roof before a slope, beside nothing, and a strip without normals.
  const auto depth = [](int x, int y) { return y < 24 ? double(nothing) : x < size / 2 ? 8.0 : 12.0; };
  const auto normal = [](int x, int y) {
    return y >= 96 ? dvec3(0) : x < size / 2 ? dvec3(0, 0, 1) : dvec3(0.6, 0, 0.8);
  };
  const Image<float> shade = shade_of(depth, 1, normal, false, 0.3f);
  for (int y = 24; y < size; ++y)
    for (int x = 0; x < size; ++x) ASSERT_EQ(shade.at(x, y), 1) << x << ' ' << y;
  // What is white can be no lighter, and keeps its tone.
  const Image<float> white = shade_of([](int x, int y) { return 12 - pixel * ball(x, y, 60); }, 1,
                                      [](int x, int y) { return normal_of_ball(x, y, 60); });
  EXPECT_EQ(white.at(size / 2, size / 2), 1);
}

// Normals that turn at once, on a crease or between the faces of a coarse mesh, draw neither lines nor bands
// over 8 px; those that turn over some pixels, on a rounded edge, do.
TEST_F(ReliefTest, EdgesAreRidgesWhereTheyAreRound) {
  options.scaling = 1;
  const auto roof = [](int x, int) { return 8 + 0.75 * pixel * std::abs(x + 0.5 - size / 2); };
  const Image<float> sharp = shade_of(
      roof, 1, [](int x, int) { return dvec3(x < size / 2 ? -0.6 : 0.6, 0, 0.8); }, false, 0.3f);
  for (int y = 0; y < size; ++y)
    for (int x = 9; x < size - 9; ++x) ASSERT_NEAR(sharp.at(x, y), 1, 1e-6) << x << ' ' << y;
  const Image<float> round = shade_of(
      roof, 1,
      [](int x, int) {
        const double across = 0.6 * std::clamp((x + 0.5 - size / 2) / 4, -1.0, 1.0);
        return dvec3(across, 0, std::sqrt(1 - across * across));
      },
      false, 0.3f);
  EXPECT_GT(mean(round, size / 2 - 1, size / 2 + 1), 1.8);
  EXPECT_NEAR(mean(round, size / 2 + 7, size - 9), 1, 1e-6);
}
