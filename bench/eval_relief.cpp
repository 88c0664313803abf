// The relief of pictures against a ray-traced ambient occlusion: `make eval-relief`.
//
//   eval_relief [--scene forest|courtyard|facade] [--technique NAME] [--output FOLDER]
//
// The oracle casts rays into the scene itself: from what the middles of pixels see, cosine-weighted over the
// hemisphere, as far as they go; what leaves the scene reaches the sky. Scenes are sampled by area, two
// points a square of 4 x 4 px on average and more, and drawn in one colour without light. What is compared
// are means of such squares: the darkening of the picture with the openness that was traced (correlation of
// Pearson), beside it the range of lightness of the same picture lit as it is by default (L*, quantiles of 5
// and 95 %) and the processor time of both.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "analysis/prepare.h"
#include "core/error.h"
#include "io/image_png.h"
#include "options.h"
#include "processor_time.h"
#include "synth/builder.h"
#include "synth/parallel.h"
#include "synth/synth.h"
#include "techniques/renderer.h"

using namespace sfumato;

namespace {

constexpr int side = 4;  // px of a square
constexpr Rgba8 clay{201, 184, 163, 255};

/// A house front on a street: windows in their reveals, sills, a door, a ledge, a cornice, and a car before
/// it.
synth::Scene make_facade() {
  synth::Builder b("facade");
  const synth::Finish stone{b.material({}), synth::class_building};
  std::vector<synth::Opening> openings;
  for (int storey = 0; storey < 3; ++storey)
    for (int k = 0; k < 5; ++k) {
      const double x = -8 + 4.0 * k, z = 1.2 + 3.4 * storey;
      const bool is_door = storey == 0 && k == 2;
      const synth::Opening o{x - 0.7, x + 0.7, is_door ? 0.1 : z, z + 1.8, is_door};
      openings.push_back(o);
      b.reveal(o, 0, 0.35, stone);
      b.wall(o.x_min, o.x_max, o.y_min, o.y_max + (is_door ? 0.7 : 0), 0.35, -1, stone);
      if (!is_door) b.box({o.x_min - 0.1, -0.15, z - 0.12}, {o.x_max + 0.1, 0, z}, stone);
    }
  b.wall(-10, 10, 0, 11, 0, -1, stone, openings);
  b.box({-10, -0.12, 4.05}, {10, 0, 4.25}, stone);
  b.box({-10, -0.5, 10.7}, {10, 0, 11}, stone);
  b.floor(-10, 10, -8, 0, 0, stone);
  b.box({-10, -2.2, 0}, {10, -2, 0.15}, stone);
  b.box({-6, -5.4, 0.35}, {-2, -3.7, 0.9}, stone);
  b.box({-5.2, -5.2, 0.9}, {-2.8, -3.9, 1.5}, stone);
  b.scene.build();
  return b.scene;
}

struct SceneView {
  std::string name;
  synth::Scene scene;
  Camera camera;
  synth::Truth truth;
  Image<float> openness;  ///< of squares; below 0 where nothing is seen
};

/// What a place sees of the sky, of 64 directions: around a normal by their cosine, as a surface is lit;
/// without one in all directions alike, the mean of every normal.
double openness_of(const synth::Scene& scene, dvec3 place, dvec3 normal, std::uint64_t seed) {
  constexpr int across = 8;
  synth::Random random(17, synth::Stream::layout, seed);
  const bool is_surface = normal != dvec3(0);
  const dvec3 z = is_surface ? normal : dvec3(0, 0, 1), x = synth::any_normal_to(z), y = glm::cross(z, x);
  const dvec3 origin = place + 1e-4 * scene.box.diagonal() * normal;
  int open = 0;
  for (int row = 0; row < across; ++row)
    for (int column = 0; column < across; ++column) {
      const double u = (column + random.uniform()) / across,
                   angle = 2 * M_PI * (row + random.uniform()) / across;
      const double height = is_surface ? std::sqrt(1 - u) : 1 - u, r = std::sqrt(1 - height * height);
      const dvec3 towards = r * std::cos(angle) * x + r * std::sin(angle) * y + height * z;
      open += !scene.intersect({origin, glm::normalize(towards)}, 1e-4 * scene.box.diagonal());
    }
  return double(open) / (across * across);
}

SceneView make_view(const std::string& name, int width, int height, int places) {
  const bool is_facade = name == "facade";
  SceneView v{name, is_facade ? make_facade() : synth::make_scene(name), {}, {}, {}};
  v.camera = frame(v.scene.box, v.scene.up, width, height, glm::radians(is_facade ? 25.0 : -45.0),
                   glm::radians(is_facade ? 20.0 : 35.0));
  v.camera.fov_y *= 0.6;  // of outliers and air there are none
  v.truth = synth::truth(v.scene, v.camera);
  v.openness = Image<float>(width / side, height / side, -1);
  const dmat4 world_from_eye = glm::inverse(v.camera.view());
  const Intrinsics k = v.camera.intrinsics();
  synth::parallel_blocks(
      v.openness.size(), 64, no_progress(), "rays", [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          double sum = 0;
          int seen = 0;
          for (int part = 0; part < places; ++part) {  // of its 16 pixels four
            const int px = side * int(i % std::size_t(width / side)) + 2 * (part % 2),
                      py = side * int(i / std::size_t(width / side)) + 2 * (part / 2) + part % 2;
            const double depth = v.truth.depth.at(px, py);
            if (std::isinf(depth)) continue;
            const dvec3 place(world_from_eye * glm::dvec4((px + 0.5 - k.cx) / k.fx * depth,
                                                          -(py + 0.5 - k.cy) / k.fy * depth, -depth, 1));
            // Leaves are smaller than a pixel: which way one of them lies is nothing that a picture shows.
            const std::uint8_t kind = v.truth.class_id.at(px, py);
            const bool is_leaf = kind == synth::class_low_vegetation || kind == synth::class_high_vegetation;
            const dvec3 normal = is_leaf ? dvec3(0) : dvec3(v.truth.normal.at(px, py));
            sum += openness_of(v.scene, place, normal, 4 * i + std::uint64_t(part));
            ++seen;
          }
          if (seen == places) v.openness.data()[i] = float(sum / seen);
        }
      });
  return v;
}

