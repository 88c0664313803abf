// `layers` against every crossing of every ray: `make eval-layers`.
//
//   eval_layers [--set NAME=VALUE]... [--points N] [--noise SIGMA] [--map FILE.png]
//
// Nested tori, points scattered at random, in the default view at 640 x 480: how many layers each pixel
// shows, and what those are that should not be there. Then two surfaces, one behind the other.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "analysis/prepare.h"
#include "core/error.h"
#include "io/io.h"
#include "io/image_png.h"
#include "options.h"
#include "set_parameter.h"
#include "synth/random.h"
#include "synth/synth.h"
#include "techniques/renderer.h"

using namespace sfumato;
using sfumato::bench::set;

namespace {

struct Arguments {
  std::vector<std::pair<std::string, std::string>> values;
  std::vector<int> points{300'000, 3'000'000};
  std::string map;
  float noise = 0;  ///< standard deviation along the normal, scene units
};

constexpr int most_layers = 13;

/// Depths of all layers of every pixel, front to back.
using Stacks = Image<std::vector<double>>;

/// The rays through the middles of a picture's pixels.
class Rays {
 public:
  explicit Rays(const Camera& camera)
      : eye_(camera.position), k_(camera.intrinsics()), world_(camera.inverse_view()) {}
  /// To what lies one unit of depth away, in eye space.
  dvec3 slope(int x, int y) const { return {(x + 0.5 - k_.cx) / k_.fx, -(y + 0.5 - k_.cy) / k_.fy, -1}; }
  synth::Ray through(int x, int y) const {
    return {eye_, glm::normalize(dvec3(world_ * glm::dvec4(slope(x, y), 0)))};
  }

 private:
  dvec3 eye_;
  Intrinsics k_;
  dmat4 world_;
};

Stacks true_stacks(const synth::Scene& scene, const Camera& camera) {
  const Rays rays(camera);
  Stacks stacks(camera.width, camera.height);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x)
      for (const synth::Hit& hit : scene.intersect_all(rays.through(x, y)))
        stacks.at(x, y).push_back(hit.t / glm::length(rays.slope(x, y)));
  return stacks;
}

Stacks found_stacks(Renderer& renderer, const Camera& camera, const Arguments& arguments) {
  Stacks stacks(camera.width, camera.height);
  RenderSettings settings;
  settings.transparent = true;
  settings.shading = Shading::albedo;
  RenderWants wants;
  wants.depth = true;
  for (int layer = 1; layer <= most_layers; ++layer) {
    const auto technique = find_technique("layers").create();
    set(*technique, "layers", std::to_string(most_layers));
    set(*technique, "show_layer", std::to_string(layer));
    for (const auto& [name, value] : arguments.values) set(*technique, name, value);
    const RenderOutput out = renderer.render(*technique, camera, settings, wants);
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x)
        if (!std::isinf(out.depth.at(x, y))) stacks.at(x, y).push_back(out.depth.at(x, y));
  }
  return stacks;
}

/// What a pixel's layers are, told by the nearest crossing of its own ray, and of those of the eight and of
/// the forty-eight pixels around it, within `tolerance`.
struct Verdict {
  int missing_merged = 0;              ///< crossings without a layer, whose partner at a silhouette has one
  int missing = 0;                     ///< other crossings without a layer
  int reaching_1 = 0, reaching_3 = 0;  ///< layers that only a pixel next to this one, or up to 3 px away, has
  int split = 0;                       ///< second layers of one crossing
  int floating = 0;                    ///< layers that nothing explains
};

Verdict judge(const Stacks& truth, int x, int y, const std::vector<double>& found, double tolerance) {
  Verdict v;
  const std::vector<double>& expected = truth.at(x, y);
  std::vector<int> taken(expected.size());
  for (const double depth : found) {
    int best = -1;
    for (std::size_t i = 0; i < expected.size(); ++i)
      if (std::abs(expected[i] - depth) < tolerance &&
          (best < 0 || (taken[i] == 0) > (taken[std::size_t(best)] == 0) ||
           ((taken[i] == 0) == (taken[std::size_t(best)] == 0) &&
            std::abs(expected[i] - depth) < std::abs(expected[std::size_t(best)] - depth))))
        best = int(i);
    if (best >= 0 && taken[std::size_t(best)]++ == 0) continue;
    if (best >= 0) {
      ++v.split;
      continue;
    }
    int reach = 99;
    for (int dy = -3; dy <= 3; ++dy)
      for (int dx = -3; dx <= 3; ++dx) {
        if (x + dx < 0 || y + dy < 0 || x + dx >= truth.width() || y + dy >= truth.height()) continue;
        for (const double there : truth.at(x + dx, y + dy))
          if (std::abs(there - depth) < tolerance)
            reach = std::min(reach, std::max(std::abs(dx), std::abs(dy)));
      }
    if (reach <= 1)
      ++v.reaching_1;
    else if (reach <= 3)
      ++v.reaching_3;
    else
      ++v.floating;
  }
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (taken[i]) continue;
    const bool before = i > 0 && taken[i - 1] && expected[i] - expected[i - 1] < 4 * tolerance;
    const bool after =
        i + 1 < expected.size() && taken[i + 1] && expected[i + 1] - expected[i] < 4 * tolerance;
    if (before || after)
      ++v.missing_merged;
    else
      ++v.missing;
  }
  return v;
}

