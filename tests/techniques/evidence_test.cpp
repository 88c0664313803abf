// What a picture covers, points must vouch for: which pixels they do, and that every technique that fills
// keeps to it.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "passes/evidence.h"
#include "passes/evidence_cpu.h"
#include "reference/gl_fixture.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

class EvidenceTest : public GlTest {};

/// Points, and what a small circle can enclose of the edges and triangles of their Delaunay triangulation.
struct Complex {
  std::vector<std::array<glm::dvec2, 3>> simplices;  ///< a pair or point repeats its last
  double distance(glm::dvec2 p) const {
    double least = 1e9;
    for (const auto& t : simplices) {
      int left = 0, right = 0;
      for (int k = 0; k < 3; ++k) {
        const glm::dvec2 a = t[std::size_t(k)], b = t[std::size_t(k + 1) % 3], along = b - a;
        const double length2 = glm::dot(along, along);
        const double at = length2 > 0 ? std::clamp(glm::dot(p - a, along) / length2, 0.0, 1.0) : 0;
        least = std::min(least, glm::distance(p, a + at * along));
        const double side = along.x * (p.y - a.y) - along.y * (p.x - a.x);
        left += side >= 0, right += side <= 0;
      }
      if (t[1] != t[2] && (left == 3 || right == 3)) return 0;
    }
    return least;
  }
};

/// By the definition: an empty circle goes through pairs and triples. `through`: the largest of these looked
/// for. `clear`: how far from it all other points are; below 0 how far in it they may be.
Complex complex_of(const std::vector<glm::dvec2>& points, double around, double through, double clear) {
  Complex out;
  const auto keep_if_empty = [&](glm::dvec2 center, double radius, std::array<glm::dvec2, 3> simplex) {
    if (!(radius <= through)) return;
    for (const glm::dvec2& p : points)
      if (glm::distance(p, center) < radius + clear && std::ranges::count(simplex, p) == 0) return;
    out.simplices.push_back(simplex);
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    out.simplices.push_back({points[i], points[i], points[i]});
    for (std::size_t j = i + 1; j < points.size(); ++j) {
      const glm::dvec2 a = points[i], b = points[j] - a;
      const double ab = glm::dot(b, b);
      if (ab > 4 * around * around) continue;
      keep_if_empty(a + 0.5 * b, 0.5 * std::sqrt(ab), {a, points[j], points[j]});
      for (std::size_t k = j + 1; k < points.size(); ++k) {
        const glm::dvec2 c = points[k] - a;
        const double ca = glm::dot(c, c), bc = glm::dot(c - b, c - b), longest = std::max({ab, bc, ca}),
                     twice = 2 * (b.x * c.y - b.y * c.x);
        if (twice == 0) continue;
        const glm::dvec2 center = glm::dvec2(c.y * ab - b.y * ca, b.x * ca - c.x * ab) / twice;
        const double enclosing =
            longest >= ab + bc + ca - longest ? 0.5 * std::sqrt(longest) : glm::length(center);
        if (enclosing <= around) keep_if_empty(a + center, glm::length(center), {a, points[j], points[k]});
      }
    }
  }
  return out;
}

Image<std::uint32_t> random_points(int size, int count, std::mt19937& random) {
  std::uniform_int_distribution<int> anywhere(0, size - 1);
  Image<std::uint32_t> bits(size, size, 0xffffffffu);
  for (int n = 0; n < count; ++n) bits.at(anywhere(random), anywhere(random)) = 1;
  return bits;
}

/// Of the shader and of the loop.
std::array<Image<float>, 2> masks_of(const Image<std::uint32_t>& bits, int band, int width, int height,
                                     const EvidenceReach& reach) {
  gl::Texture points("points", GL_R32UI, bits.width(), bits.height());
  points.upload(bits);
  std::array<Image<float>, 2> masks;
  for (const gl::Place place : {gl::Place::gpu, gl::Place::cpu}) {
    const WithPreference<gl::Place> with(&gl::Preferences::evidence, place);
    Evidence evidence;
    masks[place == gl::Place::cpu] = evidence.find(points, band, width, height, reach).download<float>();
  }
  return masks;
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

TEST_F(EvidenceTest, PixelsAreThoseBesideTheComplexOfPoints) {
  constexpr EvidenceReach reach{6.5f, 2.25f, 2.25f};
  const int band = reach.band(), size = 72 + 2 * band;
  // From the complex to a pixel of it, and from the centre of a circle to the farthest of the four pixels
  // around it: of four points on nearly one circle either pair of triangles may be seen there.
  constexpr double to_pixel = 0.71, to_four = 1.42;
  std::mt19937 random(3);
  int inside = 0, outside = 0;
  for (const int count : {40, 100, 170, 300}) {
    SCOPED_TRACE(count);
    const Image<std::uint32_t> bits = random_points(size, count, random);
    std::vector<glm::dvec2> drawn;
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x)
        if (bits.at(x, y) == 1) drawn.emplace_back(x, y);
    const Complex less = complex_of(drawn, reach.between, 2 * reach.between, to_four),
                  more = complex_of(drawn, reach.between, 1e9, -to_four);
    const auto [of_shader, of_loop] = masks_of(bits, band, size - 2 * band - 1, size - 2 * band, reach);
    EXPECT_TRUE(std::ranges::equal(of_shader, of_loop));
    for (int y = 0; y < of_shader.height(); ++y)
      for (int x = 0; x < of_shader.width(); ++x) {
        const glm::dvec2 pixel(x + band, y + band);
        double to_point = 1e9;
        for (const glm::dvec2& point : drawn) to_point = std::min(to_point, glm::distance(point, pixel));
        const bool is_near = to_point <= reach.between;
        if (is_near && less.distance(pixel) < reach.beside - to_pixel) {
          ++inside;
          EXPECT_GT(of_shader.at(x, y), 0) << x << ' ' << y;
        } else if (!is_near || more.distance(pixel) > reach.beside + to_pixel) {
          ++outside;
          EXPECT_EQ(of_shader.at(x, y), 0) << x << ' ' << y;
        }
      }
  }
  EXPECT_GT(inside, 4000);
  EXPECT_GT(outside, 4000);
}

