// Surface splatting against the oracle, analytic answers, and its own ways of drawing against each other.
#include <algorithm>
#include <random>

#include "../bench/frame_difference.h"
#include "reference/compare.h"
#include "reference/gl_fixture.h"
#include "reference/splat_oracle.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

constexpr float epsilon = 0.05f;

PointCloud disc(vec3 center, vec3 normal, float radius, Rgba8 color = {200, 100, 50, 255}) {
  PointCloud cloud;
  cloud.positions = {center};
  cloud.normals = {glm::normalize(normal)};
  cloud.radii = {radius};
  cloud.colors = {color};
  return cloud;
}

PointCloud joined(PointCloud cloud, const PointCloud& other) {
  cloud.positions.insert(cloud.positions.end(), other.positions.begin(), other.positions.end());
  cloud.normals.insert(cloud.normals.end(), other.normals.begin(), other.normals.end());
  cloud.radii.insert(cloud.radii.end(), other.radii.begin(), other.radii.end());
  cloud.colors.insert(cloud.colors.end(), other.colors.begin(), other.colors.end());
  return cloud;
}

PointCloud discs(std::initializer_list<PointCloud> list) {
  PointCloud cloud;
  for (const PointCloud& one : list) cloud = joined(std::move(cloud), one);
  return cloud;
}

/// Discs of all sizes and directions in a ball of radius 1.2 at the origin.
PointCloud disc_soup(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(-1, 1);
  PointCloud cloud;
  while (cloud.size() < count) {
    const vec3 p(uniform(random), uniform(random), uniform(random));
    const vec3 n(uniform(random), uniform(random), uniform(random));
    if (glm::length(p) > 1 || glm::length(n) < 0.1f) continue;
    cloud.positions.push_back(1.2f * p);
    cloud.normals.push_back(glm::normalize(n));
    cloud.radii.push_back(0.04f + 0.1f * std::abs(uniform(random)));
    auto code = [&] { return std::uint8_t(127.5f + 127.5f * uniform(random)); };
    cloud.colors.push_back({code(), code(), code(), 255});
  }
  return cloud;
}

class Splats : public GlTest {
 protected:
  Splats() {
    settings_.transparent = true;
    settings_.shading = Shading::albedo;
    set("epsilon", "0.05");
    set("antialias", "false");
    set("clamp_radius", "false");
    set("radius_scale", "1");
  }
  void set(const std::string& name, const std::string& value) { set_parameter(*technique_, name, value); }
  RenderOutput render(const PointCloud& cloud, const Camera& camera) {
    Renderer renderer(context());
    show(renderer, cloud, technique_->needs());
    return renderer.render(*technique_, camera, settings_, all_outputs());
  }
  /// Near and far as the renderer fits them.
  static Camera fitted(Camera camera, const PointCloud& cloud) {
    camera.fit_depth_range(bounds(cloud));
    return camera;
  }
  template <class Weight>
  static OracleImages expected(const PointCloud& cloud, const Camera& asked, Weight weight,
                               double eps = epsilon) {
    const Camera camera = fitted(asked, cloud);
    const std::vector<OracleSplat> splats = oracle_splats(cloud);
    const int w = camera.width, h = camera.height;
    Image<double> nearest(w, h);
    Image<std::uint8_t> fragile(w, h);
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        bool is_fragile = false;
        const auto hits =
            oracle_hits(oracle_ray(camera, x + 0.5, y + 0.5), splats, splat_near(camera), &is_fragile);
        nearest.at(x, y) = hits.empty() ? std::numeric_limits<double>::infinity() : hits.front().t;
        fragile.at(x, y) = is_fragile;
      }
    const dmat4 back = camera.inverse_view();
    int x = -1, y = 0;  // rays come in the order of pixels
    return oracle_images(camera, [&](const OracleRay& ray) {
      if (++x == w) x = 0, ++y;
      OracleDeeper deeper;
      const auto beyond = [&](int px, int py) {
        px = std::clamp(px, 0, w - 1), py = std::clamp(py, 0, h - 1);
        deeper.fragile = deeper.fragile || fragile.at(px, py);
        return std::clamp(nearest.at(px, py) - nearest.at(x, y), -eps, eps);
      };
      if (std::isfinite(nearest.at(x, y)))
        deeper.way = (beyond(x + 2, y) - beyond(x - 2, y)) * dvec3(back[0]) -
                     (beyond(x, y + 2) - beyond(x, y - 2)) * dvec3(back[1]);
      return oracle_surface(ray, splats, splat_near(camera), eps, weight, deeper);
    });
  }
  void expect_like_oracle(const RenderOutput& out, const OracleImages& oracle) {
    // Normals are stored in 2 x 16 bit (3e-5 rad); on a disc seen at 10:1 that shifts the hit by 3e-4 radii,
    // and weights and colours with it. Float itself adds 1e-6.
    const Difference color = compare(out.color_linear, oracle.color, oracle.band, 2e-3);
    EXPECT_LT(color.max, 4e-3);
    EXPECT_LT(color.mean, 2e-5);
    const Difference depth = compare(out.depth, oracle.depth, oracle.band, 1e-3);
    EXPECT_LT(depth.max, 1e-3);
    EXPECT_LT(depth.mean, 1e-5);
    const Difference normal = compare(out.normal, oracle.normal, oracle.band, 1e-2);
    EXPECT_LT(normal.max, 1e-2);  // sums of opposing normals magnify the weights' error
    EXPECT_LT(normal.mean, 1e-4);
    EXPECT_LT(color.band, out.depth.size() / 5) << "the band must not swallow the test";
    EXPECT_LT(color.flips, 0.2);  // the band is 10 to 100 roundings wide
    EXPECT_LT(std::abs(depth.bias), 0.1);
  }
  std::unique_ptr<Technique> technique_ = find_technique("splats").create();
  RenderSettings settings_;
};