void evaluate(Renderer& renderer, const synth::Scene& scene, int points, bool with_normals,
              const Arguments& arguments) {
  synth::SampleOptions options;
  options.points = points;
  options.seed = 7;
  options.sigma = arguments.noise;
  options.normals.user = with_normals;
  const auto plain = find_technique("layers").create();
  for (const auto& [name, value] : arguments.values) set(*plain, name, value);
  PreparedCloud prepared = analysis::prepare(synth::sample(scene, options), plain->needs(), {});
  const Camera camera =
      frame(bounds(prepared.cloud), prepared.cloud.up, 640, 480, glm::radians(-45.0), glm::radians(30.0));
  const double pixel = glm::length(camera.position - camera.target) / camera.pixels_per_unit();
  const double spacing = prepared.median_spacing;
  std::vector<Rgba8> colors(prepared.cloud.size(), Rgba8{180, 180, 180, 255});
  renderer.set_cloud(std::move(prepared), std::move(colors));
  const Stacks truth = true_stacks(scene, camera), found = found_stacks(renderer, camera, arguments);

  // As far as a layer's depth may be from a ray that grazes it: what two pixels of it differ by.
  const double tolerance = 3 * spacing + 3 * pixel;
  int all = 0, right = 0, away = 0, away_right = 0, more = 0, fewer = 0, background = 0;
  Verdict sum;
  Image<Rgba8> map(camera.width, camera.height);
  for (int y = 2; y < camera.height - 2; ++y)
    for (int x = 2; x < camera.width - 2; ++x) {
      const std::size_t count = truth.at(x, y).size(), shown = found.at(x, y).size();
      map.at(x, y) = {255, 255, 255, 255};
      if (count == 0 && shown == 0) continue;
      bool is_away = true;
      for (int v = -2; v <= 2; ++v)
        for (int u = -2; u <= 2; ++u) is_away = is_away && truth.at(x + u, y + v).size() == count;
      ++all, right += shown == count, away += is_away, away_right += is_away && shown == count;
      more += shown > count, fewer += shown < count, background += count == 0;
      const std::uint8_t grey = std::uint8_t(220 - 8 * int(count));
      map.at(x, y) = {grey, grey, grey, 255};
      if (shown == count) continue;
      map.at(x, y) = shown > count ? Rgba8{230, 60, 40, 255} : Rgba8{40, 80, 230, 255};
      const Verdict v = judge(truth, x, y, found.at(x, y), tolerance);
      sum.missing_merged += v.missing_merged > 0, sum.missing += v.missing > 0, sum.split += v.split > 0;
      sum.reaching_1 += v.reaching_1 > 0, sum.reaching_3 += v.reaching_3 > 0, sum.floating += v.floating > 0;
    }
  const auto percent = [&](int n) { return 100.0 * n / all; };
  std::printf(
      "| %d %s, %.2f px (%.4f) | %.1f | %.1f | %.1f | %.1f | %.1f | %.1f | %.1f | %.1f | %.1f | %.1f | %.1f "
      "|\n",
      points, with_normals ? "with" : "without", spacing / pixel, spacing, 100.0 * away_right / away,
      percent(right), percent(more), percent(fewer), percent(background), percent(sum.missing_merged),
      percent(sum.missing), percent(sum.reaching_1), percent(sum.reaching_3), percent(sum.split),
      percent(sum.floating));
  std::fflush(stdout);
  if (!arguments.map.empty()) {
    std::string file = arguments.map;
    file.insert(file.rfind('.'), "_" + std::to_string(points) + (with_normals ? "_normals" : ""));
    io::write_png(file, map, false);
  }
}

/// Two surfaces one behind the other, a known number of spacings apart: a plane of even density, or a funnel
/// of which the density falls with the square of the distance, as a scanner leaves it. Points at random.
struct Pair {
  bool falls = false;
  double gap = 3;    ///< local spacings
  double noise = 0;  ///< deviations along z, local spacings
  static constexpr double spacing_of_radius = 0.02, innermost = 0.05;
  static constexpr double even_spacing = 0.01;
  double spacing_at(double radius) const { return falls ? spacing_of_radius * radius : even_spacing; }
  double height(int sheet, double radius) const { return -sheet * gap * spacing_at(radius); }
};

