#include "scene.h"

using namespace sfumato;
using namespace sfumato::bench;

namespace {

/// The peers' look: one pixel a point, unlit, clear to finished RGBA8 on the GPU.
void plain(benchmark::State& state, bool edl) {
  auto technique = find_technique("points").create();
  set(*technique, "size_mode", "pixels");
  set(*technique, "point_size", "1");
  time_frames(state, *technique, std::size_t(state.range(0)), plain_settings(Shading::albedo, edl));
}

void default_look(benchmark::State& state) {
  auto technique = find_technique("points").create();
  time_frames(state, *technique, std::size_t(state.range(0)), RenderSettings{});
}

void name(const char* row, void (*function)(benchmark::State&), std::initializer_list<int> counts) {
  for (int count : counts)
    benchmark::RegisterBenchmark((std::string("points/") + row).c_str(), function)
        ->Arg(count)
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
}

const bool registered = [] {
  name("plain", [](benchmark::State& state) { plain(state, false); }, {128'000, 1'000'000, 6'000'000});
  name("edl", [](benchmark::State& state) { plain(state, true); }, {1'000'000});
  name("default", default_look, {1'000'000});
  return true;
}();

}  // namespace
