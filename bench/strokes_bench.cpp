#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <numeric>

#include "analysis/clusters.h"
#include "analysis/prepare.h"
#include "io/io.h"
#include "passes/finish.h"
#include "scene.h"
#include "tori.h"

using namespace sfumato;
using namespace sfumato::bench;

namespace {

constexpr int width = 1920, height = 1080;  // as in the paper's Table 2

std::string guanyin() { return (data_folder() / "Guanyin.ply").string(); }

/// Agreement of two partitions, 1 for equal, about 0 for unrelated ones (Hubert and Arabie 1985).
double adjusted_rand_index(const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> both;
  std::map<std::uint32_t, double> of_a, of_b;
  for (std::size_t i = 0; i < a.size(); ++i) ++both[{a[i], b[i]}], ++of_a[a[i]], ++of_b[b[i]];
  auto pairs = [](const auto& counts) {
    double sum = 0;
    for (const auto& [key, n] : counts) sum += n * (n - 1) / 2;
    return sum;
  };
  const double n = double(a.size()), all = n * (n - 1) / 2;
  const double expected = pairs(of_a) * pairs(of_b) / all, most = (pairs(of_a) + pairs(of_b)) / 2;
  return (pairs(both) - expected) / (most - expected);
}

/// Search tree, graph and growth on a cloud in the order of its file, with the options given to the peer.
void clusters(benchmark::State& state) {
  PointCloud cloud;
  try {
    cloud = io::read(guanyin()).cloud;
  } catch (const std::exception& error) {
    state.SkipWithError(error.what());
    return;
  }
  analysis::ClusterOptions options;
  options.gap = 0.0168f;  // five median spacings
  analysis::Clusters found;
  std::vector<std::uint32_t> source;
  for (auto _ : state) {
    // Sorting along the curve is part of the price.
    const PreparedCloud prepared = analysis::prepare(cloud, {}, {});
    const analysis::NeighborGraph graph(prepared.cloud.positions, options.neighbors, no_progress());
    found = analysis::grow_clusters(prepared.cloud, graph, prepared.median_spacing, options);
    source = prepared.cloud.source_index;
  }
  state.counters["clusters"] = found.count;
  // What the peer wrote, if it ran before (bench/peers.py).
  const char* folder = std::getenv("SFUMATO_BENCH_DATA");
  if (std::FILE* file =
          folder ? std::fopen((std::string(folder) + "/pcl_clusters.u32").c_str(), "rb") : nullptr) {
    std::vector<std::uint32_t> theirs(source.size()), ours(source.size());
    if (std::fread(theirs.data(), 4, theirs.size(), file) == theirs.size()) {
      for (std::size_t i = 0; i < source.size(); ++i) ours[source[i]] = found.label[i];
      state.counters["adjusted_rand_index"] = adjusted_rand_index(ours, theirs);
    }
    std::fclose(file);
  }
}

/// Everything that strokes need before the first frame, from points in memory.
void preprocessing(benchmark::State& state) {
  const PointCloud cloud = io::read(tori_file(std::size_t(state.range(0)))).cloud;
  for (auto _ : state)
    benchmark::DoNotOptimize(analysis::prepare(cloud, Attribute::normal | Attribute::cluster, {}));
}

void whole_frames(benchmark::State& state, const char* technique,
                  std::initializer_list<std::pair<const char*, const char*>> values) {
  auto made = find_technique(technique).create();
  for (const auto& [name, value] : values) set(*made, name, value);
  time_frames(state, *made, std::size_t(state.range(0)), plain_settings(Shading::lit), width, height);
}

/// The frames of an incremental picture, from the one that stops to the final one; each a call of `render`
/// and, as in whole_frames, the finished picture. One picture before the first makes shaders and uploads.
void refinement(benchmark::State& state, bool first_frame) {
  auto technique = find_technique("strokes").create();
  set(*technique, "refine", "per_frame");
  Renderer& renderer = tori_renderer(std::size_t(state.range(0)), technique->needs());
  GpuCloud cloud(renderer.prepared(), renderer.prepared().cloud.colors);
  Target target(width, height);
  gl::Timers timers(false);
  RenderSettings settings = plain_settings(Shading::lit);
  Finish finish;
  gl::Texture picture("finished picture", GL_RGBA8, width, height);
  int n = 0, frames = 0;
  auto one_picture = [&](double& list_ms, double& refine_ms) {
    Camera camera = tori_camera(n++, width, height);
    camera.fit_depth_range(cloud.bounds());
    Frame frame{cloud, camera, settings, Light{}, target, false, timers, no_progress()};
    frames = 0;
    for (bool done = false; !done; ++frames) {
      glFinish();
      const auto start = std::chrono::steady_clock::now();
      technique->render(frame);
      const std::vector<std::string> notes = technique->notes();
      done = notes.empty() || notes.back().find("not sorted") == std::string::npos;
      finish.run(settings, target.color, picture);
      glFinish();
      (frames == 0 ? list_ms : refine_ms) +=
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    }
  };
  double list_ms = 0, refine_ms = 0;
  one_picture(list_ms, refine_ms);
  for (auto _ : state) {
    list_ms = refine_ms = 0;
    one_picture(list_ms, refine_ms);
    state.SetIterationTime(1e-3 * (first_frame ? list_ms : refine_ms / std::max(frames - 1, 1)));
  }
  state.counters["frames_to_final"] = frames;
}

void name(const char* row, void (*function)(benchmark::State&), std::initializer_list<int> counts) {
  for (int count : counts)
    benchmark::RegisterBenchmark((std::string("strokes/") + row).c_str(), function)
        ->Arg(count)
        ->MeasureProcessCPUTime()  // of all threads: what a shared machine can still compare
        ->UseManualTime()
        ->Iterations(3)
        ->Unit(benchmark::kMillisecond);
}

const bool registered = [] {
  const std::initializer_list<int> table_2 = {566'098, 1'630'572, 14'027'872};
  name(
      "blur",
      [](benchmark::State& s) {
        whole_frames(s, "strokes", {{"blend", "blur"}});
      },
      table_2);
  name(
      "splats", [](benchmark::State& s) { whole_frames(s, "splats", {}); }, table_2);
  name(
      "a_buffer", [](benchmark::State& s) { whole_frames(s, "strokes", {}); }, table_2);
  // As in the paper, every point is a stroke of its own size.
  name(
      "every_point_blur",
      [](benchmark::State& s) {
        whole_frames(s, "strokes", {{"style", "figure_4b"}, {"blend", "blur"}});
      },
      table_2);
  name(
      "every_point_a_buffer",
      [](benchmark::State& s) {
        whole_frames(s, "strokes", {{"style", "figure_4b"}});
      },
      table_2);
  name(
      "list_frame", [](benchmark::State& s) { refinement(s, true); }, table_2);
  name(
      "refine_frame", [](benchmark::State& s) { refinement(s, false); }, table_2);
  benchmark::RegisterBenchmark("strokes/clusters", clusters)
      ->UseRealTime()
      ->Iterations(1)
      ->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark("strokes/preprocessing", preprocessing)
      ->Arg(580'000)
      ->UseRealTime()
      ->Iterations(1)
      ->Unit(benchmark::kMillisecond);
  return true;
}();

}  // namespace