// Core test 1: covered pixels = analytic disc, depth = plane depth.
TEST_F(Splats, FacingDiscIsTheAnalyticDisc) {
  const Camera camera = camera_at({0, -4, 0}, 81, 61);
  const RenderOutput out = render(disc({0, 0, 0}, {0, 1, 0}, 0.7f), camera);
  const double radius_px = 0.7 * camera.pixels_per_unit() / 4;
  for (int y = 0; y < 61; ++y)
    for (int x = 0; x < 81; ++x) {
      const double distance = std::hypot(x + 0.5 - 40.5, y + 0.5 - 30.5);
      if (std::abs(distance - radius_px) < 1e-3) continue;
      ASSERT_EQ(out.color_linear.at(x, y).a, distance < radius_px ? 1 : 0) << x << "," << y;
      // A 16-bit normal tilts the plane by up to 3e-5 over 0.7.
      if (distance < radius_px) ASSERT_NEAR(out.depth.at(x, y), 4, 3e-5);
    }
}

// Core test 2: what an affine projection of the disc would fail.
TEST_F(Splats, TiltedDiscInTheCornerOfAWideView) {
  for (Projection projection : {Projection::perspective, Projection::orthographic}) {
    Camera camera = camera_at({0, -1, 0}, 96, 72, 100);
    camera.projection = projection;
    camera.height_world = 2.4;
    const PointCloud cloud = disc({1.2f, 0, 0.85f}, {0.6f, 1, 0.5f}, 0.4f);
    const RenderOutput out = render(cloud, camera);
    const OracleImages oracle = expected(cloud, camera, wendland);
    EXPECT_GT(
        std::count_if(oracle.depth.begin(), oracle.depth.end(), [](float z) { return std::isfinite(z); }),
        100);
    const Difference depth = compare(out.depth, oracle.depth, oracle.band, 1e-4);
    EXPECT_LT(depth.max, 1e-4);  // 16-bit normal on a disc of 0.4
    EXPECT_LT(depth.band, 20u);
  }
}

