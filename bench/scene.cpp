#include "scene.h"

#include <chrono>

#include "analysis/prepare.h"
#include "gl/context.h"
#include "io/io.h"
#include "tori.h"

namespace sfumato::bench {

Renderer& cloud_renderer(const std::string& name, const std::function<PointCloud()>& make, Attributes needs) {
  static std::unique_ptr<gl::Context> context = gl::Context::create_headless();
  static Renderer renderer(*context);
  static std::string loaded;
  if (loaded != name || !needs.without(renderer.prepared().available).empty()) {
    PreparedCloud prepared = analysis::prepare(make(), needs, {});
    std::vector<Rgba8> colors = prepared.cloud.colors;
    if (colors.empty()) colors.assign(prepared.cloud.size(), Rgba8{180, 180, 180, 255});
    for (Rgba8& c : colors) c.a = 255;
    renderer.set_cloud(std::move(prepared), std::move(colors));
    loaded = name;
  }
  return renderer;
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

void time_frames(benchmark::State& state, Technique& technique, std::size_t count,
                 const RenderSettings& settings, int width, int height) {
  Renderer& renderer = tori_renderer(count, technique.needs());
  warm_up(renderer, technique, tori_camera(0, width, height), settings);
  int frame = 0;
  for (auto _ : state)
    state.SetIterationTime(
        1e-3 * renderer.render(technique, tori_camera(++frame, width, height), settings).total_ms);
}

}  // namespace sfumato::bench
