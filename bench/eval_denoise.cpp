// The tables and figures of the technique `denoise` against the truth of synthetic scenes: `make eval-denoise`.
//
//   eval_denoise [--quick] [--choose] [--part noise|views|dragon|orbit] [--row TEXT] [--dragon FILE.ply]
//
// The constants of the automatic threshold were chosen with --choose (other seeds, the scene `courtyard` left out); what
// is reported comes from the rest.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "analysis/prepare.h"
#include "core/error.h"
#include "frame_difference.h"
#include "io/io.h"
#include "synth/synth.h"
#include "techniques/renderer.h"

using namespace sfumato;

namespace {

struct Arguments {
  bool quick = false, choose = false;
  std::string part = "all", row, dragon;
  bool wants(const char* name) const { return part == "all" || part == name; }
};

struct Errors {
  double mae = 0, rmse = 0, missed = 0;  ///< in bin sizes; a miss counts 5, larger errors are clamped there; share
  double psnr = 0, ssim = 0;             ///< of the albedo, sRGB
  void add(const Errors& e, double share) {
    mae += share * e.mae, rmse += share * e.rmse, missed += share * e.missed;
    psnr += share * e.psnr, ssim += share * e.ssim;
  }
};

double luma(const vec3& linear) {
  const double y = 0.2126 * linear.r + 0.7152 * linear.g + 0.0722 * linear.b;
  return y <= 0.0031308 ? 12.92 * y : 1.055 * std::pow(y, 1 / 2.4) - 0.055;
}
double srgb(double c) {
  c = std::min(std::max(c, 0.0), 1.0);
  return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
}

/// Structural similarity (Wang et al. 2004) of the luma over windows of 8 x 8 pixels at every fourth place.
double structural_similarity(const Image<vec4>& a, const Image<vec3>& b) {
  double sum = 0;
  int windows = 0;
  for (int y = 0; y + 8 <= a.height(); y += 4)
    for (int x = 0; x + 8 <= a.width(); x += 4) {
      double ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
      for (int v = y; v < y + 8; ++v)
        for (int u = x; u < x + 8; ++u) {
          const double p = luma(vec3(a.at(u, v))), q = luma(b.at(u, v));
          ma += p / 64, mb += q / 64, aa += p * p / 64, bb += q * q / 64, ab += p * q / 64;
        }
      const double c1 = 1e-4, c2 = 9e-4;
      sum += (2 * ma * mb + c1) * (2 * (ab - ma * mb) + c2) /
             ((ma * ma + mb * mb + c1) * (aa - ma * ma + bb - mb * mb + c2));
      ++windows;
    }
  return windows ? sum / windows : 1;
}

Errors compare(const RenderOutput& out, const synth::Truth& truth, double bin_size) {
  Errors e;
  double squares = 0, color = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < truth.depth.size(); ++i) {
    const float expected = truth.depth.data()[i], actual = out.depth.data()[i];
    if (std::isinf(expected)) continue;
    ++count;
    const double d = std::isinf(actual) ? 5 : std::min(5.0, std::abs(double(actual) - expected) / bin_size);
    e.missed += std::isinf(actual);
    e.mae += d;
    squares += d * d;
    for (int k = 0; k < 3; ++k) {
      const double c = srgb(out.color_linear.data()[i][k]) - srgb(truth.color.data()[i][k]);
      color += c * c / 3;
    }
  }
  const double n = double(std::max<std::size_t>(count, 1));
  e.mae /= n, e.missed /= n;
  e.rmse = std::sqrt(squares / n);
  e.psnr = -10 * std::log10(std::max(color / n, 1e-10));
  e.ssim = structural_similarity(out.color_linear, truth.color);
  return e;
}

void set(Technique& technique, const std::string& name, const std::string& value) {
  ParamList params;
  technique.describe(params);
  params.find(name)->set(value);
}
std::string get(Technique& technique, const std::string& name) {
  ParamList params;
  technique.describe(params);
  return params.find(name)->resolved();
}

