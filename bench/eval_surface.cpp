// `surface` and `splats` against what is really there: `make eval-surface`.
//
//   eval_surface [--part truth|noise|phase|gap|orbit] [--technique NAME] [--set NAME=VALUE]...
//                [--data FOLDER] [--scene TEXT]
//
// Scenes are sampled by area at random, without normals, so that 2, 3, 6 or 10 px lie between points in the
// middle of the picture. `splats` computes normals from the neighbours in space; `surface` knows nothing
// beforehand.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "analysis/prepare.h"
#include "core/error.h"
#include "io/io.h"
#include "options.h"
#include "set_parameter.h"
#include "synth/synth.h"
#include "techniques/renderer.h"

using namespace sfumato;
using sfumato::bench::set;

namespace {

struct Arguments {
  std::string part = "all", data = "../shared/data", scene;
  std::vector<std::string> techniques{"surface", "splats"};
  std::vector<std::pair<std::string, std::string>> values;
  bool wants(const char* name) const { return part == "all" || part == name; }
};

/// One technique over one cloud after the other.
class Picture {
 public:
  Picture(gl::Context& context, const std::string& name, const Arguments& arguments)
      : renderer_(context), technique_(find_technique(name).create()) {
    settings_.transparent = true;
    settings_.edl.user = false;
    if (name == "surface")
      for (const auto& [key, value] : arguments.values) set(*technique_, key, value);
    wants_.color_linear = wants_.depth = wants_.normal = true;
  }
  void take(const PointCloud& cloud) {
    PreparedCloud prepared = analysis::prepare(cloud, technique_->needs(), {});
    std::vector<Rgba8> colors = prepared.cloud.colors;
    if (colors.empty()) colors.assign(prepared.cloud.size(), Rgba8{180, 180, 180, 255});
    for (Rgba8& c : colors) c.a = 255;
    renderer_.set_cloud(std::move(prepared), std::move(colors));
  }
  RenderOutput at(const Camera& camera) { return renderer_.render(*technique_, camera, settings_, wants_); }

