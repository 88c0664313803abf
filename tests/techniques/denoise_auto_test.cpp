// The automatic threshold of `denoise` on randomly sampled clouds: against an oracle, and with a wall behind.
#include <algorithm>
#include <map>

#include "reference/compare.h"
#include "reference/gl_fixture.h"
#include "reference/splat_oracle.h"

using namespace sfumato;
using namespace sfumato::testing;

namespace {

/// A square of `count` points at random in the plane y = depth, facing the camera at -Y: a Poisson process.
void add_random_plane(PointCloud& cloud, float depth, Rgba8 color, std::size_t count, float half,
                      unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> across(-half, half);
  for (std::size_t i = 0; i < count; ++i) {
    cloud.positions.push_back({across(random), depth, across(random)});
    cloud.normals.push_back({0, -1, 0});
    cloud.colors.push_back(color);
  }
}

/// A random sampling of a sphere with outliers around it, and a random wall behind.
PointCloud random_sphere_and_wall(std::size_t count, std::size_t outliers, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> uniform(-1.4f, 1.4f);
  PointCloud cloud;
  for (std::size_t i = 0; i < count; ++i) {
    const vec3 n = glm::normalize(vec3(normal(random), normal(random), normal(random)));
    cloud.positions.push_back(n);
    cloud.normals.push_back(n);
    cloud.colors.push_back({200, 60, 60, 255});
  }
  add_random_plane(cloud, 1.6f, {60, 60, 200, 255}, count, 2, seed + 1);
  for (std::size_t i = 0; i < outliers; ++i) {
    cloud.positions.push_back({uniform(random), uniform(random), uniform(random)});
    cloud.normals.push_back(glm::normalize(vec3(uniform(random), -1.4f, uniform(random))));
    cloud.colors.push_back({90, 90, 90, 255});
  }
  return cloud;
}

/// What one ray sees: weights of bins, of which one is shown.
struct Ray {
  std::map<long, double> bins;  ///< in units of what a surface needs
  double origin = 0, cosine = 1;
  long chosen = -1;
  bool sure = false;  ///< chosen by its evidence or by agreement, not for want of another
};

constexpr double share = 0.2, peak_share = 0.3;
constexpr long peak_bins = 3;

/// The nearest bin with enough evidence; noise in front of its surface is passed over; else the heaviest.
void choose(Ray& ray) {
  auto weight = [&](long b) { return ray.bins.count(b) ? ray.bins.at(b) : 0.0; };
  for (const auto& [b, enough] : ray.bins) {
    if (enough <= 1) continue;
    double peak = 0;
    for (long k = 0; k <= peak_bins; ++k) peak = std::max(peak, weight(b + k));
    for (ray.chosen = b; weight(ray.chosen) <= std::max(1.0, peak_share * peak);) ++ray.chosen;
    ray.sure = true;
    return;
  }
  double most = 0;
  for (const auto& [b, w] : ray.bins)
    if (w > most) most = w, ray.chosen = b;
}

/// A weak bin in front counts where a third of the opposite pairs of pixels around see their surface pass
/// through it, and more of them than agree with what was chosen. Pairs no farther than a radius, both in
/// front of what was chosen, also count for the bins that go on from either.
std::vector<long> agree(const std::vector<Ray>& rays, const Camera& camera, double bin_size, double radius) {
  std::vector<long> chosen;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      auto at = [&](int u, int v) -> const Ray& { return rays[std::size_t(v * camera.width + u)]; };
      const Ray& ray = at(x, y);
      chosen.push_back(ray.chosen);
      if (ray.bins.empty() || ray.chosen == 0) continue;
      const double px = std::max(1.0, radius * camera.intrinsics().fy / (ray.origin * ray.cosine));
      struct Pair {
        double between, one, two;  // where bins would begin, in bin sizes
        bool about_a_seam;
      };
      std::vector<Pair> places;
      int seen = 0;
      for (double factor : {0.5, 1.0, 2.0}) {
        const int far = int(std::ceil(factor * px)), diagonal = (7 * far + 9) / 10;
        for (auto [dx, dy] : {std::pair{far, 0}, {0, far}, {diagonal, diagonal}, {diagonal, -diagonal}}) {
          if (std::min({x - dx, x + dx, y - dy, y + dy}) < 0 || std::max(x + dx, x - dx) >= camera.width ||
              std::max(y + dy, y - dy) >= camera.height)
            continue;
          ++seen;
          const Ray &one = at(x + dx, y + dy), &two = at(x - dx, y - dy);
          if (!one.sure || !two.sure) continue;
          const double a = one.origin + bin_size * double(one.chosen + 1),
                       b = two.origin + bin_size * double(two.chosen + 1);
          auto place = [&](double t) { return (t - ray.origin) / bin_size - 1; };
          const double in_front = double(ray.chosen - peak_bins);
          places.push_back({place(2 / (1 / a + 1 / b)), place(a), place(b),
                            factor <= 1 && place(a) < in_front && place(b) < in_front});
        }
      }
      auto near = [](double place, long b) { return std::abs(place - double(b)) <= 1; };
      auto votes = [&](long b) {
        return std::count_if(places.begin(), places.end(), [&](const Pair& p) { return near(p.between, b); });
      };
      auto votes_of_all = [&](long b) {
        return std::count_if(places.begin(), places.end(), [&](const Pair& p) {
          return near(p.between, b) || (p.about_a_seam && (near(p.one, b) || near(p.two, b)));
        });
      };
      const auto for_chosen = votes(ray.chosen);
      for (const auto& [b, weight] : ray.bins)
        if (b + peak_bins < ray.chosen && ((votes(b) > for_chosen && 3 * votes(b) > seen) ||
                                           (votes_of_all(b) > for_chosen && 2 * votes_of_all(b) >= seen))) {
          chosen.back() = b;
          break;
        }
    }
  return chosen;
}