/// The three techniques over one cloud; missed pixels are black.
class Contest {
 public:
  explicit Contest(gl::Context& context) : renderer_(context) {
    settings_.shading = Shading::albedo;
    settings_.background = vec3(0);
    wants_.color = wants_.color_linear = wants_.depth = true;
  }
  void take(PointCloud cloud, const Camera& camera) {
    PreparedCloud prepared = analysis::prepare(std::move(cloud), denoise_->needs(), {});
    std::vector<Rgba8> colors = prepared.cloud.colors;
    renderer_.set_cloud(std::move(prepared), std::move(colors));
    set(*denoise_, "bin_size", "auto");
    automatic(camera);
    bin_size_ = std::stod(get(*denoise_, "bin_size"));
  }
  double bin_size() const { return bin_size_; }
  RenderOutput splats(const Camera& camera, bool opaque) {
    set(*splats_, "epsilon", std::to_string(opaque ? 1e-4 * bin_size_ : bin_size_));
    return renderer_.render(*splats_, camera, settings_, wants_);
  }
  RenderOutput manual(const Camera& camera, double threshold) {
    set(*denoise_, "weight_threshold", std::to_string(threshold));
    return renderer_.render(*denoise_, camera, settings_, wants_);
  }
  RenderOutput automatic(const Camera& camera) {
    set(*denoise_, "weight_threshold", "auto");
    return renderer_.render(*denoise_, camera, settings_, wants_);
  }
  void set_denoise(const std::string& name, const std::string& value) { set(*denoise_, name, value); }

 private:
  Renderer renderer_;
  RenderSettings settings_;
  RenderWants wants_;
  double bin_size_ = 1;
  std::unique_ptr<Technique> splats_ = find_technique("splats").create(), denoise_ = find_technique("denoise").create();
};

std::vector<double> manual_thresholds(bool quick) {
  const int count = quick ? 8 : 20;
  std::vector<double> list;
  for (int i = 0; i < count; ++i) list.push_back(0.02 * std::pow(1000.0, double(i) / (count - 1)));  // to 20
  return list;
}

struct Row {
  std::string name, scene;
  synth::SampleOptions options;
  std::vector<Camera> cameras;
};

struct Verdict {
  Errors opaque, ewa, best, automatic;
  double threshold = 0, bin_size = 0;
};

Verdict judge(Contest& contest, const synth::Scene& scene, const Row& row, bool quick) {
  contest.take(synth::sample(scene, row.options), row.cameras[0]);
  Verdict v;
  v.bin_size = contest.bin_size();
  const std::vector<double> thresholds = manual_thresholds(quick);
  std::vector<Errors> manual(thresholds.size());
  for (const Camera& camera : row.cameras) {
    const synth::Truth truth = synth::truth(scene, camera);
    const double share = 1.0 / double(row.cameras.size());
    auto errors = [&](const RenderOutput& out) { return compare(out, truth, v.bin_size); };
    v.opaque.add(errors(contest.splats(camera, true)), share);
    v.ewa.add(errors(contest.splats(camera, false)), share);
    v.automatic.add(errors(contest.automatic(camera)), share);
    for (std::size_t i = 0; i < thresholds.size(); ++i)
      manual[i].add(errors(contest.manual(camera, thresholds[i])), share);
  }
  v.best.mae = 1e9;
  for (std::size_t i = 0; i < manual.size(); ++i)
    if (manual[i].mae < v.best.mae) v.best = manual[i], v.threshold = thresholds[i];
  return v;
}

