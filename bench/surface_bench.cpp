#include <algorithm>
#include <map>
#include <string_view>

#include "passes/screen_pass.h"
#include "scene.h"

using namespace sfumato;
using namespace sfumato::bench;

namespace {

constexpr int paper_width = 1248, paper_height = 768;  // of Bouchiba 2018, Table 1

void whole_frame(benchmark::State& state) {
  auto technique = find_technique("surface").create();
  time_frames(state, *technique, std::size_t(state.range(0)), plain_settings(Shading::lit));
}

/// Time of the passes that `counts` names, one frame per iteration, always from the same camera.
template <class F>
void time_passes(benchmark::State& state, Technique& technique, const std::string& scene, F counts, int width,
                 int height) {
  const Stage stage = stage_of(scene, technique.needs());
  const Camera camera = stage.camera(0, width, height);
  const RenderSettings settings = plain_settings(Shading::lit);
  RenderWants wants;
  wants.timings = true;
  stage.renderer.render(technique, camera, settings, wants);  // shaders and uploads
  for (auto _ : state) {
    double ms = 0;
    for (const PassTiming& pass : stage.renderer.render(technique, camera, settings, wants).timings)
      if (counts(std::string_view(pass.name))) ms += pass.ms;
    state.SetIterationTime(1e-3 * ms);
  }
}

/// Least milliseconds of every pass as counters, for whoever looks for the slow one.
void passes(benchmark::State& state) {
  auto technique = find_technique("surface").create();
  std::map<std::string, double> ms;
  Renderer& renderer = tori_renderer(std::size_t(state.range(0)));
  RenderWants wants;
  wants.timings = true;
  renderer.render(*technique, tori_camera(), plain_settings(Shading::lit), wants);  // shaders and uploads
  for (auto _ : state) {
    const RenderOutput out = renderer.render(*technique, tori_camera(), plain_settings(Shading::lit), wants);
    for (const PassTiming& pass : out.timings) {
      double& least = ms.try_emplace(pass.name, pass.ms).first->second;
      least = std::min(least, pass.ms);
    }
    state.SetIterationTime(1e-3 * out.total_ms);
  }
  for (const auto& [name, least] : ms) state.counters[name] = least;
}

/// Everything after the geometry visit, at the point spacing of 1M points whatever the cloud.
void screen_part(benchmark::State& state) {
  auto technique = find_technique("surface").create();
  set(*technique, "point_spacing", "0.006");
  time_passes(
      state, *technique, std::to_string(state.range(0)),
      [](std::string_view name) {
        return name != "depth" && name != "index" && name != "resolve" && name != "finish";
      },
      1024, 1024);
}

/// By the operators of the paper.
void passes_of(benchmark::State& state, const std::string& scene, const std::vector<std::string_view>& passes,
               const char* removal) {
  auto technique = find_technique("surface").create();
  set(*technique, "filling", "pull_push");
  set(*technique, "hidden_point_removal", removal);
  set(*technique, "window_radius", "25");
  time_passes(
      state, *technique, scene,
      [&](std::string_view name) { return std::find(passes.begin(), passes.end(), name) != passes.end(); },
      paper_width, paper_height);
}

/// That many copies of an RGBA32F image of the paper's size and a guard band of 64 px.
void copies(benchmark::State& state) {
  tori_renderer(128'000);  // makes the context
  const int width = paper_width + 128, height = paper_height + 128;
  gl::Texture from("from", GL_RGBA32F, width, height), to("to", GL_RGBA32F, width, height);
  from.clear(vec4(0.5f));
  ScreenPass copy("passes/finish.glsl", {GL_RGBA32F});
  copy.set("background_srgb", vec3(1)).set("is_transparent", true);
  for (auto _ : state) {
    glFinish();
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < state.range(0); ++i) copy.run({&from}, {&to});
    glFinish();
    state.SetIterationTime(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
}

void name(const char* row, void (*function)(benchmark::State&), std::initializer_list<int> counts) {
  for (int count : counts)
    benchmark::RegisterBenchmark((std::string("surface/") + row).c_str(), function)
        ->Arg(count)
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
}

const bool registered = [] {
  name("frame", whole_frame, {128'000, 1'000'000, 6'000'000});
  name("passes", passes, {1'000'000});
  name("screen", screen_part, {128'000, 6'000'000});
  for (const char* scene : {"1000000", "Guanyin.ply", "indoor.laz", "office1.pcd"}) {
    const auto row = [&](const char* what, const std::vector<std::string_view>& of, const char* removal) {
      add(std::string("surface/") + what + "/" + scene,
          [=](benchmark::State& state) { passes_of(state, scene, of, removal); });
    };
    row("geometry", {"depth", "index", "resolve"}, "pyramid");
    row("removal", {"hidden point removal"}, "pyramid");
    row("window", {"hidden point removal"}, "window");
    if (std::string_view(scene) != "1000000") continue;
    row("pull_push", {"pull-push"}, "pyramid");
    row("normals", {"normals"}, "pyramid");
  }
  name("copies", copies, {6, 16, 25});
  return true;
}();

}  // namespace