/// Of four by four squares, where half of them are known.
class Means {
 public:
  explicit Means(const Image<float>& squares)
      : sums_((squares.width() + 3) / 4, (squares.height() + 3) / 4) {}
  void add(int x, int y, double value) { sums_.at(x / 4, y / 4) += glm::dvec2(value, 1); }
  std::vector<double> values() const {
    std::vector<double> means;
    for (std::size_t i = 0; i < sums_.size(); ++i)
      if (const glm::dvec2 sum = sums_.data()[i]; sum.y >= 8) means.push_back(sum.x / sum.y);
    return means;
  }

 private:
  Image<glm::dvec2> sums_;
};

double lightness(double luminance) {  // L* of CIE 1976
  return luminance > 216.0 / 24389 ? 116 * std::cbrt(luminance) - 16 : luminance * 24389 / 27;
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  double mean_a = 0, mean_b = 0, aa = 0, bb = 0, ab = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    mean_a += a[i] / double(a.size()), mean_b += b[i] / double(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double x = a[i] - mean_a, y = b[i] - mean_b;
    aa += x * x, bb += y * y, ab += x * y;
  }
  return ab / std::sqrt(std::max(aa * bb, 1e-30));
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return NAN;
  const auto at = values.begin() + std::ptrdiff_t(share * double(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

void compare(gl::Context& context, const SceneView& view, const PointCloud& cloud, const std::string& name,
             const std::string& folder, int repeats) {
  Renderer renderer(context);
  const auto technique = find_technique(name).create();
  PreparedCloud prepared = analysis::prepare(cloud, technique->needs(), {});
  std::vector<Rgba8> colors(prepared.cloud.size(), clay);
  renderer.set_cloud(std::move(prepared), std::move(colors));
  RenderSettings lit;
  lit.photographed = false;
  lit.ambient_occlusion.user = RenderSettings::usual_occlusion;
  lit.edl_strength.user = technique->edl_strength(false);
  RenderSettings flat = lit, bare = lit;
  flat.phong.ambient.user = 1, flat.phong.diffuse.user = flat.phong.specular.user = 0;
  bare.edl.user = false, bare.ambient_occlusion.user = 0;
  RenderWants wants;
  wants.color_linear = wants.depth = true;
  const auto drawn = [&](const RenderSettings& settings, double& ms) {
    RenderOutput out = renderer.render(*technique, view.camera, settings, wants);
    const double before = bench::cpu_ms();
    for (int k = 0; k < repeats; ++k) out = renderer.render(*technique, view.camera, settings, wants);
    ms = (bench::cpu_ms() - before) / repeats;
    return out;
  };
  double flat_ms = 0, lit_ms = 0, bare_ms = 0;
  const RenderOutput relief = drawn(flat, flat_ms), picture = drawn(lit, lit_ms),
                     plain = drawn(bare, bare_ms);
  std::vector<double> traced, shown, lights;
  Means crowns_traced(view.openness), crowns_shown(view.openness);
  for (int y = 0; y < view.openness.height(); ++y)
    for (int x = 0; x < view.openness.width(); ++x) {
      if (view.openness.at(x, y) < 0) continue;
      double luminance = 0, light = 0;
      int covered = 0;
      for (int k = 0; k < side * side; ++k) {
        const int px = side * x + k % side, py = side * y + k / side;
        if (std::isinf(relief.depth.at(px, py))) continue;
        luminance += double(relief.color_linear.at(px, py).y),
            light += double(picture.color_linear.at(px, py).y);
        ++covered;
      }
      if (2 * covered < side * side) continue;
      traced.push_back(double(view.openness.at(x, y)));
      shown.push_back(luminance / covered);
      lights.push_back(lightness(light / covered));
      crowns_traced.add(x, y, traced.back()), crowns_shown.add(x, y, shown.back());
    }
  const double low = quantile(lights, 0.05), high = quantile(lights, 0.95);
  std::printf(
      "%-10s %-8s correlation %5.2f, of 16 px %5.2f   L* %4.1f to %4.1f, range %4.1f   relief %5.1f ms of "
      "%6.1f\n",
      view.name.c_str(), name.c_str(), correlation(traced, shown),
      correlation(crowns_traced.values(), crowns_shown.values()), low, high, high - low, lit_ms - bare_ms,
      lit_ms);
  if (folder.empty()) return;
  const std::string stem = folder + "/" + view.name + "_" + name;
  io::write_png(stem + ".png", picture.rgba8, false);
  io::write_png(stem + "_relief.png", relief.rgba8, false);
}

}  // namespace

int main(int count, char** words) try {
  std::string scene, technique, folder;
  bool is_quick = false;
  bench::Options()
      .flag("quick", is_quick)
      .value("scene", scene)
      .value("technique", technique)
      .value("output", folder)
      .parse(count, words);
  if (!folder.empty()) std::filesystem::create_directories(folder);
  const auto context = gl::Context::create_headless();
  for (const std::string name : {"forest", "courtyard", "facade"}) {
    if (!scene.empty() && scene != name) continue;
    const SceneView view = make_view(name, 960, 540, is_quick ? 1 : 4);
    synth::SampleOptions options;
    options.points = 1'000'000;
    options.sampling = synth::Sampling::area;
    options.normals.user = false;
    const PointCloud cloud = synth::sample(view.scene, options);
    if (!folder.empty()) {
      Image<Rgba8> truth(view.openness.width(), view.openness.height(), Rgba8{255, 255, 255, 255});
      for (std::size_t i = 0; i < truth.size(); ++i)
        if (const float open = view.openness.data()[i]; open >= 0)
          truth.data()[i] = synth::to_srgb(vec3(open));
      io::write_png(folder + "/" + name + "_traced.png", truth, false);
    }
    for (const std::string each : {"splats", "surface", "points", "denoise"})
      if (technique.empty() || technique == each)
        compare(*context, view, cloud, each, folder, is_quick ? 1 : 3);
  }
  return 0;
} catch (const std::exception& problem) {
  std::fprintf(stderr, "eval_relief: %s\n", problem.what());
  return 1;
}
