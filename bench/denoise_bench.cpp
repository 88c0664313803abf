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

/// Ten RGB-D cameras in a room.
PointCloud room() {
  synth::SampleOptions options;
  options.noise = synth::NoiseModel::structured_light;
  return synth::sample(synth::make_scene("room"), options);
}

Stage scene_of(const std::string& name, Attributes needs) {
  if (name == "room") {
    const Camera held_out = *synth::make_scene(name).held_out;
    return {cloud_renderer(name, room, needs), [held_out](int frame, int width, int height) {
              return turned(held_out.resized(width, height), dvec3(0, 0, 1), frame);
            }};
  }
  if (name != "1000000") return stage_of(name, needs);
  Renderer& renderer = cloud_renderer("spheres", spheres, needs);
  const Bounds box = bounds(renderer.prepared().cloud);
  return {renderer, [box](int frame, int width, int height) {
            return sfumato::frame(box, UpAxis::pos_z, width, height, glm::radians(double(frame) - 45),
                                  glm::radians(30.0));
          }};
}

void frame_of(benchmark::State& state, const std::string& scene, const char* name, bool fast, int hash_bits) {
  auto technique = find_technique(name).create();
  if (hash_bits) set(*technique, "hash_bits", std::to_string(hash_bits));
  RenderSettings settings = plain_settings(Shading::lit);
  settings.fast = fast;
  const Stage stage = scene_of(scene, technique->needs());
  const auto render = [&](int frame) {
    return stage.renderer.render(*technique, stage.camera(frame, 1024, 1024), settings).total_ms;
  };
  render(0);  // shaders, uploads, the support of the splats
  int frame = 0;
  for (auto _ : state) state.SetIterationTime(1e-3 * render(++frame));
  if (hash_bits) state.counters["table_MiB"] = 1024.0 * 1024 * (8 * (1 << hash_bits) + 32) / (1 << 20);
}

void row(const std::string& name, const std::string& scene, const char* technique, bool fast, int hash_bits) {
  add("denoise/" + name + "/" + scene,
      [=](benchmark::State& state) { frame_of(state, scene, technique, fast, hash_bits); });
}

const bool registered = [] {
  for (const char* scene :
       {"1000000", "room", "indoor.laz", "bcts_3.laz", "lion_takanawa.copc.laz", "office1.pcd"}) {
    row("splats", scene, "splats", false, 0);
    row("deterministic", scene, "denoise", false, 4);
    row("fast", scene, "denoise", true, 4);
  }
  for (int bits = 1; bits <= 6; ++bits)
    row("hash_" + std::to_string(bits), "1000000", "denoise", false, bits);
  return true;
}();

}  // namespace