// Core test 3: (w1 c1 + w2 c2) / (w1 + w2) in every pixel.
TEST_F(Splats, CoplanarDiscsBlendByTheirWeights) {
  const Camera camera = camera_at({0, -4, 0}, 64, 64);
  const PointCloud cloud = discs({disc({-0.2f, 0, 0}, {0, 1, 0}, 0.6f, {255, 0, 0, 255}),
                                  disc({0.3f, 0, 0}, {0, -1, 0}, 0.7f, {0, 0, 255, 255})});
  const RenderOutput out = render(cloud, camera);
  const double px = camera.pixels_per_unit() / 4;
  int both = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const double px_x = (x + 0.5 - 32) / px, px_y = (y + 0.5 - 32) / px;
      const double rho1 = std::hypot(px_x + 0.2, px_y) / 0.6, rho2 = std::hypot(px_x - 0.3, px_y) / 0.7;
      if (rho1 > 0.999 || rho2 > 0.999) continue;
      ++both;
      const double w1 = wendland(rho1), w2 = wendland(rho2);
      ASSERT_NEAR(out.color_linear.at(x, y).r, w1 / (w1 + w2),
                  1e-3);  // 16-bit normals; 1e-3 is a quarter of a step
      ASSERT_NEAR(out.color_linear.at(x, y).b, w2 / (w1 + w2), 1e-3);
    }
  EXPECT_GT(both, 50);
}

// Core test 4: epsilon decides what belongs to the surface.
TEST_F(Splats, OnlyWhatIsWithinEpsilonContributes) {
  const Camera camera = camera_at({0, -4, 0}, 33, 33);
  for (auto [gap, mixes] : {std::pair{0.04f, true}, {0.06f, false}}) {
    const PointCloud cloud = discs({disc({0, 0, 0}, {0, 1, 0}, 0.5f, {255, 0, 0, 255}),
                                    disc({0, gap, 0}, {0, 1, 0}, 0.5f, {0, 0, 255, 255})});
    const vec4 middle = render(cloud, camera).color_linear.at(16, 16);
    EXPECT_NEAR(middle.b, mixes ? 0.5 : 0, 1e-3) << gap;
  }
}

TEST_F(Splats, AnEpsilonOfZeroStillDrawsTheNearest) {
  const Camera camera = camera_at({0, -4, 0}, 33, 33);
  set("epsilon", "0");
  const vec4 middle = render(disc({0, 0, 0}, {0, 1, 0}, 0.5f), camera).color_linear.at(16, 16);
  EXPECT_EQ(middle.a, 1);
}

// Where points are sparser than elsewhere, two of their own spacings are one surface: of those of a dense
// part next to it, noise of the sparse one would be cobbles. The nearest disc decides: what is far behind
// fine points belongs to another surface, however sparse.
TEST_F(Splats, AutomaticEpsilonIsThatOfThePlace) {
  set("epsilon", "auto");
  const Camera camera = camera_at({0, -4, 0}, 33, 33);
  // A square grid of this spacing has discs of 0.5 (2 / sqrt(pi) spacings).
  const float two_spacings = 2 * 0.5f / 1.1284f;
  struct Case {
    float front_radius, gap;
    bool mixes;
  };
  for (const auto& [front_radius, gap, mixes] :
       {Case{0.5f, 0.95f * two_spacings, true}, Case{0.5f, 1.05f * two_spacings, false},
        Case{0.05f, 0.2f * two_spacings, false}}) {
    PointCloud cloud = discs({disc({0, 0, 0}, {0, 1, 0}, front_radius, {255, 0, 0, 255}),
                              disc({0, gap, 0}, {0, 1, 0}, 0.5f, {0, 0, 255, 255})});
    for (int k = 0; k < 1000; ++k) {  // a dense part, which the median is of
      const PointCloud one = disc({0.7f + 0.01f * float(k % 40), 0, 0.01f * float(k / 40)}, {0, 1, 0}, 0.01f);
      cloud = joined(std::move(cloud), one);
    }
    const vec4 middle = render(cloud, camera).color_linear.at(16, 16);
    EXPECT_NEAR(middle.b, mixes ? 0.5 : 0, 1e-3) << front_radius << " " << gap;
  }
}