std::vector<Row> noise_rows(const Arguments& arguments, const std::map<std::string, synth::Scene>& scenes) {
  std::vector<Row> rows;
  auto add = [&](const char* name, const char* scene_name, synth::SampleOptions options) {
    const synth::Scene& scene = scenes.at(scene_name);
    options.seed = arguments.choose ? 11 : 101;
    options.points = arguments.quick ? 60'000 : 120'000;
    const int width = arguments.quick ? 120 : 160, height = width * 3 / 4;
    Row row{name, scene_name, options, {}};
    if (scene.held_out) row.cameras.push_back(scene.held_out->resized(width, height));
    if (!scene.cameras.empty() && !arguments.quick)
      row.cameras.push_back(scene.cameras[arguments.choose ? 4 : 1].resized(width, height));
    if (row.cameras.empty()) row.cameras.push_back(frame(scene.box, scene.up, width, height, glm::radians(-45.0), 0.5));
    rows.push_back(row);
  };
  const std::vector<float> levels = arguments.quick ? std::vector<float>{2} : std::vector<float>{1, 2, 4, 8};
  for (auto [model, name] : {std::pair{synth::NoiseModel::poisson, "z^2 noise"}, {synth::NoiseModel::tof, "time of flight"},
                             {synth::NoiseModel::structured_light, "structured light"}})
    for (float level : levels) {
      synth::SampleOptions o;
      o.noise = model, o.noise_level = level;
      o.flying_pixels = 0.3f, o.outliers = arguments.quick ? 1200 : 2400;  // 2 %
      add((std::string(name) + " x" + std::to_string(int(level))).c_str(), "room", o);
    }
  synth::SampleOptions o;
  o.outliers = arguments.quick ? 3000 : 6000;  // 5 %
  add("outliers 5 %", "room", o);
  o.outliers = 0, o.flying_pixels = 0.5f;
  add("flying pixels 50 %", "room", o);
  if (!arguments.choose) {
    o.outliers = 3000, o.flying_pixels = 0.3f, o.sigma = 0.03f;
    add("scanners, density varies", "courtyard", o);
  } else {
    o.outliers = 1500, o.flying_pixels = 0.3f, o.sigma = 0.005f;
    o.sampling = synth::Sampling::scanners, o.scanner_position = {1.2f, 1, 1.5f};
    add("a scanner in the room, density varies", "room", o);
  }
  return rows;
}

void noise_tables(Contest& contest, const Arguments& arguments) {
  std::map<std::string, synth::Scene> scenes;
  scenes.emplace("room", synth::make_scene("room"));
  if (!arguments.choose) scenes.emplace("courtyard", synth::make_scene("courtyard"));
  std::printf("\nDepth MAE / RMSE in bin sizes (missed %%); PSNR dB / SSIM of the albedo. Missed = 5, clamped at 5.\n\n");
  std::printf("| row | bin size | opaque | EWA | denoise, best T | T | denoise, auto | auto/best |\n");
  std::printf("|---|---|---|---|---|---|---|---|\n");
  int beats = 0, near = 0, count = 0;
  for (const Row& row : noise_rows(arguments, scenes)) {
    if (row.name.find(arguments.row) == std::string::npos) continue;
    const Verdict v = judge(contest, scenes.at(row.scene), row, arguments.quick);
    auto cell = [](const Errors& e) {
      char text[96];
      std::snprintf(text, sizeof text, "%.3f / %.3f (%.1f) %.1f / %.3f", e.mae, e.rmse, 100 * e.missed, e.psnr, e.ssim);
      return std::string(text);
    };
    std::printf("| %s | %.3f | %s | %s | %s | %.2f | %s | %.2f |\n", row.name.c_str(), v.bin_size, cell(v.opaque).c_str(),
                cell(v.ewa).c_str(), cell(v.best).c_str(), v.threshold, cell(v.automatic).c_str(),
                v.automatic.mae / v.best.mae);
    std::fflush(stdout);
    ++count;
    beats += v.automatic.mae < v.ewa.mae;
    near += v.automatic.mae <= 1.1 * v.best.mae;
  }
  std::printf("\nauto beats EWA in %d of %d rows, is within 10 %% of the best manual MAE in %d\n", beats, count, near);
}