/// `reaches`: radii of discs that each round of `agree` asks around by.
Image<float> oracle_depth(const PointCloud& cloud, const Camera& asked, double bin_size,
                          const std::vector<double>& reaches) {
  Camera camera = asked;
  camera.fit_depth_range(bounds(cloud));
  const std::vector<OracleSplat> splats = oracle_splats(cloud);
  // Eq. 20 lets four splats cover a place, and each weighs 1/7 on average.
  const double needed = share * 4 / 7;
  std::vector<Ray> rays;
  std::vector<std::vector<OracleHit>> hits_of;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const OracleRay line = oracle_ray(camera, x + 0.5, y + 0.5);
      hits_of.push_back(oracle_hits(line, splats, splat_near(camera)));
      Ray& ray = rays.emplace_back();
      ray.cosine = line.cosine;
      for (const OracleHit& hit : hits_of.back()) {
        if (ray.bins.empty()) ray.origin = hit.t;
        ray.bins[long((hit.t - ray.origin) / bin_size)] += wendland(hit.rho) / needed;
      }
      choose(ray);
    }
  for (double reach : reaches) {
    const std::vector<long> chosen = agree(rays, camera, bin_size, reach);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      rays[i].sure = rays[i].sure || rays[i].chosen != chosen[i];
      rays[i].chosen = chosen[i];
    }
  }
  Image<float> depth(camera.width, camera.height, std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    double weight = 0, t = 0;
    for (const OracleHit& hit : hits_of[i])
      if (long((hit.t - rays[i].origin) / bin_size) == rays[i].chosen) {
        weight += wendland(hit.rho);
        t += wendland(hit.rho) * hit.t;
      }
    if (weight > 0) depth.data()[i] = float(t / weight * rays[i].cosine);
  }
  return depth;
}