 private:
  Renderer renderer_;
  std::unique_ptr<Technique> technique_;
  RenderSettings settings_;
  RenderWants wants_;
};

double median(std::vector<double>& values) {
  if (values.empty()) return NAN;
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// --- Against the truth
// ---------------------------------------------------------------------------------------------

/// A scene from a view, with the share of each pixel that it covers.
struct View {
  std::string name;
  synth::Scene scene;
  Camera camera;
  synth::Truth truth;
  Image<float> coverage;
  double outline = 0;  ///< length, px
  double area = 0;     ///< of all surfaces, scene units
  double spacing_for(double px) const {
    return px * glm::length(camera.position - camera.target) / camera.pixels_per_unit();
  }
};

View make_view(const std::string& name, synth::Scene scene, int width, int height, double azimuth,
               double elevation) {
  View v{name, std::move(scene), {}, {}, {}, 0, 0};
  v.camera = frame(v.scene.box, v.scene.up, width, height, azimuth, elevation);
  v.camera.fov_y *= 0.6;  // the object fills the picture
  v.camera.fit_depth_range(v.scene.box);
  v.truth = synth::truth(v.scene, v.camera);
  for (std::size_t s = 0; s < v.scene.surface_count(); ++s) v.area += v.scene.surface_area(s);

  // 8 x 8 rays where a pixel's neighbourhood is mixed, in pixel centres elsewhere.
  v.coverage = Image<float>(width, height);
  const Camera fine = v.camera.resized(8 * width, 8 * height);
  const Intrinsics k = fine.intrinsics();
  const dmat4 world_from_eye = fine.inverse_view();
  Image<std::uint8_t> inside(8 * width, 8 * height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const bool here = !std::isinf(v.truth.depth.at(x, y));
      bool mixed = false;
      for (int dy = -2; dy <= 2; ++dy)
        for (int dx = -2; dx <= 2; ++dx)
          if (x + dx >= 0 && y + dy >= 0 && x + dx < width && y + dy < height)
            mixed |= std::isinf(v.truth.depth.at(x + dx, y + dy)) == here;
      int sum = 0;
      for (int j = 8 * y; j < 8 * y + 8; ++j)
        for (int i = 8 * x; i < 8 * x + 8; ++i) {
          bool hit = here;
          if (mixed) {
            const dvec3 slope((i + 0.5 - k.cx) / k.fx, -(j + 0.5 - k.cy) / k.fy, -1);
            hit =
                v.scene
                    .intersect({fine.position, glm::normalize(dvec3(world_from_eye * glm::dvec4(slope, 0)))})
                    .has_value();
          }
          inside.at(i, j) = hit;
          sum += hit;
        }
      v.coverage.at(x, y) = float(sum) / 64;
    }
  // Crossings of the lines of a grid, times pi / 4: the length of a curve of any direction (Cauchy and
  // Crofton).
  double crossings = 0;
  for (int j = 1; j < 8 * height; ++j)
    for (int i = 1; i < 8 * width; ++i)
      crossings += (inside.at(i, j) != inside.at(i - 1, j)) + (inside.at(i, j) != inside.at(i, j - 1));
  v.outline = crossings * M_PI / 4 / 8;
  return v;
}

struct Errors {
  double normal_deg = 0, depth = 0;  ///< medians; depth in spacings
  double deeper = 0, nearer = 0;     ///< shares of the truth's pixels, by more than 5 spacings
  double filled = 0;
  double outline = 0, outwards = 0;  ///< wrong and surplus coverage by length of outline, px
};

Errors measure(const View& v, const RenderOutput& out, double spacing) {
  Errors e;
  std::vector<double> depths, normals;
  std::size_t seen = 0, filled = 0;
  for (int y = 0; y < v.camera.height; ++y)
    for (int x = 0; x < v.camera.width; ++x) {
      const double surplus = double(out.color_linear.at(x, y).a) - v.coverage.at(x, y);
      e.outline += std::abs(surplus), e.outwards += surplus;
      const double expected = v.truth.depth.at(x, y), actual = out.depth.at(x, y);
      if (std::isinf(expected)) continue;
      ++seen;
      if (std::isinf(actual)) continue;
      ++filled;
      e.deeper += actual - expected > 5 * spacing;
      e.nearer += expected - actual > 5 * spacing;
      depths.push_back(std::abs(actual - expected) / spacing);
      const double cosine = glm::dot(out.normal.at(x, y), v.truth.normal.at(x, y));
      normals.push_back(glm::degrees(std::acos(std::clamp(cosine, -1.0, 1.0))));
    }
  e.outline /= v.outline, e.outwards /= v.outline;
  e.filled = double(filled) / double(seen);
  e.deeper /= double(seen), e.nearer /= double(seen);
  e.depth = median(depths), e.normal_deg = median(normals);
  return e;
}

PointCloud sampled(const View& v, double spacing, int seed, double noise = 0) {
  synth::SampleOptions options;
  options.points = int(v.area / (spacing * spacing));
  options.seed = seed;
  options.sigma = float(noise);
  options.sampling = synth::Sampling::area;
  options.normals.user = false;
  return synth::sample(v.scene, options);
}

std::vector<View> make_views(const Arguments& arguments, int width, int height) {
  std::vector<View> views;
  const auto add = [&](const std::string& name, auto make, double azimuth, double elevation) {
    if (name.find(arguments.scene) != std::string::npos)
      views.push_back(make_view(name, make(), width, height, azimuth, elevation));
  };
  add(
      "dragon",
      [&] { return synth::make_mesh_scene(io::read_mesh(arguments.data + "/dragon_vrip_res2.ply")); }, 0.5,
      0.3);
  add(
      "armadillo", [&] { return synth::make_mesh_scene(io::read_mesh(arguments.data + "/armadillo.obj")); },
      2.6, 0.2);
  add(
      "spheres", [] { return synth::make_scene("spheres"); }, -0.7, 0.5);
  add(
      "tori", [] { return synth::make_scene("tori"); }, 0.4, 0.9);
  return views;
}

void against_truth(gl::Context& context, const Arguments& arguments) {
  std::printf(
      "| scene, px between points | technique | normals, deg | depth, spacings | deeper | nearer | filled | "
      "outline off, px | of it outwards |\n"
      "|---|---|---|---|---|---|---|---|---|\n");
  for (const View& v : make_views(arguments, 640, 480))
    for (double px : {2.0, 3.0, 6.0, 10.0}) {
      const double spacing = v.spacing_for(px);
      const PointCloud cloud = sampled(v, spacing, 7);
      for (const std::string& name : arguments.techniques) {
        Picture picture(context, name, arguments);
        picture.take(cloud);
        const Errors e = measure(v, picture.at(v.camera), spacing);
        std::printf("| %s, %g | %s | %.2f | %.3f | %.3f %% | %.2f %% | %.2f %% | %.2f | %+.2f |\n",
                    v.name.c_str(), px, name.c_str(), e.normal_deg, e.depth, 100 * e.deeper, 100 * e.nearer,
                    100 * e.filled, e.outline, e.outwards);
        std::fflush(stdout);
      }
    }
}

/// Points off the surface along its normal, by a normal distribution: what is left of its normals.
void under_noise(gl::Context& context, const Arguments& arguments) {
  constexpr double px = 2;
  const double noises[] = {0, 0.1, 0.3, 0.5, 1, 2};
  std::printf("\n| scene | technique | normals off, deg, by noise in spacings:");
  for (const double noise : noises) std::printf(" %g |", noise);
  std::printf("\n|---|---|---|---|---|---|---|---|\n");
  for (const View& v : make_views(arguments, 640, 480))
    for (const std::string& name : arguments.techniques) {
      std::printf("| %s | %s |", v.name.c_str(), name.c_str());
      for (const double noise : noises) {
        const double spacing = v.spacing_for(px);
        Picture picture(context, name, arguments);
        picture.take(sampled(v, spacing, 7, noise * spacing));
        std::printf(" %.2f |", measure(v, picture.at(v.camera), spacing).normal_deg);
        std::fflush(stdout);
      }
      std::printf("\n");
    }
}

// --- No grid in the outlines
// ---------------------------------------------------------------------------------------

/// How often outlines (of coverage, and jumps of depth of 5 %) stand on the likeliest of the 8 phases of a
/// grid of 8 px, by chance 1.
double likeliest_phase(const std::vector<RenderOutput>& pictures) {
  double counts[2][8] = {};
  for (const RenderOutput& out : pictures)
    for (int y = 1; y < out.depth.height(); ++y)
      for (int x = 1; x < out.depth.width(); ++x)
        for (int axis = 0; axis < 2; ++axis) {
          const float a = out.depth.at(x, y), b = axis ? out.depth.at(x, y - 1) : out.depth.at(x - 1, y);
          const bool edge =
              std::isinf(a) != std::isinf(b) || (!std::isinf(a) && std::abs(a - b) > 0.05f * std::min(a, b));
          counts[axis][(axis ? y : x) % 8] += edge;
        }
  double worst = 0;
  for (const auto& axis : counts) {
    double sum = 0, largest = 0;
    for (double count : axis) sum += count, largest = std::max(largest, count);
    worst = std::max(worst, 8 * largest / std::max(sum, 1.0));
  }
  return worst;
}

void phases(gl::Context& context, const Arguments& arguments) {
  std::printf(
      "\n| scan, as framed by default | technique | likeliest phase of outlines at 600x450, 850x640, "
      "1000x750 |\n|---|---|---|\n");
  for (const char* file :
       {"lion_takanawa.copc.laz", "Guanyin.ply", "armadillo.obj", "office1.pcd", "bcts_3.laz",
        "autzen_trim.las", "car_cloud400.csv", "251370668.pcd", "indoor.laz", "fragment.pcd"}) {
    if (std::string(file).find(arguments.scene) == std::string::npos) continue;
    const io::ReadResult read = io::read(arguments.data + "/" + file);
    for (const std::string& name : arguments.techniques) {
      Picture picture(context, name, arguments);
      picture.take(read.cloud);
      std::printf("| %s | %s |", file, name.c_str());
      for (int width : {600, 850, 1000}) {
        std::vector<RenderOutput> pictures;
        for (double azimuth : {-0.8, 0.9, 2.7})
          pictures.push_back(picture.at(
              frame(robust_bounds(read.cloud), read.cloud.up, width, 3 * width / 4, azimuth, 0.5)));
        std::printf(" %.2f", likeliest_phase(pictures));
      }
      std::printf(" |\n");
      std::fflush(stdout);
    }
  }
}

// --- Gaps and motion
// -----------------------------------------------------------------------------------------------

/// A plane of points with round gaps of several sizes in a row, `seeds` times; the camera pans along it by
/// 0.8 px a frame.
void gaps(gl::Context& context, const Arguments& arguments) {
  std::printf(
      "\n| gap, spacings across | technique | filled share, mean of 24 frames and 4 samples | largest change "
      "a "
      "frame, of each |\n|---|---|---|---|\n");
  constexpr unsigned first_seed = 5, seeds = 4;
  const double spacing = 0.02;  // 4.65 px
  const std::vector<double> gaps{1.5, 2, 3, 4, 4.65, 6, 8, 12};
  const auto middle = [&](std::size_t k) { return (double(k) - 3.5) * 0.42; };
  const auto sampled_plane = [&](unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    PointCloud cloud;
    for (int i = 0; i < int(4 * 2.2 * 0.6 / spacing / spacing); ++i) {
      const double x = 2.2 * uniform(random), z = 0.6 * uniform(random);
      bool open = false;
      for (std::size_t k = 0; k < gaps.size(); ++k)
        open |= std::hypot(x - middle(k), z) < gaps[k] / 2 * spacing;
      if (!open) cloud.positions.push_back(vec3(float(x), 0, float(z)));
    }
    return cloud;
  };
  Camera camera;
  camera.projection = Projection::orthographic;
  camera.width = 880, camera.height = 200;
  camera.height_world = camera.height * spacing / 4.65;
  camera.position = {0, -3, 0}, camera.target = {0, 0, 0};
  const double pixel = camera.height_world / camera.height;
  for (const std::string& name : arguments.techniques) {
    std::vector<double> sums(gaps.size());
    std::vector<std::vector<double>> jumps(gaps.size(), std::vector<double>(seeds));
    for (unsigned seed = 0; seed < seeds; ++seed) {
      Picture picture(context, name, arguments);
      picture.take(sampled_plane(first_seed + seed));
      std::vector<double> last(gaps.size(), -1);
      for (int n = 0; n < 24; ++n) {
        Camera moved = camera;
        moved.position.x += 0.8 * pixel * n, moved.target.x += 0.8 * pixel * n;
        const RenderOutput out = picture.at(moved);
        for (std::size_t k = 0; k < gaps.size(); ++k) {
          int all = 0, filled = 0;
          for (int y = 0; y < camera.height; ++y)
            for (int x = 0; x < camera.width; ++x) {
              const double dx = (x + 0.5 - camera.width / 2) * pixel + moved.target.x - middle(k),
                           dy = (y + 0.5 - camera.height / 2) * pixel;
              if (std::hypot(dx, dy) > gaps[k] / 2 * spacing) continue;
              ++all, filled += out.color_linear.at(x, y).a > 0.5f;
            }
          const double share = double(filled) / std::max(all, 1);
          sums[k] += share / 24 / seeds;
          if (last[k] >= 0) jumps[k][seed] = std::max(jumps[k][seed], std::abs(share - last[k]));
          last[k] = share;
        }
      }
    }
    for (std::size_t k = 0; k < gaps.size(); ++k) {
      std::printf("| %g | %s | %.1f %% |", gaps[k], name.c_str(), 100 * sums[k]);
      for (double jump : jumps[k]) std::printf(" %.1f %%", 100 * jump);
      std::printf(" |\n");
    }
  }
}

void orbits(gl::Context& context, const Arguments& arguments) {
  std::printf(
      "\n| orbit of 0.2 degrees a frame, px between points | technique | change a frame, steps of 255 | "
      "largest |\n|---|---|---|---|\n");
  for (const View& v : make_views(arguments, 320, 240))
    for (double px : {3.0, 6.0}) {
      const PointCloud cloud = sampled(v, v.spacing_for(px), 3);
      for (const std::string& name : arguments.techniques) {
        Picture picture(context, name, arguments);
        picture.take(cloud);
        Image<Rgba8> last;
        double sum = 0, largest = 0;
        const double azimuth = 0.6, elevation = 0.4;
        for (int n = 0; n < 9; ++n) {
          const Camera camera =
              frame(v.scene.box, v.scene.up, 320, 240, azimuth + glm::radians(0.2 * n), elevation);
          const Image<Rgba8> now = picture.at(camera).rgba8;
          double change = 0;
          for (std::size_t i = 0; n > 0 && i < now.size(); ++i) {
            const Rgba8 &a = now.data()[i], &b = last.data()[i];
            const double fa = a.a / 255.0, fb = b.a / 255.0;
            for (auto [p, q] : {std::pair{a.r, b.r}, {a.g, b.g}, {a.b, b.b}})
              change += std::abs(p * fa + 255 * (1 - fa) - q * fb - 255 * (1 - fb)) / 3 / double(now.size());
          }
          if (n > 0) sum += change / 8, largest = std::max(largest, change);
          last = now;
        }
        std::printf("| %s, %g | %s | %.3f | %.3f |\n", v.name.c_str(), px, name.c_str(), sum, largest);
        std::fflush(stdout);
      }
    }
}

Arguments parse(int argc, char** argv) {
  Arguments a;
  bench::Options options;
  options.value("part", a.part).value("data", a.data).value("scene", a.scene).pairs("set", a.values);
  options.value("technique", [&](const std::string& word) { a.techniques = {word}; });
  if (!options.parse(argc, argv).empty()) throw Error(ErrorCode::usage, "unexpected words");
  return a;
}

}  // namespace

int main(int argc, char** argv) try {
  const Arguments arguments = parse(argc, argv);
  const auto context = gl::Context::create_headless();
  if (arguments.wants("truth")) against_truth(*context, arguments);
  if (arguments.wants("noise")) under_noise(*context, arguments);
  if (arguments.wants("phase")) phases(*context, arguments);
  if (arguments.wants("gap")) gaps(*context, arguments);
  if (arguments.wants("orbit")) orbits(*context, arguments);
} catch (const Error& error) {
  std::fprintf(stderr, "eval_surface: %s\n", error.what());
  return 1;
}
