// A frame of denoise against a frame of splats of the same radius, and the sizes of the hash table.
#include "scene.h"

using namespace sfumato;
using namespace sfumato::bench;

namespace {

constexpr std::size_t count = 1'000'000;

void frame_of(benchmark::State& state, const char* name, bool fast, int hash_bits) {
  auto technique = find_technique(name).create();
  set(*technique, "radius_scale", "1");
  if (hash_bits) set(*technique, "hash_bits", std::to_string(hash_bits));
  RenderSettings settings = plain_settings(Shading::lit);
  settings.fast = fast;
  time_frames(state, *technique, count, settings);
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