// Core test 5 and the rest of the equations: a soup of discs, every projection and both kernels.
TEST_F(Splats, SoupMatchesTheOracle) {
  const PointCloud cloud = disc_soup(600, 11);
  Camera perspective = camera_at({0.4, -3, 0.5}, 90, 70);
  Camera off_centre = perspective;
  off_centre.custom_intrinsics = Intrinsics{80, 75, 30, 44};
  Camera orthographic = perspective;
  orthographic.projection = Projection::orthographic;
  orthographic.height_world = 2.6;
  for (const Camera& camera : {perspective, off_centre, orthographic}) {
    set("kernel", "wendland");
    expect_like_oracle(render(cloud, camera), expected(cloud, camera, wendland));
    set("kernel", "gaussian");
    expect_like_oracle(render(cloud, camera), expected(cloud, camera, gaussian));
  }
}

TEST_F(Splats, OpaqueShowsTheNearestDisc) {
  const PointCloud cloud = disc_soup(600, 12);
  const Camera camera = fitted(camera_at({0.4, -3, 0.5}, 90, 70), cloud);
  const std::vector<OracleSplat> splats = oracle_splats(cloud);
  const OracleImages oracle = oracle_images(camera, [&](const OracleRay& ray) {
    OracleSurface out;
    const std::vector<OracleHit> hits = oracle_hits(ray, splats, splat_near(camera), &out.fragile);
    if (hits.empty()) return out;
    // Where two discs cross, roundings of t decide.
    if (hits.size() > 1 && hits[1].t - hits[0].t < 1e-4) out.fragile = true;
    const OracleSplat& s = splats[hits[0].splat];
    out.weight = 1;
    out.color = s.color;
    out.depth = hits[0].depth;
    out.normal = glm::dot(s.normal, ray.direction) > 0 ? -s.normal : s.normal;
    return out;
  });
  set("blend", "opaque");
  expect_like_oracle(render(cloud, camera), oracle);
}

TEST_F(Splats, SphereHasItsDepthAndNormals) {
  PointCloud cloud = sphere_cloud(20000);
  const float radius = 0.04f;  // spacing 0.025
  cloud.radii.assign(cloud.size(), radius);
  const Camera camera = camera_at({0, -4, 0}, 96, 96);
  const RenderOutput out = render(cloud, camera);
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 96; ++x) {
      const OracleRay ray = oracle_ray(camera, x + 0.5, y + 0.5);
      const double middle = -glm::dot(ray.origin, ray.direction);
      const double away2 = glm::dot(ray.origin, ray.origin) - middle * middle;
      if (away2 > 0.8) continue;  // the rim, where discs stick out
      const double t = middle - std::sqrt(1 - away2);
      const dvec3 n = ray.origin + t * ray.direction;
      ASSERT_EQ(out.color_linear.at(x, y).a, 1);
      // A tangent disc leaves the sphere by r^2/2 at its rim, seen at up to 63 degrees; less where it weighs
      // most.
      ASSERT_NEAR(out.depth.at(x, y), t * ray.cosine, 0.5 * radius * radius / std::sqrt(1 - away2))
          << x << "," << y;
      ASSERT_GT(glm::dot(n, dvec3(out.normal.at(x, y))), std::cos(0.5 * radius));  // averaged on both sides
    }
}

// Normals know no inside, and at an outline discs from beyond the horizon show: turned to the camera each on
// its own they would cancel those on this side of it, and the light on the rim would be noise.
TEST_F(Splats, RimsOfClosedThingsAreSeenFromTheSide) {
  PointCloud cloud = sphere_cloud(20000);
  std::mt19937 random(3);
  std::normal_distribution<float> tilt(0, 0.1f);  // 8 degrees, as normals of scans have
  for (vec3& normal : cloud.normals) {
    normal = glm::normalize(normal + vec3(tilt(random), tilt(random), tilt(random)));
    if (random() % 2) normal = -normal;
  }
  cloud.radii.assign(cloud.size(), 0.04f);
  const Camera camera = camera_at({0, -4, 0}, 240, 240);
  const RenderOutput out = render(cloud, camera);
  int rim = 0, wrong = 0;
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 240; ++x) {
      const OracleRay ray = oracle_ray(camera, x + 0.5, y + 0.5);
      const double middle = -glm::dot(ray.origin, ray.direction);
      const dvec3 closest = ray.origin + middle * ray.direction;
      if (out.color_linear.at(x, y).a == 0 || glm::length(closest) < 0.98) continue;
      ++rim;  // there the sphere's normal is within 12 degrees of this one, and so it is where discs stick
              // out
      wrong += glm::dot(dvec3(out.normal.at(x, y)), glm::normalize(closest)) < std::cos(glm::radians(30.0));
    }
  EXPECT_GT(rim, 700);
  EXPECT_LT(wrong, rim / 100) << "of " << rim;
}

