// A frame of denoise against a frame of splats of the same radius, and the sizes of the hash table.
#include "scene.h"
#include "synth/synth.h"

using namespace sfumato;
using namespace sfumato::bench;

namespace {

/// A million points on spheres beside each other: a ray meets mostly two surfaces.
PointCloud spheres() {
  synth::SampleOptions options;
  options.points = 1'000'000;
  return synth::sample(synth::make_scene("spheres"), options);
}

void frame_of(benchmark::State& state, const char* name, bool fast, int hash_bits) {
  auto technique = find_technique(name).create();
  if (hash_bits) set(*technique, "hash_bits", std::to_string(hash_bits));
  RenderSettings settings = plain_settings(Shading::lit);
  settings.fast = fast;
  Renderer& renderer = cloud_renderer("spheres", spheres, technique->needs());
  const Bounds box = bounds(renderer.prepared().cloud);
  auto camera = [&](int frame) {
    return sfumato::frame(box, UpAxis::pos_z, 1024, 1024, glm::radians(double(frame) - 45),
                          glm::radians(30.0));
  };
  renderer.render(*technique, camera(0), settings);  // shaders, uploads, the support of the splats
  int frame = 0;
  for (auto _ : state)
    state.SetIterationTime(1e-3 * renderer.render(*technique, camera(++frame), settings).total_ms);
  if (hash_bits) state.counters["table_MiB"] = 1024.0 * 1024 * (8 * (1 << hash_bits) + 32) / (1 << 20);
}

void name(const std::string& row, void (*function)(benchmark::State&)) {
  benchmark::RegisterBenchmark(("denoise/" + row + "/1000000").c_str(), function)
      ->UseManualTime()
      ->Unit(benchmark::kMillisecond);
}

template <int bits>
void hashed(benchmark::State& state) {
  frame_of(state, "denoise", false, bits);
}

const bool registered = [] {
  name("splats", [](benchmark::State& state) { frame_of(state, "splats", false, 0); });
  name("deterministic", [](benchmark::State& state) { frame_of(state, "denoise", false, 4); });
  name("fast", [](benchmark::State& state) { frame_of(state, "denoise", true, 4); });
  name("hash_1", hashed<1>);
  name("hash_2", hashed<2>);
  name("hash_3", hashed<3>);
  name("hash_4", hashed<4>);
  name("hash_5", hashed<5>);
  name("hash_6", hashed<6>);
  return true;
}();

}  // namespace