// A sheet, a line and a point, none of them as near to another as the reach.
TEST_F(EvidenceTest, LoneLinesAndPointsAreWiderThanRims) {
  constexpr EvidenceReach reach{6.5f, 1, 4};
  const int band = reach.band(), size = 62 + 2 * band;
  Image<std::uint32_t> bits(size, size, 0xffffffffu);
  for (int y = 40; y <= 80; y += 4)
    for (int x = 40; x <= 60; x += 4) bits.at(x, y) = 1;
  for (int y = 40; y <= 80; y += 8) bits.at(78, y) = 1;
  bits.at(92, 60) = 1;
  const auto expected = [](glm::dvec2 pixel) {
    const glm::dvec2 beyond = glm::max(glm::abs(pixel - glm::dvec2(50, 60)) - glm::dvec2(10, 20), 0.0);
    const glm::dvec2 line(78, std::clamp(pixel.y, 40.0, 80.0));
    return glm::length(beyond) <= 1 || glm::distance(pixel, line) <= 4 ||
           glm::distance(pixel, glm::dvec2(92, 60)) <= 4;
  };
  for (const Image<float>& mask : masks_of(bits, band, size - 2 * band, size - 2 * band, reach))
    for (int y = 0; y < mask.height(); ++y)
      for (int x = 0; x < mask.width(); ++x)
        EXPECT_EQ(mask.at(x, y) > 0, expected(glm::dvec2(x + band, y + band))) << x << ' ' << y;
}

// Of tall pictures, where products of sides are no longer exact: those of one triangle, whichever way it
// lies, differ by their order about as much as from the limit.
TEST_F(EvidenceTest, FarReachesAreTheSameToTheLoop) {
  constexpr EvidenceReach reach{65, 8.7f, 35.3f};
  const int band = reach.band(), size = 140 + 2 * band;
  std::mt19937 random(5);
  for (int way = 0; way < 10; ++way) {
    SCOPED_TRACE(way);
    Image<std::uint32_t> bits = random_points(size, way < 8 ? 0 : way < 9 ? 60 : 400, random);
    for (ivec2 corner : {ivec2(0, 0), ivec2(6, 108), ivec2(91, 91)}) {
      if (way & 1) corner.x = 108 - corner.x;
      if (way & 2) corner.y = 108 - corner.y;
      if (way & 4) std::swap(corner.x, corner.y);
      bits.at(band + 16 + corner.x, band + 16 + corner.y) = 1;
    }
    const auto [of_shader, of_loop] = masks_of(bits, band, 140, 140, reach);
    EXPECT_TRUE(std::ranges::equal(of_shader, of_loop));
    EXPECT_GT(std::ranges::count(of_loop, 1.0f), 500);
  }
}

// A tile sees as much as the whole picture of what decides about its pixels.
TEST_F(EvidenceTest, TheBandIsWideEnough) {
  std::mt19937 random(7);
  for (const EvidenceReach& reach : {EvidenceReach{6.5f, 4, 4}, EvidenceReach{4.4f, 1, 2}}) {
    const int band = reach.band(), tile = 12, size = tile + 2 * band, more = 24;
    int set = 0;
    for (int n = 0; n < 300; ++n) {
      const Image<std::uint32_t> wide = random_points(size + 2 * more, 20 + n, random);
      Image<std::uint32_t> bits(size, size);
      for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) bits.at(x, y) = wide.at(x + more, y + more);
      const Image<std::uint8_t> of_wide = evidence_mask(wide, band + more, tile, tile, reach),
                                of_tile = evidence_mask(bits, band, tile, tile, reach);
      EXPECT_TRUE(std::ranges::equal(of_wide, of_tile)) << n;
      set += int(std::ranges::count(of_tile, 255));
    }
    EXPECT_GT(set, 3000);
    EXPECT_LT(set, 300 * tile * tile - 3000);
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

// Of a hole in a sparse sheet no more than half a spacing beside its rim, by a brush 8 px, however large the
// discs are that close the sheet.
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
    const double rim = std::string(name) == "strokes" ? 0.9 : 0.6;  // spacings, with a pixel
    int inside = 0, around = 0;
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const double away = std::hypot(x + 0.5 - k.cx, y + 0.5 - k.cy) * 29 / k.fy;
        inside += away < hole - rim && std::isfinite(depth.at(x, y));
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