// A block whose far sides are red, sampled at a point a pixel and more: their discs reach beyond its edges.
TEST_F(Splats, TheFarSidesOfFacesDoNotRimThem) {
  std::mt19937 random(8);
  std::uniform_real_distribution<float> uniform(-0.5f, 0.5f);
  PointCloud block;
  constexpr int a_side = 9'000;
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0f, 1.0f})
      for (int i = 0; i < a_side; ++i) {
        vec3 p(uniform(random), uniform(random), uniform(random)), n(0);
        p[axis] = 0.5f * side, n[axis] = side;
        block.positions.push_back(p), block.normals.push_back(n);
        block.colors.push_back((axis == 1) == (side < 0) ? Rgba8{200, 200, 200, 255} : Rgba8{255, 0, 0, 255});
      }
  block.radii.assign(block.size(), 1.5f * float(2 / std::sqrt(M_PI * a_side)));
  const auto red_pixels = [&](bool of_faces) {
    block.of_faces = of_faces;
    const RenderOutput out = render(block, camera_at({1.9f, -2.6f, 1.7f}, 200, 200));
    int red = 0, covered = 0;
    for (const vec4& c : out.color_linear) {
      covered += c.a > 0;
      red += c.a > 0 && c.r > 2 * c.g;
    }
    EXPECT_GT(covered, 5000);
    return red;
  };
  const int as_points = red_pixels(false), as_faces = red_pixels(true);
  EXPECT_GT(as_points, 100);
  // Random points: here and there none of the near side lies as close to the edge.
  EXPECT_LT(as_faces, as_points / 3);
}

struct WithPath : WithPreference<gl::SplatPath> {
  explicit WithPath(gl::SplatPath path) : WithPreference(&gl::Preferences::splat_path, path) {}
};

TEST_F(Splats, SpritesAndQuadsGiveTheSamePicture) {
  const PointCloud cloud = disc_soup(400, 5);
  for (const char* antialias : {"false", "true"})
    for (Camera camera : {camera_at({0.4, -2.5, 0.5}, 77, 61), camera_at({0.1, -1.4, 0}, 9, 50)}) {
      set("antialias", antialias);
      RenderOutput results[2];
      int k = 0;
      for (const gl::SplatPath path : {gl::SplatPath::points, gl::SplatPath::quads}) {
        const WithPath with(path);
        results[k++] = render(cloud, camera);
      }
      // The same fragments with the same arithmetic, in the same order.
      for (std::size_t i = 0; i < results[0].depth.size(); ++i) {
        ASSERT_EQ(results[0].color_linear.data()[i], results[1].color_linear.data()[i]) << i;
        ASSERT_EQ(results[0].depth.data()[i], results[1].depth.data()[i]) << i;
      }
    }
}

// Loops list only splats near the visible surface; the picture must not know.
TEST_F(Splats, LoopsAndRasterGiveTheSamePicture) {
  PointCloud cloud = disc_soup(3000, 5);
  PointCloud inner = sphere_cloud(4000, 0.9f);
  inner.radii.assign(inner.size(), 0.03f);
  append(cloud, inner);
  for (Projection projection : {Projection::perspective, Projection::orthographic})
    for (const char* antialias : {"false", "true"})
      for (const char* kernel : {"wendland", "gaussian"}) {
        set("antialias", antialias);
        set("kernel", kernel);
        Camera camera = camera_at({0.4, -2.5, 0.5}, 101, 67);
        camera.projection = projection;
        camera.height_world = 2;
        RenderOutput results[3];
        int k = 0;
        for (const gl::SplatPath path : {gl::SplatPath::points, gl::SplatPath::compute}) {
          const WithPath with(path);
          results[k++] = render(cloud, camera);
        }
        {
          const WithPreference<gl::Place> with(&gl::Preferences::splats, gl::Place::cpu);
          results[k++] = render(cloud, camera);
        }
        // Two programs may round t differently, which flips a pixel where t meets t_min + epsilon or a rim:
        // at most one in a thousand; elsewhere the sums differ by roundings.
        for (const RenderOutput& result : results) {
          std::size_t flips = 0;
          for (std::size_t i = 0; i < result.depth.size(); ++i) {
            const vec4 a = results[0].color_linear.data()[i], b = result.color_linear.data()[i];
            flips += std::abs(signed_difference(a, b)) > 1e-5;
          }
          EXPECT_LE(flips, result.depth.size() / 1000) << antialias << kernel;
        }
      }
}

