// What a picture covers, points must vouch for: which pixels they do, and that every technique that fills
// keeps to it.
#include <cmath>
#include <random>

#include "passes/evidence.h"
#include "reference/gl_fixture.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

class EvidenceTest : public GlTest {};

/// Of each pixel, squared, to the nearest one that `is_goal`.
template <class IsGoal>
Image<int> squares_of_distances(int width, int height, const IsGoal& is_goal) {
  Image<int> out(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      int nearest = 1 << 30;
      for (int v = 0; v < height; ++v)
        for (int u = 0; u < width; ++u)
          if (is_goal(u, v)) nearest = std::min(nearest, (u - x) * (u - x) + (v - y) * (v - y));
      out.at(x, y) = nearest;
    }
  return out;
}

/// A wall that is dense on one side and ever sparser on the other, as far from a scanner.
PointCloud thinning_wall() {
  PointCloud cloud;
  for (double x = -250, apart = 2; x < 250; x += apart, apart = x < -50 ? 2 : std::min(apart * 1.3, 40.0))
    for (double z = -150; z < 150; z += apart) cloud.positions.push_back({float(x), 0, float(z)});
  cloud.colors.assign(cloud.size(), {200, 120, 60, 255});
  return cloud;
}

double share_far_from(const PointCloud& cloud, const Camera& camera, const Image<float>& depth, double far) {
  Image<int> points(camera.width, camera.height);
  const Intrinsics k = camera.intrinsics();
  for (const vec3& p : cloud.positions) {
    const double depth_of_point = p.y - camera.position.y;
    const int x = int(std::floor(k.cx + k.fx * p.x / depth_of_point)),
              y = int(std::floor(k.cy - k.fy * p.z / depth_of_point));
    if (x >= 0 && y >= 0 && x < camera.width && y < camera.height) points.at(x, y) = 1;
  }
  int covered = 0, alone = 0;
  const int reach = int(far);
  for (int y = reach; y < camera.height - reach; ++y)
    for (int x = reach; x < camera.width - reach; ++x) {
      if (!std::isfinite(depth.at(x, y))) continue;
      bool is_near = false;
      for (int v = -reach; v <= reach && !is_near; ++v)
        for (int u = -reach; u <= reach && !is_near; ++u)
          is_near = u * u + v * v <= far * far && points.at(x + u, y + v);
      ++covered, alone += !is_near;
    }
  EXPECT_GT(covered, 10'000);
  return double(alone) / covered;
}

}  // namespace

TEST_F(EvidenceTest, PixelsAreThoseBesideTheShapeOfPoints) {
  constexpr int size = 72, band = 14;
  const EvidenceReach reach{6.5f, 2.25f};
  std::mt19937 random(3);
  Image<std::uint32_t> bits(size, size);
  std::fill(bits.begin(), bits.end(), 0xffffffffu);
  std::uniform_int_distribution<int> anywhere(0, size - 1);
  for (int n = 0; n < 70; ++n) bits.at(anywhere(random), anywhere(random)) = 1;
  const auto to_points =
      squares_of_distances(size, size, [&](int x, int y) { return bits.at(x, y) != 0xffffffffu; });
  const auto to_open =
      squares_of_distances(size, size, [&](int x, int y) { return to_points.at(x, y) > 6.5 * 6.5; });
  gl::Texture points("points", GL_R32UI, size, size);
  points.upload(bits);
  for (const gl::Place place : {gl::Place::gpu, gl::Place::cpu}) {
    const WithPreference<gl::Place> with(&gl::Preferences::evidence, place);
    Evidence evidence;
    const gl::Texture& found = evidence.find(points, band, size - 2 * band - 1, size - 2 * band, reach);
    const Image<float> mask = found.download<float>();
    int between = 0, beside = 0, open = 0;
    for (int y = 0; y < mask.height(); ++y)
      for (int x = 0; x < mask.width(); ++x) {
        const int point = to_points.at(x + band, y + band), disc = to_open.at(x + band, y + band);
        const bool is_vouched = disc > 4.25 * 4.25;
        EXPECT_EQ(mask.at(x, y) > 0, is_vouched) << x << ' ' << y;
        if (point <= 2.25 * 2.25) EXPECT_TRUE(is_vouched) << "around a point " << x << ' ' << y;
        between += disc > 6.5 * 6.5 && point > 9, beside += is_vouched && disc <= 6.5 * 6.5,
            open += !is_vouched;
      }
    EXPECT_GT(between, 30);
    EXPECT_GT(beside, 30);
    EXPECT_GT(open, 100);
  }
}