void views_table(Contest& contest, const Arguments& arguments) {
  const synth::Scene scene = synth::make_scene("room");
  const Camera camera = scene.cameras[1].resized(160, 120);
  const synth::Truth truth = synth::truth(scene, camera);
  std::printf("\nMissed %% / depth MAE in bin sizes by number of views and T, from a camera of the scan\n\n");
  std::printf("| views | T = .1 | T = .5 | T = 1 | auto |\n|---|---|---|---|---|\n");
  for (int views : {1, 2, 5, 10}) {
    synth::SampleOptions o;
    o.seed = 101, o.noise = synth::NoiseModel::poisson, o.noise_level = 2;
    o.flying_pixels = 0.3f, o.views = views, o.view_width.user = arguments.quick ? 120 : 160;
    contest.take(synth::sample(scene, o), camera);
    std::printf("| %d |", views);
    for (double threshold : {0.1, 0.5, 1.0, -1.0}) {
      const RenderOutput out = threshold < 0 ? contest.automatic(camera) : contest.manual(camera, threshold);
      const Errors e = compare(out, truth, contest.bin_size());
      std::printf(" %.1f / %.3f |", 100 * e.missed, e.mae);
    }
    std::printf("\n");
  }
}

void dragon_figures(Contest& contest, const Arguments& arguments) {
  const synth::Scene scene = synth::make_mesh_scene(io::read_mesh(arguments.dragon));
  const int width = arguments.quick ? 320 : 640, height = width * 3 / 4;
  std::printf("\nDragon, uniform outliers in its box, %dx%d, defaults\n\n", width, height);
  std::printf("| points | outliers | pixels of outliers only that become background | surface pixels kept within 2 bins "
              "| MAE, bins |\n|---|---|---|---|---|\n");
  synth::SampleOptions o;
  o.seed = 101;
  o.points = arguments.quick ? 300'000 : 1'500'000;
  o.outliers = o.points / 12;
  const Camera camera = frame(scene.box, scene.up, width, height, glm::radians(-30.0), glm::radians(20.0));
  const synth::Truth truth = synth::truth(scene, camera);
  contest.take(synth::sample(scene, o), camera);
  const RenderOutput all = contest.splats(camera, false), out = contest.automatic(camera);
  std::size_t stray = 0, removed = 0, surface = 0, kept = 0;
  for (std::size_t i = 0; i < truth.depth.size(); ++i) {
    if (!std::isinf(truth.depth.data()[i])) {
      ++surface;
      kept += std::abs(out.depth.data()[i] - truth.depth.data()[i]) < 2 * contest.bin_size();
    } else if (!std::isinf(all.depth.data()[i])) {
      // Splats of the silhouette reach a little beyond it: a pixel beside the surface is not the outliers' alone.
      const int x = int(i % std::size_t(width)), y = int(i / std::size_t(width));
      bool beside = false;
      for (int v = std::max(0, y - 2); v <= std::min(height - 1, y + 2); ++v)
        for (int u = std::max(0, x - 2); u <= std::min(width - 1, x + 2); ++u)
          beside = beside || !std::isinf(truth.depth.at(u, v));
      if (beside) continue;
      ++stray;
      removed += std::isinf(out.depth.data()[i]);
    }
  }
  std::printf("| %d | %d | %.3f %% of %zu | %.2f %% of %zu | %.3f |\n", o.points, o.outliers,
              100.0 * double(removed) / double(std::max<std::size_t>(stray, 1)), stray,
              100.0 * double(kept) / double(surface), surface, compare(out, truth, contest.bin_size()).mae);
}

/// Over the orbit of one way of drawing: how much a pixel's error changes from one frame to the next. What does not
/// move with the surface flickers. And how much the pictures change, motion included.
struct Flicker {
  double depth = 0, light = 0;
  std::size_t count = 0;
  Image<vec2> before;
  bench::FrameDifferenceMeter pictures;
  void add(const RenderOutput& out, const synth::Truth& truth, double bin_size) {
    Image<vec2> now(truth.depth.width(), truth.depth.height(), vec2(NAN));
    for (std::size_t i = 0; i < now.size(); ++i) {
      if (std::isinf(truth.depth.data()[i])) continue;
      const double d = (double(out.depth.data()[i]) - truth.depth.data()[i]) / bin_size;
      now.data()[i] = {std::min(std::max(d, -5.0), 5.0),
                       luma(vec3(out.color_linear.data()[i])) - luma(truth.color.data()[i])};
      if (before.size() == 0 || std::isnan(before.data()[i].x)) continue;
      depth += std::abs(now.data()[i].x - before.data()[i].x);
      light += std::abs(now.data()[i].y - before.data()[i].y);
      ++count;
    }
    before = std::move(now);
    pictures.add(out.rgba8);
  }
};