TEST_F(Splats, ADiscLargerThanAnySpriteIsStillDrawn) {
  // The camera stands 0.01 before a wall of radius 50: the box reaches through the plane of the eye.
  const Camera camera = camera_at({0, -0.01, 0}, 64, 48, 90);
  const RenderOutput out = render(disc({0, 0, 0}, {0.3f, 1, 0}, 50), camera);
  const auto covered =
      std::count_if(out.depth.begin(), out.depth.end(), [](float z) { return std::isfinite(z); });
  EXPECT_EQ(covered, 64 * 48);
  EXPECT_TRUE(out.notes.empty()) << "how a driver draws it is nobody's concern";
}

TEST_F(Splats, ASplatWhoseCentreIsOutsideIsNotLost) {
  const Camera camera = camera_at({0, -2, 0}, 40, 40);
  const PointCloud cloud = disc({1.5f, 0, 0}, {0, 1, 0}, 1.2f);  // centre 30 px beyond the right border
  const RenderOutput out = render(cloud, camera);
  const OracleImages oracle = expected(cloud, camera, wendland);
  const Difference depth = compare(out.depth, oracle.depth, oracle.band, 1e-3);
  EXPECT_LT(depth.max, 1e-4);
  EXPECT_GT(std::count_if(out.depth.begin(), out.depth.end(), [](float z) { return std::isfinite(z); }), 200);
}

// Discs far below a pixel: sampling alone loses most of them, the screen filter keeps a closed surface.
TEST_F(Splats, AntialiasingClosesTinySplats) {
  PointCloud cloud = sphere_cloud(60000);
  cloud.radii.assign(cloud.size(), 0.004f);
  const Camera camera = camera_at({0, -4, 0}, 64, 64);
  auto share = [&] {
    const RenderOutput out = render(cloud, camera);
    int inside = 0, covered = 0;
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        if (std::hypot(x - 31.5, y - 31.5) > 15) continue;
        ++inside;
        covered += out.color_linear.at(x, y).a > 0;
      }
    return double(covered) / inside;
  };
  EXPECT_LT(share(), 0.9);
  set("antialias", "true");
  EXPECT_EQ(share(), 1);
}

TEST_F(Splats, AntialiasingLeavesLargeSplatsAlone) {
  PointCloud cloud = sphere_cloud(500);
  cloud.radii.assign(cloud.size(), 0.25f);  // 16 px
  const Camera camera = camera_at({0, -4, 0}, 160, 160);
  const RenderOutput off = render(cloud, camera);
  set("antialias", "true");
  const RenderOutput on = render(cloud, camera);
  // Inside a disc the filter only raises weights within 1 px of a centre.
  double mean = 0;
  for (std::size_t i = 0; i < off.color_linear.size(); ++i)
    mean +=
        glm::length(off.color_linear.data()[i] - on.color_linear.data()[i]) / double(off.color_linear.size());
  EXPECT_LT(mean, 2e-3);
}

// The disc is a floor under the eye: its centre is nowhere on the screen, where the filter measures.
TEST_F(Splats, AntialiasingSparesDiscsWhoseCentreIsBehindTheEye) {
  const PointCloud cloud = discs({disc({0, -4.1f, -0.2f}, {0, 0, 1}, 1), disc({0, 0, 1}, {0, -1, 0}, 1)});
  const Camera camera = camera_at({0, -4, 0}, 64, 48, 100);
  const RenderOutput plain = render(cloud, camera);
  set("antialias", "true");
  const RenderOutput filtered = render(cloud, camera);
  int floor = 0;
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) {
      if (!(plain.depth.at(x, y) < 1)) continue;
      ++floor;
      ASSERT_EQ(filtered.depth.at(x, y), plain.depth.at(x, y)) << x << "," << y;
      ASSERT_EQ(filtered.color_linear.at(x, y), plain.color_linear.at(x, y));
    }
  EXPECT_GT(floor, 500);
}

