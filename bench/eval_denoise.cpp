// The tables and figures of the technique `denoise` against the truth of synthetic scenes: `make
// eval-denoise`.
//
//   eval_denoise [--quick] [--choose] [--part clean|noise|views|dragon|delta|orbit] [--row TEXT] [--data
//   FOLDER]
//   [--maps FOLDER]
//                [--clutter-radius SHARE]
//
// Every constant of the automatic threshold was chosen with --choose: other seeds, other views, and none of
// the scenes that are marked `unseen` in the table. `--data` holds the scans that clean rows need; `--maps`
// takes error maps.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <map>

#include "core/error.h"
#include "denoise_contest.h"
#include "frame_difference.h"
#include "io/camera_json.h"
#include "io/image_png.h"
#include "io/io.h"
#include "options.h"

using namespace sfumato;
using namespace sfumato::bench;

namespace {

struct Arguments {
  bool quick = false, choose = false;
  std::string part = "all", row, data, maps, clutter_radius;
  bool wants(const char* name) const { return part == "all" || part == name; }
  /// A file of `data`, or nothing with a reason printed.
  std::optional<std::string> file(const std::string& name) const {
    const std::string path = data + "/" + name;
    if (std::filesystem::exists(path)) return path;
    std::printf("(no %s: its rows are left out)\n", path.c_str());
    return {};
  }
};

/// A mesh of another unit, made `height` tall.
synth::Scene mesh_scene(const std::string& file, float height) {
  Mesh mesh = io::read_mesh(file);
  float low = std::numeric_limits<float>::infinity(), high = -low;
  for (const vec3& p : mesh.positions) low = std::min(low, p.y), high = std::max(high, p.y);
  for (vec3& p : mesh.positions) p *= height / (high - low);
  return synth::make_mesh_scene(std::move(mesh));
}

/// A camera that took no part in the scan.
Camera judging_camera(const synth::Scene& scene, int width, int height) {
  if (scene.held_out) return scene.held_out->resized(width, height);
  return frame(scene.box, scene.up, width, height, glm::radians(-45.0), 0.5);
}

// ---- Clean scans: nothing is to be removed, and nothing behind the surface may show. ----

struct CleanRow {
  std::string name;
  PointCloud cloud;
  Camera camera;
  std::optional<Image<float>> truth;  ///< else what splats show
};

void clean_row(Contest& contest, CleanRow row, const Arguments& arguments) {
  if (row.name.find(arguments.row) == std::string::npos) return;
  contest.take(std::move(row.cloud), row.camera);
  const RenderOutput splats = contest.splats(row.camera, false), out = contest.automatic(row.camera);
  const double bin = contest.bin_size(), radius_px = contest.radius_px(row.camera);
  // Discs reach over the silhouette by their radius, where both answers are right.
  const Image<float>& reference = row.truth ? *row.truth : splats.depth;
  const Image<std::uint8_t> inside = interior(reference, bin,
                                              row.truth ? Image<int>(row.camera.width, row.camera.height, 3)
                                                        : contest.rims(row.camera, splats.depth));
  const TooDeep by_splats = too_deep(splats.depth, reference, inside, bin),
                ours = too_deep(out.depth, reference, inside, bin);
  const std::size_t own = ours.without(by_splats);
  std::printf("| %s | %s | %zu | %.1f | %.3f (%zu) | %.3f (%zu) | %.3f (%zu) | %.2f |\n", row.name.c_str(),
              row.truth ? "truth" : "splats", ours.among, radius_px, by_splats.percent(by_splats.count),
              by_splats.count, ours.percent(ours.count), ours.count, ours.percent(own), own,
              100 * contest.left_out());
  std::fflush(stdout);
  if (arguments.maps.empty()) return;
  const std::string base = arguments.maps + "/clean_" + row.name;
  io::write_png(base + ".png", out.rgba8, false);
  io::write_png(base + "_errors.png", error_map(out.depth, reference, bin), false);
  io::write_camera(base + "_camera.json", row.camera);
}

void clean_table(Contest& contest, const Arguments& arguments) {
  const int width = arguments.quick ? 320 : 640, height = width * 3 / 4;
  std::printf(
      "\nClean scans, %dx%d: interior pixels that show nothing, or something more than 5 bins behind the "
      "surface, %% "
      "(pixels), and those of them where splats do not; points left out by the prefilter, %%\n\n",
      width, height);
  std::printf(
      "| scan | against | interior | radius px | splats | denoise, auto | its own | left out "
      "|\n|---|---|---|---|---|---|---|---|\n");
  auto from_scene = [&](const std::string& name, const synth::Scene& scene, synth::SampleOptions o,
                        Camera camera) {
    o.seed = arguments.choose ? 11 : 101;
    clean_row(contest, {name, synth::sample(scene, o), camera, synth::truth(scene, camera).depth}, arguments);
  };
  auto from_mesh = [&](const char* file, float size, std::vector<int> counts, double azimuth) {
    const std::optional<std::string> path = arguments.file(file);
    if (!path) return;
    const synth::Scene scene = mesh_scene(*path, size);
    const std::string stem = std::string(file).substr(0, std::string(file).find_first_of("_."));
    for (int count : counts) {
      synth::SampleOptions o;
      o.points = arguments.quick ? count / 2 : count;
      from_scene(stem + "_" + std::to_string(o.points / 1000) + "k", scene, o,
                 frame(scene.box, scene.up, width, height, glm::radians(azimuth), glm::radians(20.0)));
    }
  };
  from_mesh("dragon_vrip_res2.ply", 1, {150'000, 500'000, 1'000'000}, arguments.choose ? 60 : -30);
  synth::SampleOptions o;
  o.points = arguments.quick ? 150'000 : 300'000;
  const synth::Scene room = synth::make_scene("room");
  from_scene("room_cameras", room, o, room.held_out->resized(width, height));
  o.sampling = synth::Sampling::area;
  from_scene("room_area", room, o, room.cameras[arguments.choose ? 4 : 1].resized(width, height));
  if (arguments.choose) return;
  from_mesh("armadillo.obj", 1.5f, {150'000, 500'000}, -30);
  const synth::Scene courtyard = synth::make_scene("courtyard");
  from_scene("courtyard_area", courtyard, o, judging_camera(courtyard, width, height));
  for (const char* file : {"indoor.laz", "Guanyin.ply", "bunnyData.pts", "lion_takanawa.copc.laz"}) {
    const std::optional<std::string> path = arguments.file(file);
    if (!path) continue;
    PointCloud cloud = io::read(*path).cloud;
    const Camera camera =
        frame(robust_bounds(cloud), cloud.up, width, height, glm::radians(-45.0), glm::radians(30.0));
    clean_row(
        contest,
        {std::string(file).substr(0, std::string(file).find_first_of("_.")), std::move(cloud), camera, {}},
        arguments);
  }
}

// ---- Noise and outliers: every method with every choice its user could make. ----

struct Row {
  std::string name, scene;
  synth::SampleOptions options;
  std::vector<Camera> cameras;
};

/// One way of drawing and the best manual threshold of each column of the ablation.
struct Verdict {
  double bin_size = 0;
  Errors splats[2][2];  ///< opaque or averaged, without and with the prefilter
  Errors manual[2][2];  ///< prefilter, miss = last_bin: the threshold with the least depth error
  double threshold[2][2] = {};
  Errors automatic;
  double best() const {
    double least = 1e9;
    for (int i = 0; i < 4; ++i) least = std::min({least, manual[i / 2][i % 2].mae, splats[i / 2][i % 2].mae});
    return least;
  }
};

std::vector<double> manual_thresholds(bool quick) {
  const int count = quick ? 6 : 12;
  std::vector<double> list{0};  // the first bin, as splats do
  for (int i = 0; i < count; ++i) list.push_back(0.02 * std::pow(250.0, double(i) / (count - 1)));  // to 5
  return list;
}

Verdict judge(Contest& contest, const synth::Scene& scene, const Row& row, const Arguments& arguments) {
  contest.take(synth::sample(scene, row.options), row.cameras[0]);
  Verdict v;
  v.bin_size = contest.bin_size();
  const std::vector<double> thresholds = manual_thresholds(arguments.quick);
  std::vector<Errors> manual[2][2];
  for (int k = 0; k < 4; ++k) manual[k / 2][k % 2].resize(thresholds.size());
  for (std::size_t c = 0; c < row.cameras.size(); ++c) {
    const Camera& camera = row.cameras[c];
    const synth::Truth truth = synth::truth(scene, camera);
    const double share = 1.0 / double(row.cameras.size());
    auto errors = [&](const RenderOutput& out) { return compare(out, truth, v.bin_size); };
    auto keep_map = [&](const char* method, const RenderOutput& out) {
      if (arguments.maps.empty() || c > 0) return;
      const std::string base = arguments.maps + "/" + row.scene + "_" + row.name + "_" + method;
      io::write_png(base + ".png", error_map(out.depth, truth.depth, v.bin_size), false);
      io::write_png(base + "_color.png", out.rgba8, false);
    };
    const RenderOutput out = contest.automatic(camera);
    v.automatic.add(errors(out), share);
    keep_map("auto", out);
    for (int filter = 0; filter < 2; ++filter) {
      for (int averaged = 0; averaged < 2; ++averaged) {
        const RenderOutput splats = contest.splats(camera, !averaged, filter);
        v.splats[averaged][filter].add(errors(splats), share);
        if (averaged) keep_map(filter ? "splats_filtered" : "splats", splats);
      }
      for (int last = 0; last < 2; ++last)
        for (std::size_t i = 0; i < thresholds.size(); ++i)
          manual[filter][last][i].add(errors(contest.manual(camera, thresholds[i], filter, last)), share);
    }
  }
  for (int filter = 0; filter < 2; ++filter)
    for (int last = 0; last < 2; ++last) {
      v.manual[filter][last].mae = 1e9;
      for (std::size_t i = 0; i < thresholds.size(); ++i)
        if (manual[filter][last][i].mae < v.manual[filter][last].mae)
          v.manual[filter][last] = manual[filter][last][i], v.threshold[filter][last] = thresholds[i];
    }
  return v;
}

/// RGB-D cameras all around a thing.
std::vector<Camera> cameras_around(const synth::Scene& scene, int count) {
  std::vector<Camera> cameras;
  for (int i = 0; i < count; ++i)
    cameras.push_back(frame(scene.box, scene.up, 640, 480, glm::radians(360.0 * i / count + 10),
                            glm::radians(i % 2 ? 35.0 : 5.0)));
  return cameras;
}

/// RGB-D cameras where the scanners of a scene stand, looking around.
std::vector<Camera> cameras_at_scanners(const synth::Scene& scene) {
  std::vector<Camera> cameras;
  for (const dvec3& at : scene.scanners)
    for (int i = 0; i < 5; ++i) {
      const double angle = glm::radians(72.0 * i);
      Camera camera;
      camera.position = at;
      camera.target = at + dvec3(std::cos(angle), std::sin(angle), -0.15);
      camera.fov_y = glm::radians(60.0);
      camera.width = 640, camera.height = 480;
      cameras.push_back(camera);
    }
  return cameras;
}

std::map<std::string, synth::Scene> noise_scenes(const Arguments& arguments) {
  std::map<std::string, synth::Scene> scenes;
  scenes.emplace("room", synth::make_scene("room"));
  if (arguments.choose) return scenes;
  synth::Scene courtyard = synth::make_scene("courtyard");
  courtyard.cameras = cameras_at_scanners(courtyard);
  scenes.emplace("courtyard", std::move(courtyard));
  if (const std::optional<std::string> file = arguments.file("armadillo.obj")) {
    synth::Scene armadillo = mesh_scene(*file, 1.5f);
    armadillo.cameras = cameras_around(armadillo, 8);
    armadillo.held_out =
        frame(armadillo.box, armadillo.up, 640, 480, glm::radians(-30.0), glm::radians(20.0));
    scenes.emplace("armadillo", std::move(armadillo));
  }
  return scenes;
}

std::vector<Row> noise_rows(const Arguments& arguments, const std::map<std::string, synth::Scene>& scenes) {
  using enum synth::NoiseModel;
  std::vector<Row> rows;
  auto add = [&](std::string name, const char* scene_name, synth::SampleOptions options) {
    if (!scenes.count(scene_name)) return;
    const synth::Scene& scene = scenes.at(scene_name);
    options.seed = arguments.choose ? 11 : 101;
    options.points = arguments.quick ? 60'000 : 120'000;
    if (arguments.quick) options.outliers /= 2;
    const int width = arguments.quick ? 120 : 160, height = width * 3 / 4;
    Row row{std::move(name), scene_name, options, {}};
    row.cameras.push_back(judging_camera(scene, width, height));
    if (!scene.cameras.empty() && !arguments.quick && options.sampling != synth::Sampling::scanners)
      row.cameras.push_back(scene.cameras[arguments.choose ? 4 : 1].resized(width, height));
    rows.push_back(row);
  };
  auto noisy = [&](const char* scene, synth::NoiseModel model, const char* name, float level) {
    synth::SampleOptions o;
    o.sampling = synth::Sampling::cameras;
    o.noise = model, o.noise_level = level;
    o.flying_pixels = 0.3f, o.outliers = 2400;  // 2 %
    add(std::string(name) + " x" + std::to_string(int(level)), scene, o);
  };
  auto others = [&](const char* scene) {
    synth::SampleOptions o;
    o.sampling = synth::Sampling::cameras;
    o.outliers = 6000;  // 5 %
    add("outliers 5 %", scene, o);
    o.outliers = 0, o.flying_pixels = 0.5f;
    add("flying pixels 50 %", scene, o);
  };
  const std::vector<float> levels = arguments.quick ? std::vector<float>{2} : std::vector<float>{1, 2, 4, 8};
  for (auto [model, name] :
       {std::pair{poisson, "z^2 noise"}, {tof, "time of flight"}, {structured_light, "structured light"}})
    for (float level : levels) noisy("room", model, name, level);
  others("room");
  synth::SampleOptions o;
  o.sampling = synth::Sampling::scanners, o.flying_pixels = 0.3f;
  if (arguments.choose) {
    o.outliers = 1500, o.sigma = 0.005f, o.scanner_position = {1.2f, 1, 1.5f};
    add("a scanner in the room, density varies", "room", o);
    return rows;
  }
  o.outliers = 3000, o.sigma = 0.03f;
  add("scanners, density varies", "courtyard", o);
  for (const char* scene : {"courtyard", "armadillo"}) {
    noisy(scene, poisson, "z^2 noise", 2);
    noisy(scene, tof, "time of flight", 2);
    noisy(scene, structured_light, "structured light", 2);
    others(scene);
  }
  return rows;
}

void noise_tables(Contest& contest, const Arguments& arguments) {
  const std::map<std::string, synth::Scene> scenes = noise_scenes(arguments);
  std::printf(
      "\nPrefilter x T x miss. Depth MAE / RMSE in bin sizes (missed %%) PSNR / SSIM of the albedo; a miss "
      "counts 5, errors "
      "are clamped there. `f`: without isolated points. `l`: where no bin is above T, the last one.\n\n");
  std::printf(
      "| scene | scan | bin | opaque | opaque f | averaged | averaged f | best T | best T f | best T l | "
      "best T f l | auto | "
      "auto / best of all |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  int beats = 0, near = 0, unseen = 0;
  for (const Row& row : noise_rows(arguments, scenes)) {
    if ((row.scene + " " + row.name).find(arguments.row) == std::string::npos) continue;
    const Verdict v = judge(contest, scenes.at(row.scene), row, arguments);
    auto print = [](const Errors& e, double threshold = -1) {
      std::printf(" %.3f / %.3f (%.1f) %.1f / %.2f", e.mae, e.rmse, 100 * e.missed, e.psnr, e.ssim);
      if (threshold >= 0) std::printf(" at %.2f", threshold);
      std::printf(" |");
    };
    std::printf("| %s | %s | %.3f |", row.scene.c_str(), row.name.c_str(), v.bin_size);
    for (int k = 0; k < 4; ++k) print(v.splats[k / 2][k % 2]);
    for (int last = 0; last < 2; ++last)
      for (int filter = 0; filter < 2; ++filter) print(v.manual[filter][last], v.threshold[filter][last]);
    print(v.automatic);
    std::printf(" %.2f |\n", v.automatic.mae / v.best());
    std::fflush(stdout);
    if (row.scene == "room") continue;
    ++unseen;
    beats += v.automatic.mae < v.splats[1][1].mae;
    near += v.automatic.mae <= 1.1 * v.best();
  }
  std::printf(
      "\nof %d rows of scenes that chose nothing, auto beats averaged splats without isolated points in %d "
      "and is within "
      "10 %% of the best of all columns in %d\n",
      unseen, beats, near);
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
  const std::optional<std::string> file = arguments.file("dragon_vrip_res2.ply");
  if (!file) return;
  const synth::Scene scene = synth::make_mesh_scene(io::read_mesh(*file));
  const int width = arguments.quick ? 320 : 640, height = width * 3 / 4;
  std::printf("\nDragon, uniform outliers in its box, %dx%d, defaults\n\n", width, height);
  std::printf(
      "| points | outliers | pixels of outliers only that become background | surface pixels kept within 2 "
      "bins "
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
      // Splats of the silhouette reach a little beyond it: a pixel beside the surface is not the outliers'
      // alone.
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

/// Would thicker bins help where noise is larger, as it grows with z^2? Mean depth error with one Delta for
/// all, the best of some, against the best of each third of the depths.
void delta_table(Contest& contest, const Arguments& arguments) {
  const std::vector<double> factors{0.25, 0.5, 0.71, 1, 1.41, 2, 2.83, 4};
  const int width = arguments.quick ? 160 : 320, height = width * 3 / 4;
  std::printf(
      "\nOne Delta or one for each third of the depths, %dx%d; error in scene units "
      "of pixels that all show, 5 of auto's bins at most\n\n",
      width, height);
  std::printf(
      "| scene | noise | auto | error at auto | at twice auto | best of all | by thirds | best factor of "
      "each third "
      "|\n|---|---|---|---|---|---|---|---|\n");
  for (const auto& [name, scene] : noise_scenes(arguments)) {
    if (name == "armadillo") continue;  // as far away all over
    for (float level : {2.0f, 8.0f}) {
      const Camera camera = judging_camera(scene, width, height);
      const synth::Truth truth = synth::truth(scene, camera);
      synth::SampleOptions o;
      o.sampling = synth::Sampling::cameras;
      o.noise = synth::NoiseModel::poisson, o.noise_level = level;
      o.seed = 101, o.points = arguments.quick ? 60'000 : 120'000;
      contest.take(synth::sample(scene, o), camera);
      const double bin = contest.bin_size();
      std::vector<float> depths;
      for (float depth : truth.depth)
        if (!std::isinf(depth)) depths.push_back(depth);
      std::sort(depths.begin(), depths.end());
      const float borders[] = {depths[depths.size() / 3], depths[2 * depths.size() / 3]};
      std::vector<Image<float>> shown;
      for (double factor : factors) {
        contest.set_denoise("bin_size", std::to_string(bin * factor));
        shown.push_back(contest.automatic(camera).depth);
      }
      std::vector<std::array<double, 3>> sums(factors.size());
      double count = 0;
      for (std::size_t i = 0; i < truth.depth.size(); ++i) {
        const float expected = truth.depth.data()[i];
        const bool by_all = std::ranges::none_of(
            shown, [&](const Image<float>& depth) { return std::isinf(depth.data()[i]); });
        if (std::isinf(expected) || !by_all) continue;
        const std::size_t third = std::size_t(expected > borders[0]) + std::size_t(expected > borders[1]);
        for (std::size_t f = 0; f < factors.size(); ++f)
          sums[f][third] += std::min(5 * bin, std::abs(double(shown[f].data()[i]) - expected));
        ++count;
      }
      for (std::array<double, 3>& sum : sums)
        for (double& each : sum) each /= count;
      contest.set_denoise("bin_size", "auto");
      auto total = [&](std::size_t f) { return sums[f][0] + sums[f][1] + sums[f][2]; };
      double one = total(0), each = 0, best[3];
      for (std::size_t f = 0; f < factors.size(); ++f) one = std::min(one, total(f));
      for (std::size_t third = 0; third < 3; ++third) {
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t f = 0; f < factors.size(); ++f)
          if (sums[f][third] < least) least = sums[f][third], best[third] = factors[f];
        each += least;
      }
      std::printf("| %s | x%g | %.3f | %.4f | %.4f | %.4f | %.4f | %g %g %g |\n", name.c_str(), double(level),
                  bin, total(3), total(5), one, each, best[0], best[1], best[2]);
      std::fflush(stdout);
    }
  }
}

/// Over the orbit of one way of drawing: how much a pixel's error changes from one frame to the next. What
/// does not move with the surface flickers. And how much the pictures change, motion included.
struct Flicker {
  double depth = 0, light = 0;
  std::size_t count = 0;
  Image<vec2> before;
  FrameDifferenceMeter pictures;
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
  const std::optional<std::string> file = arguments.file("dragon_vrip_res2.ply");
  if (!file) return;
  const synth::Scene scene = synth::make_mesh_scene(io::read_mesh(*file));
  const int frames = arguments.quick ? 12 : 60, size = arguments.quick ? 128 : 256;
  std::printf(
      "\nFlicker on an orbit of %d frames of 2 degrees, %dx%d: change of the error in depth (bins) and luma "
      "(1/255); "
      "change of the picture, motion included (1/255; worst pair)\n\n",
      frames, size, size);
  std::printf(
      "| outliers | perfect | splats | denoise, nearest | denoise, grid | overlapping, grid |\n"
      "|---|---|---|---|---|---|\n");
  for (bool outliers : {false, true}) {
    synth::SampleOptions o;
    o.seed = 101, o.points = 150'000, o.outliers = outliers ? 12'500 : 0;
    auto camera_at = [&](int f) {
      return frame(scene.box, scene.up, size, size, glm::radians(2.0 * f - 30), glm::radians(20.0));
    };
    contest.take(synth::sample(scene, o), camera_at(0));
    FrameDifferenceMeter perfect;
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
    std::printf("| %s | %.2f (%.2f) |", outliers ? "8 %" : "none", perfect.result().mean,
                perfect.result().worst);
    for (const Flicker& one : flicker)
      std::printf(" %.3f / %.2f; %.2f (%.2f) |", one.depth / double(one.count),
                  255 * one.light / double(one.count), one.pictures.result().mean,
                  one.pictures.result().worst);
    std::printf("\n");
    std::fflush(stdout);
  }
}

}  // namespace

int main(int count, char** values) try {
  Arguments arguments;
  Options options;
  options.flag("quick", arguments.quick).flag("choose", arguments.choose);
  options.value("part", arguments.part).value("row", arguments.row).value("data", arguments.data);
  options.value("maps", arguments.maps).value("clutter-radius", arguments.clutter_radius);
  if (!options.parse(count, values).empty()) throw Error(ErrorCode::usage, "unexpected words");
  auto context = gl::Context::create_headless();
  Contest contest(*context);
  if (!arguments.clutter_radius.empty()) contest.set_clutter_radius(std::stof(arguments.clutter_radius));
  const auto start = std::chrono::steady_clock::now();
  if (arguments.wants("clean")) clean_table(contest, arguments);
  if (arguments.wants("noise")) noise_tables(contest, arguments);
  if (arguments.wants("views")) views_table(contest, arguments);
  if (arguments.wants("dragon")) dragon_figures(contest, arguments);
  if (arguments.wants("delta")) delta_table(contest, arguments);
  if (arguments.wants("orbit")) orbit_table(contest, arguments);
  std::printf("\n%.0f s\n", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
} catch (const Error& error) {
  std::fprintf(stderr, "eval_denoise: %s\n", error.what());
  return 1;
}