Image<Rgba8> picture_of(const synth::Truth& truth) {
  Image<Rgba8> picture(truth.color.width(), truth.color.height());
  for (std::size_t i = 0; i < picture.size(); ++i) {
    const vec3 c = truth.color.data()[i];
    auto code = [](float v) { return std::uint8_t(std::lround(255 * srgb(v))); };
    picture.data()[i] = {code(c.r), code(c.g), code(c.b), 255};
  }
  return picture;
}

void orbit_table(Contest& contest, const Arguments& arguments) {
  const synth::Scene scene = synth::make_mesh_scene(io::read_mesh(arguments.dragon));
  const int frames = arguments.quick ? 12 : 180, size = arguments.quick ? 128 : 256;
  std::printf("\nFlicker on an orbit of %d frames of 2 degrees, %dx%d: change of the error in depth (bins) and luma (1/255); "
              "change of the picture, motion included (1/255; worst pair)\n\n", frames, size, size);
  std::printf("| outliers | perfect | splats | denoise, nearest | denoise, grid | overlapping, grid |\n"
              "|---|---|---|---|---|---|\n");
  for (bool outliers : {false, true}) {
    synth::SampleOptions o;
    o.seed = 101, o.points = 150'000, o.outliers = outliers ? 12'500 : 0;
    auto camera_at = [&](int f) {
      return frame(scene.box, scene.up, size, size, glm::radians(2.0 * f - 30), glm::radians(20.0));
    };
    contest.take(synth::sample(scene, o), camera_at(0));
    bench::FrameDifferenceMeter perfect;
    Flicker flicker[4];
    for (int f = 0; f < frames; ++f) {
      const Camera camera = camera_at(f);
      const synth::Truth truth = synth::truth(scene, camera);
      perfect.add(picture_of(truth));
      for (int method = 0; method < 4; ++method) {
        contest.set_denoise("anchor", method >= 2 ? "grid" : "nearest");
        contest.set_denoise("overlapping", method == 3 ? "true" : "false");
        flicker[method].add(method == 0 ? contest.splats(camera, false) : contest.automatic(camera), truth,
                            contest.bin_size());
      }
    }
    contest.set_denoise("anchor", "nearest");
    contest.set_denoise("overlapping", "false");
    std::printf("| %s | %.2f (%.2f) |", outliers ? "8 %" : "none", perfect.result().mean, perfect.result().worst);
    for (const Flicker& one : flicker)
      std::printf(" %.3f / %.2f; %.2f (%.2f) |", one.depth / double(one.count), 255 * one.light / double(one.count),
                  one.pictures.result().mean, one.pictures.result().worst);
    std::printf("\n");
    std::fflush(stdout);
  }
}

}  // namespace

int main(int count, char** values) try {
  Arguments arguments;
  for (int i = 1; i < count; ++i) {
    const std::string word = values[i];
    if (word == "--quick") arguments.quick = true;
    else if (word == "--choose") arguments.choose = true;
    else if (word == "--part" && i + 1 < count) arguments.part = values[++i];
    else if (word == "--row" && i + 1 < count) arguments.row = values[++i];
    else if (word == "--dragon" && i + 1 < count) arguments.dragon = values[++i];
    else throw Error(ErrorCode::usage, "eval_denoise: what is '" + word + "'?");
  }
  auto context = gl::Context::create_headless();
  Contest contest(*context);
  const auto start = std::chrono::steady_clock::now();
  if (arguments.wants("noise")) noise_tables(contest, arguments);
  if (arguments.wants("views")) views_table(contest, arguments);
  if (!arguments.dragon.empty() && arguments.wants("dragon")) dragon_figures(contest, arguments);
  if (!arguments.dragon.empty() && arguments.wants("orbit")) orbit_table(contest, arguments);
  std::printf("\n%.0f s\n", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
} catch (const Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
