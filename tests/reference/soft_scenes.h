// What the tests of soft transparency share: clouds of spheres and the technique with plain settings.
#pragma once

#include "reference/gl_fixture.h"
#include "reference/soft_oracle.h"
#include "reference/splat_oracle.h"

namespace sfumato::testing {

struct Ball {
  vec3 center{0};
  float radius = 0.5f;
  Rgba8 color{200, 100, 50, 255};
  float field = 1;
  vec3 normal{0, -1, 0};
};

inline PointCloud cloud_of(const std::vector<Ball>& balls, double scale = 1) {
  PointCloud cloud;
  ScalarField field{"soft", 0, {}};
  for (const Ball& ball : balls) {
    cloud.positions.push_back(ball.center * float(scale));
    cloud.normals.push_back(ball.normal);
    cloud.radii.push_back(ball.radius * float(scale));
    cloud.colors.push_back(ball.color);
    field.values.push_back(ball.field);
  }
  cloud.set_scalar(std::move(field));
  return cloud;
}

/// Spheres of all sizes and colours in a ball of radius 1.
inline std::vector<Ball> ball_soup(int count, unsigned seed, float largest = 0.5f) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(-1, 1);
  auto code = [&] { return std::uint8_t(127.5f + 127.5f * uniform(random)); };
  std::vector<Ball> balls;
  while (int(balls.size()) < count) {
    const vec3 p(uniform(random), uniform(random), uniform(random));
    if (glm::length(p) > 1) continue;
    balls.push_back({p, largest * (0.3f + 0.7f * std::abs(uniform(random))), {code(), code(), code(), 255}});
  }
  return balls;
}

inline double lambda_of(double opacity) { return -std::log(1 - std::min(opacity, 0.999)); }

class SoftTest : public GlTest {
 protected:
  SoftTest() {
    settings_.transparent = true;
    settings_.shading = Shading::albedo;
    for (auto [name, value] : {std::pair{"field", "soft"},
                               {"field_threshold", "0.5"},
                               {"modulation_threshold", "0.5"},
                               {"antialias", "false"},
                               {"clamp_radius", "false"},
                               {"epsilon", "0.01"},
                               {"radius_scale", "1"}})
      set(name, value);
  }
  void set(const std::string& name, const std::string& value) { set_parameter(*technique_, name, value); }
  void set_opacity(double value) { set("opacity", std::to_string(value)); }
  RenderOutput render(const PointCloud& cloud, const Camera& camera) {
    Renderer renderer(context());
    show(renderer, cloud, technique_->needs());
    return renderer.render(*technique_, camera, settings_, all_outputs());
  }
  RenderOutput render(const std::vector<Ball>& balls, const Camera& camera) {
    return render(cloud_of(balls), camera);
  }

  /// Alpha of the picture minus expected(delta) over the whole disc of a lone sphere: the largest difference.
  template <class Expected>
  double lone_sphere_error(const Ball& ball, const Camera& camera, Expected expected) {
    const RenderOutput out = render({ball}, camera);
    double worst = 0;
    int covered = 0;
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const OracleRay ray = oracle_ray(camera, x + 0.5, y + 0.5);
        const dvec3 away = dvec3(ball.center) - ray.origin;
        const double delta = glm::length(away - glm::dot(away, ray.direction) * ray.direction) / ball.radius;
        covered += delta < 1;
        worst = std::max(worst, std::abs(out.color_linear.at(x, y).a - (delta < 1 ? expected(delta) : 0.0)));
      }
    EXPECT_GT(covered, 50);
    return worst;
  }
  /// The picture against the oracle with these spheres; colours are 16-bit floats (5e-4), alpha is not.
  void expect_like_oracle(const std::vector<Ball>& balls, const Camera& asked, const SoftOracle& oracle,
                          double alpha_tolerance = 1e-4) {
    const PointCloud cloud = cloud_of(balls);
    const RenderOutput out = render(cloud, asked);
    Camera camera = asked;
    camera.fit_depth_range(bounds(cloud));
    std::vector<OracleSplat> solid;
    std::vector<OracleSphere> soft;
    const std::vector<OracleSplat> all = oracle_splats(cloud);
    for (std::size_t i = 0; i < balls.size(); ++i)
      if (balls[i].field > 0.5f)
        soft.push_back({all[i].center, all[i].radius, all[i].color});
      else
        solid.push_back(all[i]);
    double worst_alpha = 0, worst_color = 0;
    int covered = 0;
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const OracleRay ray = oracle_ray(camera, x + 0.5, y + 0.5);
        const OracleSurface surface = oracle_surface(ray, solid, splat_near(camera), 0.01, wendland);
        if (surface.fragile) continue;
        const std::vector<OracleHit> hits = oracle_hits(ray, solid, splat_near(camera));
        const double solid_t = hits.empty() ? HUGE_VAL : hits.front().t;
        glm::dvec4 color = oracle.through(ray, soft, splat_near(camera) / ray.cosine, solid_t);
        if (surface.weight > 0) color += (1 - color.a) * glm::dvec4(surface.color, 1);
        const vec4 actual = out.color_linear.at(x, y);
        covered += color.a > 0;
        worst_alpha = std::max(worst_alpha, std::abs(actual.a - color.a));
        for (int k = 0; k < 3; ++k) worst_color = std::max(worst_color, std::abs(actual[k] - color[k]));
      }
    EXPECT_GT(covered, camera.width * camera.height / 8);
    EXPECT_LT(worst_alpha, alpha_tolerance);
    EXPECT_LT(worst_color, 1e-3);
  }
  std::unique_ptr<Technique> technique_ = find_technique("soft").create();
  RenderSettings settings_;
};

}  // namespace sfumato::testing