TEST_F(Splats, ClampedRadiiKeepOutliersSmall) {
  PointCloud cloud = sphere_cloud(3000, 0.5f);
  cloud.radii.assign(cloud.size(), 0.02f);
  cloud.positions.push_back({1.2f, 0, 1.0f});
  cloud.normals.push_back({0, -1, 0});
  cloud.colors.push_back({255, 255, 255, 255});
  cloud.radii.push_back(0.5f);
  const Camera camera = camera_at({0, -4, 0}, 128, 128);
  auto corner = [&] {
    const RenderOutput out = render(cloud, camera);
    int covered = 0;
    for (int y = 0; y < 64; ++y)
      for (int x = 84; x < 128; ++x) covered += std::isfinite(out.depth.at(x, y));
    return covered;
  };
  const double px = camera.pixels_per_unit() / 4;
  EXPECT_GT(corner(), 1000);
  set("clamp_radius", "true");
  EXPECT_NEAR(corner(), std::acos(-1) * std::pow(0.08 * px, 2), 20);  // radius 4 x 0.02; 20 = its rim in px
  set("radius_scale", "2");
  EXPECT_NEAR(corner(), std::acos(-1) * std::pow(0.16 * px, 2), 40);
}

TEST_F(Splats, GroundAroundADenseObjectHasNoHoles) {
  // Most points on a ball, so that the median radius is its; around it ground that is so many times as
  // sparse: what a scanner stands beside, and a scan of a building on one from the air.
  struct Case {
    std::size_t on_ball;
    double sparser, side;
  };
  for (const auto& [on_ball, sparser, side] : {Case{20'000, 3.5, 5}, Case{100'000, 12, 18}}) {
    PointCloud cloud = sphere_cloud(on_ball, 0.5f);
    cloud.normals.clear();
    std::mt19937 random(8);
    std::uniform_real_distribution<float> uniform(float(-side / 2), float(side / 2));
    const double spacing = sparser * std::sqrt(std::acos(-1.0) / double(on_ball));
    for (int i = 0; i < int(side * side / (spacing * spacing)); ++i)
      cloud.positions.push_back({uniform(random), uniform(random), -0.55f});
    ASSERT_GT(on_ball, cloud.size() / 2);
    cloud.colors.assign(cloud.size(), {200, 200, 200, 255});
    cloud.radii.clear();
    set("clamp_radius", "true");
    set("radius_scale", "1.5");  // both as by default
    const double away = 1.6 * side;
    const RenderOutput out = render(cloud, camera_at({0, 0, away}, 256, 256));
    int inside = 0, open = 0;
    const double px = 256 / 2 / std::tan(glm::radians(22.5)) / (away + 0.55);
    const int reach = int((side / 2 - 0.3) * px);  // a row of discs away from its end
    for (int y = 128 - reach; y < 128 + reach; ++y)
      for (int x = 128 - reach; x < 128 + reach; ++x) ++inside, open += !std::isfinite(out.depth.at(x, y));
    EXPECT_GT(inside, 20'000);
    EXPECT_LT(open, 0.001 * inside) << sparser;  // 1e-4 of a random surface is uncovered by such discs
  }
}

// How discs lie in each other's way is no relief, where they are many pixels wide; what is as high as they
// are apart is, and so is everything where they are small.
TEST_F(Splats, EyeDomeLightingShowsNoStepsBelowTheSpacing) {
  const auto darkened = [&](double step, double distance) {
    PointCloud cloud;
    for (int k = 0; k < 40 * 40; ++k) {
      const int column = k % 40, row = k / 40;
      const double uneven = (column + row) % 2 == 0 ? 0.02 : -0.02;  // a fifth of their spacing of 0.1
      cloud = joined(std::move(cloud),
                     disc({0.1 * (column - 20), uneven + (column < 20 ? 0 : step), 0.1 * (row - 20)},
                          {0, 1, 0}, 0.075f));
    }
    const Camera camera = camera_at({0, -distance, 0}, 128, 128, 20);
    settings_.edl.user = false;
    const RenderOutput plain = render(cloud, camera);
    settings_.edl.user = true;
    settings_.edl_strength.user = 0.4f;
    const RenderOutput relief = render(cloud, camera);
    const int reach = std::min(64, int(1.8 * camera.pixels_per_unit() / distance));  // not its border
    int count = 0;
    for (int y = 64 - reach; y < 64 + reach; ++y)
      for (int x = 64 - reach; x < 64 + reach; ++x)
        count += relief.color_linear.at(x, y).r < 0.99f * plain.color_linear.at(x, y).r;
    return count;
  };
  set("epsilon", "0.01");        // each disc for itself
  EXPECT_EQ(darkened(0, 4), 0);  // 9 px apart
  EXPECT_GT(darkened(0.3, 4), 90);
  EXPECT_EQ(darkened(0, 20), 0);  // 1.8 px apart: noise
}

// Along a slow orbit around random colours, the average of many discs changes less than the nearest disc
// alone.
TEST_F(Splats, WeightedBlendingIsSteadierThanOpaque) {
  PointCloud cloud = sphere_cloud(4000);
  cloud.radii.assign(cloud.size(), 0.12f);
  std::mt19937 random(9);
  for (Rgba8& c : cloud.colors)
    c = {std::uint8_t(random()), std::uint8_t(random()), std::uint8_t(random()), 255};
  Renderer renderer(context());
  show(renderer, cloud, technique_->needs());
  bench::FrameDifference results[2];
  int k = 0;
  for (const char* blend : {"weighted", "opaque"}) {
    set("blend", blend);
    bench::FrameDifferenceMeter meter;
    for (int frame = 0; frame < 5; ++frame) {
      const double angle = 0.005 * frame;
      const Camera camera = camera_at({4 * std::sin(angle), -4 * std::cos(angle), 0}, 64, 64);
      meter.add(renderer.render(*technique_, camera, settings_).rgba8);
    }
    results[k++] = meter.result();
  }
  EXPECT_EQ(results[0].pairs, 4u);
  EXPECT_GT(results[0].mean, 0);
  EXPECT_GE(results[0].worst, results[0].mean);
  EXPECT_LT(1.5 * results[0].mean, results[1].mean);
}

TEST_F(Splats, ShadowFactorsAreAveragedLikeColours) {
  const PointCloud cloud = discs({disc({-0.2f, 0, 0}, {0, 1, 0}, 0.6f), disc({0.3f, 0, 0}, {0, 1, 0}, 0.7f)});
  PreparedCloud prepared = analysis::prepare(cloud, {}, {});
  GpuCloud gpu(prepared, colors_of(prepared.cloud));
  const std::vector<float> factors{0.25f, 1};
  std::vector<float> sorted;
  for (std::uint32_t source : prepared.cloud.source_index) sorted.push_back(factors[source]);
  gpu.set_shadow(sorted);
  Camera camera = camera_at({0, -4, 0}, 48, 48);
  camera.fit_depth_range(gpu.bounds());
  Target target(48, 48);
  gl::Timers timers(false);
  RenderSettings lit;
  Frame frame{gpu, camera, lit, Light::parse(lit.light_text), target, true, timers, no_progress()};
  ASSERT_TRUE(technique_->render(frame));
  const Image<vec4> normal = target.normal.download<vec4>();
  std::vector<OracleSplat> splats = oracle_splats(cloud);
  for (std::size_t i = 0; i < 2; ++i) splats[i].shadow = factors[i];
  for (int x = 4; x < 44; ++x) {
    const OracleSurface s =
        oracle_surface(oracle_ray(camera, x + 0.5, 24.5), splats, splat_near(camera), epsilon, wendland);
    if (!s.fragile) EXPECT_NEAR(normal.at(x, 24).w, s.shadow, 1e-3) << x;
  }
}

}  // namespace