TEST_F(EvidenceTest, NothingIsCoveredFarFromAllPoints) {
  Camera camera = front_camera(640, 400);
  camera.position = {0, -400, 0};
  Renderer renderer(context());
  for (const char* name : {"splats", "surface", "strokes", "denoise", "soft", "layers"}) {
    SCOPED_TRACE(name);
    const auto technique = find_technique(name).create();
    show(renderer, thinning_wall(), technique->needs());
    const Image<float> depth = renderer.render(*technique, camera, {}, all_outputs()).depth;
    // Between points that surround it up to 11 px, and nowhere farther.
    EXPECT_LE(share_far_from(thinning_wall(), camera, depth, 8.8), 0.02);
    EXPECT_EQ(share_far_from(thinning_wall(), camera, depth, 12), 0);
  }
}

// Of a hole in a sparse sheet no more than 8 px beside its rim, however large the discs are that close the
// sheet.
TEST_F(EvidenceTest, HolesOfSparseSurfacesStayOpen) {
  constexpr float hole = 4;
  PointCloud cloud;
  for (int z = -60; z <= 60; ++z)
    for (int x = -60; x <= 60; ++x)
      if (std::hypot(x, z) > hole) cloud.positions.push_back({float(x), 0, float(z)});
  cloud.colors.assign(cloud.size(), {200, 200, 200, 255});
  Renderer renderer(context());
  Camera camera = front_camera(320, 240);  // a spacing is 10 px
  camera.position = {0, -29, 0};
  const Intrinsics k = camera.intrinsics();
  for (const char* name : {"splats", "surface", "strokes", "denoise", "soft", "layers"}) {
    SCOPED_TRACE(name);
    const auto technique = find_technique(name).create();
    show(renderer, cloud, technique->needs());
    const Image<float> depth = renderer.render(*technique, camera, {}, all_outputs()).depth;
    int inside = 0, around = 0;
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const double away = std::hypot(x + 0.5 - k.cx, y + 0.5 - k.cy) * 29 / k.fy;
        inside += away < hole - 0.9 && std::isfinite(depth.at(x, y));
        around += away > hole + 1.5 && !std::isfinite(depth.at(x, y));
      }
    EXPECT_EQ(inside, 0);
    EXPECT_LE(around, 320 * 240 / 200);
  }
}

// Who comes near sees the surface between points that stand farther apart than that.
TEST_F(EvidenceTest, ASurfaceStaysClosedNearBy) {
  PointCloud cloud;
  for (int z = -60; z <= 60; ++z)
    for (int x = -60; x <= 60; ++x) cloud.positions.push_back({float(x), 0, float(z)});
  cloud.colors.assign(cloud.size(), {200, 200, 200, 255});
  Renderer renderer(context());
  Camera camera = front_camera(320, 240);  // 16 spacings wide: one is 20 px
  camera.position = {0, -14.5, 0};
  for (const char* name : {"splats", "surface", "strokes", "denoise", "soft", "layers"}) {
    SCOPED_TRACE(name);
    const auto technique = find_technique(name).create();
    show(renderer, cloud, technique->needs());
    const Image<float> depth = renderer.render(*technique, camera, {}, all_outputs()).depth;
    int open = 0;
    for (float d : depth) open += !std::isfinite(d);
    EXPECT_LE(open, 320 * 240 / 200);
  }
}