class DenoiseAuto : public GlTest {
 protected:
  DenoiseAuto() {
    settings_.transparent = true;
    settings_.shading = Shading::albedo;
  }
  void set(const std::string& name, const std::string& value) { set_parameter(*technique_, name, value); }
  RenderOutput render(const PointCloud& cloud, const Camera& camera) {
    Renderer renderer(context());
    show(renderer, cloud, technique_->needs());
    return renderer.render(*technique_, camera, settings_, all_outputs());
  }
  std::unique_ptr<Technique> technique_ = find_technique("denoise").create();
  RenderSettings settings_;
};

TEST_F(DenoiseAuto, IsTheOraclesEvidenceThresholdAndChoice) {
  for (auto [name, value] : {std::pair{"antialias", "false"},
                             {"clamp_radius", "false"},
                             {"radius_scale", "1"},
                             {"prefilter", "false"},
                             {"bin_size", "0.1"}})
    set(name, value);
  struct Case {
    std::size_t outliers;
    bool uneven;
  };
  for (const auto& [outliers, uneven] : {Case{0, false}, {150, false}, {0, true}}) {
    SCOPED_TRACE(outliers);
    SCOPED_TRACE(uneven ? "uneven" : "even");
    PointCloud cloud = random_sphere_and_wall(3000, outliers, 5);
    // Discs of four times the area of a point, as Eq. 20 makes them for the sphere's density.
    const float radius = 2 * std::sqrt(4.0f / 3000);
    cloud.radii.assign(cloud.size(), radius);
    std::vector<double> reaches{radius, radius};
    if (uneven) {  // of one half of the sphere a quarter of the points: 8 % of all have discs twice as large
      PointCloud thinned;
      for (std::size_t i = 0; i < cloud.size(); ++i) {
        const bool sparse = i < 3000 && cloud.positions[i].x > 0;
        if (sparse && i % 4 != 0) continue;
        thinned.positions.push_back(cloud.positions[i]);
        thinned.normals.push_back(cloud.normals[i]);
        thinned.colors.push_back(cloud.colors[i]);
        thinned.radii.push_back(sparse ? 2 * radius : radius);
      }
      cloud = std::move(thinned);
      reaches.push_back(2 * radius);
    }
    const Camera camera = front_camera(80, 60);
    const RenderOutput out = render(cloud, camera);
    const Image<float> expected = oracle_depth(cloud, camera, 0.1, reaches);
    Image<float> two_rounds = expected;
    if (uneven) two_rounds = oracle_depth(cloud, camera, 0.1, {radius, radius});
    std::size_t different = 0, covered = 0, of_last_round = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const float a = out.depth.data()[i], b = expected.data()[i];
      covered += !std::isinf(b);
      different += !(a == b || std::abs(a - b) < 2e-3f);
      of_last_round += two_rounds.data()[i] != b;
    }
    if (uneven) EXPECT_LT(2 * different, of_last_round);
    // Another bin is shown where a sum lies within a rounding (2^-16 a hit) of the threshold, a hit on the
    // border of a bin, or a rim (of about 10 a pixel) within 1e-4 of a ray; and then the pixels beside may
    // vote otherwise.
    EXPECT_LE(different, expected.size() / 200);
    EXPECT_GT(covered, expected.size() / 2);
  }
}

// A randomly sampled surface has places where few splats meet; the far wall must not show through them.
TEST_F(DenoiseAuto, WallBehindARandomSamplingStaysHidden) {
  for (unsigned seed : {1u, 2u, 3u}) {
    SCOPED_TRACE(seed);
    PointCloud cloud;
    add_random_plane(cloud, 0, {200, 0, 0, 255}, 4000, 1, seed);
    add_random_plane(cloud, 1, {0, 0, 200, 255}, 4000, 1.5f, seed + 10);
    Camera camera = front_camera(128, 128, 3);
    camera.fov_y = glm::radians(30.0);
    const RenderOutput out = render(cloud, camera);
    std::size_t through = 0, pixels = 0;
    for (int y = 8; y < 120; ++y)
      for (int x = 8; x < 120; ++x) {
        ++pixels;
        through += out.color_linear.at(x, y).b > 0.01f || out.color_linear.at(x, y).r == 0;
      }
    EXPECT_LE(through, pixels / 2000) << "0.05 %";
  }
}

