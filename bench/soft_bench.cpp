// Table 1 and Figure 8 of Seemann 2018: the same cloud along a camera path by points, splats, the baseline
// and the three density models, with time and fragments; then the parts that have goals of their own.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <numeric>
#include <span>

#include "scene.h"

using namespace sfumato;
using namespace sfumato::bench;

namespace {

/// Pixels a side of the table: the interior models store every fragment.
constexpr int table_size = 512;

std::unique_ptr<Technique> soft_technique(const char* model) {
  auto technique = find_technique("soft").create();
  set(*technique, "model", model);
  return technique;
}

/// The number that a note of a picture begins with, whose passes are timed: "123 fragments". 0: there is
/// none.
double noted(const RenderOutput& out, const std::string& words) {
  for (const std::string& note : out.notes)
    if (note.find(words) != std::string::npos) return std::atof(note.c_str());
  return 0;
}

double fragments_of(const RenderOutput& out) { return noted(out, " fragments"); }

void technique_row(benchmark::State& state, const std::string& scene, const char* name) {
  auto technique = find_technique(name).create();
  time_frames(state, *technique, scene, RenderSettings{}, table_size, table_size);
}

/// Figure 8 flies; here it is a turn around the scene that comes to half the distance and back.
constexpr int path_frames = 12;
Camera on_path(const Stage& stage, int frame) {
  Camera camera = stage.camera(frame * 360 / path_frames, table_size, table_size);
  const double share = 0.75 + 0.25 * std::cos(2 * std::numbers::pi * frame / path_frames);
  camera.position = camera.target + share * (camera.position - camera.target);
  return camera;
}

struct ModelRow {
  const char* model = "express";
  bool every_point = false;  ///< as in Figure 8, whose cloud is vegetation
  bool path = false;
};

void model_row(benchmark::State& state, const std::string& scene, const ModelRow& row) {
  auto technique = soft_technique(row.model);
  if (row.every_point) {
    set(*technique, "field_threshold", "-1");
    set(*technique, "modulation_threshold", "-1");
  }
  const Stage stage = stage_of(scene, technique->needs());
  RenderWants wants;
  // Fragments are counted where passes are timed, for which each waits: not in rows beside those of splats.
  const std::string model = row.model;
  wants.timings = model == "base" || model == "concentric";
  const auto render = [&](int frame) {
    const Camera camera = row.path ? on_path(stage, frame) : stage.camera(frame, table_size, table_size);
    return stage.renderer.render(*technique, camera, RenderSettings{}, wants);
  };
  render(0);
  std::vector<double> fragments, ms;
  for (auto _ : state) {
    const RenderOutput out = render(int(ms.size()) + 1);
    state.SetIterationTime(1e-3 * out.total_ms);
    ms.push_back(out.total_ms);
    fragments.push_back(fragments_of(out));
    state.counters["soft_percent"] = row.every_point ? 100 : noted(out, " % of the points are soft");
  }
  state.counters["fragments"] = std::accumulate(fragments.begin(), fragments.end(), 0.0) / double(ms.size());
  if (!row.path) return;
  const auto ends = [&](const std::string& name, const std::vector<double>& values) {
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    state.counters["least_" + name] = *least;
    state.counters["most_" + name] = *most;
  };
  ends("fragments", fragments);
  ends("ms", ms);
}

/// Every point soft, discs of one radius (the mean spacing of the tori), as vtkPointGaussianMapper blends
/// them.
std::unique_ptr<Technique> all_soft(std::size_t count) {
  Renderer& renderer = tori_renderer(count, Attribute::normal);
  const double area = 4 * std::numbers::pi * std::numbers::pi * (0.45 + 0.30 + 0.15);
  renderer.complete(
      0, [](const PreparedCloud&) { return true; },
      [&](PreparedCloud& prepared) {
        prepared.cloud.radii.assign(prepared.cloud.size(), float(std::sqrt(area / double(count))));
        prepared.available = prepared.available | Attribute::radius;
      });
  auto technique = soft_technique("express");
  set(*technique, "field", "distance");
  set(*technique, "field_threshold", "-1");
  set(*technique, "modulation_threshold", "-1");
  set(*technique, "antialias", "false");
  set(*technique, "radius_scale", "1");
  return technique;
}

void all_soft_row(benchmark::State& state) {
  auto technique = all_soft(std::size_t(state.range(0)));
  time_frames(state, *technique, std::size_t(state.range(0)), plain_settings(Shading::lit));
}

/// Of a frame of `technique`: the milliseconds of the passes in `names`, over `scale`.
template <class Scale>
void passes_row(benchmark::State& state, Technique& technique, const std::vector<std::string>& names,
                int size, Scale scale) {
  Renderer& renderer = tori_renderer(std::size_t(state.range(0)), technique.needs());
  RenderWants wants;
  wants.timings = true;
  renderer.render(technique, tori_camera(0, size, size), RenderSettings{}, wants);
  int frame = 0;
  for (auto _ : state) {
    const RenderOutput out =
        renderer.render(technique, tori_camera(++frame, size, size), RenderSettings{}, wants);
    double ms = names.empty() ? out.total_ms : 0;
    for (const PassTiming& pass : out.timings)
      if (std::find(names.begin(), names.end(), pass.name) != names.end()) ms += pass.ms;
    if (!(ms > 0 && scale(out) > 0)) return state.SkipWithError("no point is soft");
    state.SetIterationTime(1e-3 * ms / scale(out));
  }
}

void sort_row(benchmark::State& state) {
  auto technique = all_soft(std::size_t(state.range(0)));
  passes_row(state, *technique, {"sort"}, 1024, [](const RenderOutput&) { return 1.0; });
}

/// What the soft points add to the frame: the solid ones cost every model the same.
void added_row(benchmark::State& state, const char* model) {
  auto technique = soft_technique(model);
  passes_row(state, *technique, {"soft points", "sort", "blend", "count", "prefix sum", "store", "resolve"},
             table_size, [](const RenderOutput&) { return 1.0; });
}

void fragments_row(benchmark::State& state, const std::vector<std::string>& passes) {
  auto technique = soft_technique("base");
  set(*technique, "field_threshold", "-1");
  passes_row(state, *technique, passes, table_size,
             [](const RenderOutput& out) { return fragments_of(out) * 1e-6; });
}

benchmark::internal::Benchmark* name(const std::string& row,
                                     const std::function<void(benchmark::State&)>& function) {
  return add("soft/" + row, function);
}

const bool registered = [] {
  const auto row = [](const std::string& what, const std::string& scene, const ModelRow& of) {
    return name(what + of.model + "/" + scene, [=](benchmark::State& state) { model_row(state, scene, of); });
  };
  const char* const tori[] = {"128000", "1000000"};
  const char* const scans[] = {"bcts_3.laz", "indoor.laz", "lion_takanawa.copc.laz"};
  for (const auto& scenes : {std::span<const char* const>(tori), std::span<const char* const>(scans)})
    for (const std::string scene : scenes) {
      for (const char* technique : {"points", "splats"})
        name(technique + ("/" + scene),
             [=](benchmark::State& state) { technique_row(state, scene, technique); });
      for (const char* model : {"one_layer", "express"}) row("", scene, {model});
    }
  for (const char* model : {"express", "concentric", "base"}) {
    for (const char* scene : tori) row("every_point_", scene, {model, true});
    for (const char* scene : scans) {
      row("path_", scene, {model, false, true})->Iterations(path_frames);
      row("path_every_point_", scene, {model, true, true})->Iterations(path_frames);
    }
  }
  for (const char* model : {"concentric", "base"})
    for (const char* scene : tori) row("", scene, {model});
  for (int count : {128'000, 1'000'000})
    for (const char* model : {"express", "concentric", "base"})
      name(std::string("added_by_") + model, [=](benchmark::State& state) {
        added_row(state, model);
      })->Arg(count);
  name("all_soft", all_soft_row)->Arg(1'000'000);
  name("sort", sort_row)->Arg(1'000'000);
  name("insert",
       [](benchmark::State& state) {
         fragments_row(state, {"count", "prefix sum", "store"});
       })
      ->Arg(1'000'000)
      ->Iterations(3);
  name("frame", [](benchmark::State& state) { fragments_row(state, {}); })->Arg(1'000'000)->Iterations(3);
  return true;
}();

}  // namespace
