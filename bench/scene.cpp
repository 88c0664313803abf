#include "scene.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cstdlib>

#include "analysis/prepare.h"
#include "gl/context.h"
#include "io/io.h"
#include "session/opening.h"
#include "session/session.h"
#include "tori.h"

namespace sfumato::bench {
namespace {

/// One cloud at a time, and how it presents itself if it is a scan.
struct Loaded {
  std::unique_ptr<gl::Context> context = gl::Context::create_headless();
  Renderer renderer{*context};
  std::string name;
  Pose pose;
  bool is(const std::string& wanted, Attributes needs) const {
    return name == wanted && renderer.prepared().lacking(needs).empty();
  }
};

Loaded& loaded() {
  static Loaded only;
  return only;
}

Loaded& loaded_scan(const std::string& file, Attributes needs) {
  Loaded& now = loaded();
  if (now.is(file, needs)) return now;
  Opening opening({}, scene::files_of({(data_folder() / file).string()}));
  Session session(*now.context);
  session.set_scene(opening.take(), opening.pose(), {});
  session.measure(needs);
  now.pose = session.pose();
  now.renderer.set_cloud(session.prepared(), session.colors());
  now.renderer.set_room(now.pose.subject.room);
  now.name = file;
  return now;
}

}  // namespace

Renderer& cloud_renderer(const std::string& name, const std::function<PointCloud()>& make, Attributes needs) {
  Loaded& now = loaded();
  if (!now.is(name, needs)) {
    PreparedCloud prepared = analysis::prepare(make(), needs, {});
    std::vector<Rgba8> colors = prepared.cloud.colors;
    if (colors.empty()) colors.assign(prepared.cloud.size(), Rgba8{180, 180, 180, 255});
    for (Rgba8& c : colors) c.a = 255;
    now.renderer.set_cloud(std::move(prepared), std::move(colors));
    now.renderer.set_room({});
    now.name = name;
  }
  return now.renderer;
}

Renderer& tori_renderer(std::size_t count, Attributes needs) {
  return cloud_renderer(
      "tori " + std::to_string(count), [&] { return io::read(tori_file(count)).cloud; }, needs);
}

Camera tori_camera(int frame, int width, int height) {
  Camera camera;
  const double angle = glm::radians(double(frame));
  camera.position = {3.2 * std::sin(angle), -3.2 * std::cos(angle), 2.2};
  camera.target = {0, 0, 0};
  camera.width = width;
  camera.height = height;
  return camera;
}

std::filesystem::path data_folder() {
  const char* folder = std::getenv("SFUMATO_TEST_DATA");
  return folder ? folder : "../shared/data";
}

Camera turned(const Camera& start, const dvec3& up, int frame) {
  return orbit(start, up, 360, 360)[std::size_t(frame % 360)];
}

Stage stage_of(const std::string& scene, Attributes needs) {
  if (std::all_of(scene.begin(), scene.end(), [](unsigned char c) { return std::isdigit(c); }))
    return {tori_renderer(std::stoul(scene), needs), tori_camera};
  Loaded& now = loaded_scan(scene, needs);
  return {now.renderer, [&now](int frame, int width, int height) {
            return turned(first_view(now.pose, width, height), now.pose.vertical(), frame);
          }};
}

benchmark::internal::Benchmark* add(const std::string& name,
                                    const std::function<void(benchmark::State&)>& run) {
  return benchmark::RegisterBenchmark(name.c_str(),
                                      [run](benchmark::State& state) {
                                        try {
                                          run(state);
                                        } catch (const std::exception& error) {
                                          state.SkipWithError(error.what());
                                        }
                                      })
      ->UseManualTime()
      ->MeasureProcessCPUTime()  // all threads: what a busy machine does not change
      ->Unit(benchmark::kMillisecond);
}

RenderSettings plain_settings(Shading shading, bool edl) {
  RenderSettings settings;
  settings.shading = shading;
  settings.edl.user = edl;
  settings.ambient_occlusion.user = 0, settings.smooth_outlines.user = false;  // peers have neither
  return settings;
}

void warm_up(Renderer& renderer, Technique& technique, const Camera& camera, const RenderSettings& settings) {
  const auto start = std::chrono::steady_clock::now();
  do renderer.render(technique, camera, settings);
  while (!gl::limits().software && std::chrono::steady_clock::now() - start < std::chrono::seconds(1));
}

void time_frames(benchmark::State& state, Technique& technique, const std::string& scene,
                 const RenderSettings& settings, int width, int height) {
  const Stage stage = stage_of(scene, technique.needs());
  warm_up(stage.renderer, technique, stage.camera(0, width, height), settings);
  int frame = 0;
  for (auto _ : state)
    state.SetIterationTime(
        1e-3 * stage.renderer.render(technique, stage.camera(++frame, width, height), settings).total_ms);
}

void time_frames(benchmark::State& state, Technique& technique, std::size_t count,
                 const RenderSettings& settings, int width, int height) {
  time_frames(state, technique, std::to_string(count), settings, width, height);
}

}  // namespace sfumato::bench