// Two surfaces in front of a wall, one of them ending before the other: nothing lies halfway between them.
TEST_F(DenoiseAuto, WallBehindASeamStaysHidden) {
  std::size_t through = 0, pixels = 0;
  for (unsigned seed : {1u, 2u, 3u, 4u, 5u, 6u}) {
    PointCloud whole, cloud;
    add_random_plane(whole, 0, {200, 0, 0, 255}, 4000, 1, seed);
    for (std::size_t i = 0; i < whole.size(); ++i) {
      const vec3& p = whole.positions[i];
      if (p.x > 0.4f * p.z) continue;
      cloud.positions.push_back(p);
      cloud.normals.push_back(whole.normals[i]);
      cloud.colors.push_back(whole.colors[i]);
    }
    add_random_plane(cloud, 0.3f, {0, 200, 0, 255}, 4000, 1.1f, seed + 10);
    add_random_plane(cloud, 2, {0, 0, 200, 255}, 8000, 2, seed + 20);
    Camera camera = front_camera(128, 128, 3);
    camera.fov_y = glm::radians(30.0);
    const RenderOutput out = render(cloud, camera);
    for (int y = 12; y < 116; ++y)
      for (int x = 40; x < 88; ++x) {
        ++pixels;
        through += out.depth.at(x, y) > 4;
      }
  }
  EXPECT_LE(through, pixels / 2000) << "0.05 %";
}

// Where a scan thins out its discs are larger, and so are the places where few of them meet.
TEST_F(DenoiseAuto, WallBehindASparserPartStaysHidden) {
  std::size_t through = 0, pixels = 0;
  for (unsigned seed : {1u, 2u, 3u, 4u}) {
    PointCloud cloud;
    add_random_plane(cloud, 0, {200, 0, 0, 255}, 30'000, 1, seed);
    PointCloud front;  // a ninth of the points right of the middle
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (cloud.positions[i].x > 0 && i % 9 != 0) continue;
      front.positions.push_back(cloud.positions[i]);
      front.normals.push_back(cloud.normals[i]);
      front.colors.push_back(cloud.colors[i]);
    }
    add_random_plane(front, 1, {0, 0, 200, 255}, 10'000, 1.5f, seed + 10);
    Camera camera = front_camera(256, 256, 3);
    camera.fov_y = glm::radians(30.0);
    const RenderOutput out = render(front, camera);
    for (int y = 16; y < 240; ++y)
      for (int x = 136; x < 240; ++x) {
        ++pixels;
        through += out.color_linear.at(x, y).b > 0.01f || out.color_linear.at(x, y).r == 0;
      }
  }
  // Discs end 8 px from their points (widest_disc_px): of these places, .033 points a px^2, exp(-pi 8^2 .033)
  // = .14 % are farther from every point, and 1.1 % have no second point to agree with.
  EXPECT_LE(through, pixels / 200) << "0.5 %";
}

// Between two walls: a stray pair in front is not agreed upon by the pixels around.
TEST_F(DenoiseAuto, StrictnessTakesAndGivesBack) {
  PointCloud cloud = random_sphere_and_wall(6000, 600, 9);
  auto strays = [&](const char* strictness) {
    set("strictness", strictness);
    const RenderOutput out = render(cloud, front_camera(96, 72));
    std::size_t grey = 0;
    for (const vec4& c : out.color_linear) grey += c.a > 0 && std::abs(c.r - c.b) < 0.02f;
    return grey;
  };
  const std::size_t all = strays("0"), usual = strays("1"), few = strays("3");
  EXPECT_GT(all, 20 * usual);
  EXPECT_LE(few, usual);
}

}  // namespace
