// The rows of Table 1 of Dobrev, Rosenthal, Linsen 2010, and what peers and bounds are compared with.
#include <algorithm>
#include <map>

#include "analysis/prepare.h"
#include "io/io.h"
#include "isosurface.h"
#include "scene.h"
#include "synth/synth.h"

using namespace sfumato;
using namespace sfumato::bench;

namespace {

using Options = std::vector<std::pair<const char*, const char*>>;

const Options paper{{"point_shape", "round"},
                    {"background_iterations", "1"},
                    {"occluded_iterations", "1"},
                    {"point_size", "0.01"}};
const Options bare{{"background_iterations", "0"}, {"occluded_iterations", "0"},
                   {"smoothing_iterations", "0"},  {"antialias", "false"},
                   {"scale_by_angle", "false"},    {"point_shape", "round"},
                   {"point_size", "0.01"}};

/// Points on the faces of a scan.
PointCloud on_faces(const char* file, int points) {
  synth::SampleOptions options;
  options.points = points;
  options.normals.user = true;
  return synth::sample(synth::make_mesh_scene(io::read_mesh(data_folder() / file)), options);
}

PointCloud make_cloud(const std::string& name) {
  if (name == "dragon") return on_faces("dragon_vrip_res2.ply", 437'000);
  if (name == "armadillo") return on_faces("armadillo.obj", 883'000);  // in place of Blade
  return isosurfaces(data_folder() / "volumes", name);
}

/// A frame per iteration: the camera turns, and with shadows the light too, so that they are found anew.
/// With `passes`, the milliseconds of each shadow pass are counters beside it.
void frames(benchmark::State& state, const std::string& scene, int layers, const Options& options,
            const char* opacity, int light_samples, bool passes, int size) {
  auto technique = find_technique("layers").create();
  set(*technique, "layers", std::to_string(layers));
  set(*technique, "opacity", opacity);
  for (const auto& [name, value] : options) set(*technique, name, value);
  const bool is_tori = scene.starts_with("tori");
  const std::size_t count = is_tori ? std::size_t(std::stoul(scene.substr(4))) : 0;
  Renderer& renderer =
      is_tori ? tori_renderer(count) : cloud_renderer(scene, [&] { return make_cloud(scene); });
  const PreparedCloud& prepared = renderer.prepared();
  const Bounds box = bounds(prepared.cloud);
  RenderSettings settings;
  settings.shadows = light_samples > 0 ? Shadows::soft : Shadows::off;
  settings.light_samples = std::max(light_samples, 1);
  RenderWants wants;
  wants.timings = passes;
  std::map<std::string, std::vector<double>> ms;
  auto render = [&](int k) {
    if (light_samples > 0) settings.light_text = "dir:1," + std::to_string(-1 - 0.01 * k) + ",2";
    const Camera camera = is_tori ? tori_camera(k, size, size)
                                  : sfumato::frame(box, prepared.cloud.up, size, size,
                                                   glm::radians(-45.0 + k), glm::radians(30.0));
    const RenderOutput out = renderer.render(*technique, camera, settings, wants);
    for (const PassTiming& pass : out.timings)
      if (k > 0 && (pass.name.starts_with("light ") || pass.name == "lit test"))
        ms[pass.name].push_back(pass.ms);
    return out.total_ms;
  };
  render(0);
  int k = 0;
  for (auto _ : state) state.SetIterationTime(1e-3 * render(++k));
  for (auto& [name, times] : ms) {
    std::nth_element(times.begin(), times.begin() + std::ptrdiff_t(times.size() / 2), times.end());
    state.counters[name] = times[times.size() / 2];
  }
}

void row(const std::string& name, const std::string& scene, int layers, const Options& options,
         const char* opacity = "0.3", int light_samples = 0, bool passes = false, int size = 1024) {
  add("layers/" + name + "/" + scene, [=](benchmark::State& state) {
    frames(state, scene, layers, options, opacity, light_samples, passes, size);
  })->Iterations(passes ? 5 : 3);
}

Options with(Options options, const char* name, const char* value) {
  options.push_back({name, value});
  return options;
}

const bool registered = [] {
  for (const char* scene : {"tori1000000", "tori6000000"}) {
    row("filtered4", scene, 4, paper, "0.5");
    row("bare4", scene, 4, bare, "0.5");
  }
  row("default", "tori1000000", 4, {}, "0.5");
  for (const char* scene : {"tori128000", "tori1000000", "tori6000000"})
    for (const char* peeling : {"passes", "cascade"})
      row(std::string(peeling) + "6", scene, 6, with(paper, "peeling", peeling));
  for (const char* scene : {"armadillo", "dragon", "neghip", "hydrogen", "tori6000000"}) {
    for (int size : {512, 1024}) {
      const std::string at = size == 512 ? "_512" : "";
      row("light" + at, scene, 1, paper, "1", 0, false, size);
      for (int layers : {3, 6})
        row("layers" + std::to_string(layers) + at, scene, layers, paper, "0.3", 0, false, size);
      for (int samples : {1, 5, 10})
        row("shadows" + std::to_string(samples) + at, scene, 1, paper, "1", samples, false, size);
    }
    for (int samples : {1, 5, 10})
      row("shadow_passes" + std::to_string(samples), scene, 1, paper, "1", samples, true);
  }
  return true;
}();

}  // namespace