PointCloud sampled(const Pair& pair) {
  synth::Random random(5, synth::Stream::area, 0);
  PointCloud cloud;
  const double turn = 2 * std::numbers::pi, steep = std::log(1 / Pair::innermost);
  const double area = pair.falls ? turn * steep / (Pair::spacing_of_radius * Pair::spacing_of_radius)
                                 : 4 / (Pair::even_spacing * Pair::even_spacing);
  for (int sheet = 0; sheet < 2; ++sheet)
    for (std::size_t i = 0; i < std::size_t(area); ++i) {
      glm::dvec2 at(2 * random.uniform() - 1, 2 * random.uniform() - 1);
      if (pair.falls) {
        const double radius = Pair::innermost * std::exp(steep * random.uniform()),
                     angle = turn * random.uniform();
        at = radius * glm::dvec2(std::cos(angle), std::sin(angle));
      }
      const double radius = glm::length(at);
      const double z = pair.height(sheet, radius) + pair.noise * pair.spacing_at(radius) * random.gaussian();
      cloud.positions.emplace_back(vec3(dvec3(at, z)));
    }
  return cloud;
}

/// Where a ray from above meets a sheet, as a distance from the axis; -1 outside.
double radius_where(const Pair& pair, int sheet, const synth::Ray& ray) {
  double near = (0.1 - ray.origin.z) / ray.direction.z, far = (-0.5 - ray.origin.z) / ray.direction.z;
  for (int step = 0; step < 50; ++step) {
    const double t = 0.5 * (near + far);
    const dvec3 p = ray.origin + t * ray.direction;
    (p.z > pair.height(sheet, glm::length(glm::dvec2(p))) ? near : far) = t;
  }
  const dvec3 p = ray.origin + near * ray.direction;
  const double radius = glm::length(glm::dvec2(p)), margin = 8 * pair.spacing_at(radius);
  const bool inside = pair.falls ? radius > Pair::innermost + margin && radius < 1 - margin
                                 : std::max(std::abs(p.x), std::abs(p.y)) < 1 - margin;
  return inside ? radius : -1;
}

void evaluate_pair(Renderer& renderer, const Pair& pair, const Arguments& arguments) {
  constexpr int looked_for = 4;
  const auto plain = find_technique("layers").create();
  PreparedCloud prepared = analysis::prepare(sampled(pair), plain->needs(), {});
  const Camera camera =
      frame(bounds(prepared.cloud), UpAxis::pos_z, 640, 480, glm::radians(-45.0), glm::radians(60.0));
  std::vector<Rgba8> colors(prepared.cloud.size(), Rgba8{180, 180, 180, 255});
  renderer.set_cloud(std::move(prepared), std::move(colors));
  Arguments own = arguments;
  own.values.emplace_back("layers", std::to_string(looked_for));
  const Stacks found = found_stacks(renderer, camera, own);
  const Rays rays(camera);
  int all = 0, merged = 0, more = 0;
  double pixels = 0;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const synth::Ray ray = rays.through(x, y);
      const double upper = radius_where(pair, 0, ray);
      if (upper < 0 || radius_where(pair, 1, ray) < 0) continue;
      const std::size_t count = found.at(x, y).size();
      ++all;
      if (count < 2) ++merged;
      if (count > 2) ++more;
      pixels += pair.spacing_at(upper);
    }
  const double pixel = glm::length(camera.position - camera.target) / camera.pixels_per_unit();
  std::printf("| %s | %.1f | %.2f | %.1f | %.1f | %.1f | %.1f |\n", pair.falls ? "falls" : "even", pair.gap,
              pair.noise, pixels / all / pixel, 100.0 * (all - merged - more) / all, 100.0 * merged / all,
              100.0 * more / all);
  std::fflush(stdout);
}

Arguments parse(int argc, char** argv) {
  Arguments a;
  bench::Options options;
  options.value("points", [&](const std::string& word) { a.points = {std::stoi(word)}; });
  options.value("noise", [&](const std::string& word) { a.noise = std::stof(word); });
  options.value("map", a.map).pairs("set", a.values);
  if (!options.parse(argc, argv).empty()) throw Error(ErrorCode::usage, "unexpected words");
  return a;
}

}  // namespace

int main(int argc, char** argv) try {
  const Arguments arguments = parse(argc, argv);
  const auto context = gl::Context::create_headless();
  Renderer renderer(*context);
  const synth::Scene scene = synth::make_scene("tori");
  std::printf(
      "| points, normals, median spacing | right away from silhouettes, %% | right everywhere | more | fewer "
      "| of "
      "background | merged | missing | reaching 1 px | reaching 3 px | split | floating |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (bool with_normals : {true, false})
    for (int points : arguments.points) evaluate(renderer, scene, points, with_normals, arguments);
  std::printf(
      "\n| density | gap, spacings | noise, spacings | spacing, px | two layers, %% | one | more |\n"
      "|---|---|---|---|---|---|---|\n");
  for (const bool falls : {false, true}) {
    for (const double gap : {2, 3, 4, 6, 8, 12}) evaluate_pair(renderer, {falls, gap, 0}, arguments);
    for (const double noise : {0.25, 0.5, 1.0}) evaluate_pair(renderer, {falls, 12, noise}, arguments);
  }
} catch (const Error& error) {
  std::fprintf(stderr, "eval_layers: %s\n", error.what());
  return 1;
}
