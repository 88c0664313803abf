#include <cmath>
#include <numbers>

#include "scene.h"

using namespace sfumato;
using namespace sfumato::bench;

namespace {

/// Discs of one radius, the mean spacing of the tori (peers/peer_vtk.py), as vtkPointGaussianMapper draws
/// them.
void give_one_radius(std::size_t count) {
  Renderer& renderer = tori_renderer(count, Attribute::normal);
  const double area = 4 * std::numbers::pi * std::numbers::pi * (0.45 + 0.30 + 0.15);
  renderer.complete(
      0, [](const PreparedCloud&) { return true; },
      [&](PreparedCloud& prepared) {
        prepared.cloud.radii.assign(prepared.cloud.size(), float(std::sqrt(area / double(count))));
        prepared.median_radius = prepared.cloud.radii.empty() ? 0 : prepared.cloud.radii.front();
        prepared.available = prepared.available | Attribute::radius;
      });
}

void same_radius(benchmark::State& state, const char* blend) {
  const std::size_t count = std::size_t(state.range(0));
  give_one_radius(count);
  auto technique = find_technique("splats").create();
  set(*technique, "antialias", "false");
  set(*technique, "radius_scale", "1");
  set(*technique, "blend", blend);
  time_frames(state, *technique, count, plain_settings(Shading::lit));
}

void default_look(benchmark::State& state) {
  auto technique = find_technique("splats").create();
  time_frames(state, *technique, std::size_t(state.range(0)), RenderSettings{});
}

void name(const char* row, void (*function)(benchmark::State&), std::initializer_list<int> counts) {
  for (int count : counts)
    benchmark::RegisterBenchmark((std::string("splats/") + row).c_str(), function)
        ->Arg(count)
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
}

const bool registered = [] {
  name("weighted", [](benchmark::State& state) { same_radius(state, "weighted"); },
       {128'000, 1'000'000, 6'000'000});
  name("opaque", [](benchmark::State& state) { same_radius(state, "opaque"); }, {1'000'000});
  name("default", default_look, {1'000'000});
  return true;
}();

}  // namespace
