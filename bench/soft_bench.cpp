// Table 1 and Figure 8 of Seemann 2018: the same cloud along a camera path by points, splats, the baseline
// and the three density models, with time and fragments; then the parts that have goals of their own.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

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

/// "123 fragments" among the notes of a picture.
double fragments_of(const RenderOutput& out) {
  for (const std::string& note : out.notes)
    if (note.ends_with(" fragments")) return std::atof(note.c_str());
  return 0;
}

void technique_row(benchmark::State& state, const char* name) {
  auto technique = find_technique(name).create();
  time_frames(state, *technique, std::size_t(state.range(0)), RenderSettings{}, table_size, table_size);
}

void model_row(benchmark::State& state, const char* model, bool every_point = false) {
  const std::size_t count = std::size_t(state.range(0));
  auto technique = soft_technique(model);
  if (every_point) {  // as in Figure 8, whose cloud is vegetation
    set(*technique, "field_threshold", "-1");
    set(*technique, "modulation_threshold", "-1");
  }
  Renderer& renderer = tori_renderer(count, technique->needs());
  renderer.render(*technique, tori_camera(0, table_size, table_size), RenderSettings{});
  double fragments = 0;
  int frame = 0;
  for (auto _ : state) {
    const RenderOutput out =
        renderer.render(*technique, tori_camera(++frame, table_size, table_size), RenderSettings{});
    state.SetIterationTime(1e-3 * out.total_ms);
    fragments += fragments_of(out);
  }
  state.counters["fragments"] = benchmark::Counter(fragments, benchmark::Counter::kAvgIterations);
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
  passes_row(state, *technique, passes, table_size,
             [](const RenderOutput& out) { return fragments_of(out) * 1e-6; });
}

void name(const std::string& row, const std::function<void(benchmark::State&)>& function, int count) {
  benchmark::RegisterBenchmark(("soft/" + row).c_str(), function)
      ->Arg(count)
      ->UseManualTime()
      ->MeasureProcessCPUTime()  // all threads: what a busy machine does not change
      ->Unit(benchmark::kMillisecond);
}

const bool registered = [] {
  for (int count : {128'000, 1'000'000}) {
    for (const char* technique : {"points", "splats"})
      name(
          technique, [=](benchmark::State& state) { technique_row(state, technique); }, count);
    for (const char* model : {"one_layer", "express", "concentric", "base"})
      name(
          model, [=](benchmark::State& state) { model_row(state, model); }, count);
    for (const char* model : {"express", "concentric", "base"}) {
      name(
          std::string("added_by_") + model, [=](benchmark::State& state) { added_row(state, model); }, count);
      name(
          std::string("every_point_") + model,
          [=](benchmark::State& state) { model_row(state, model, true); }, count);
    }
  }
  name("all_soft", all_soft_row, 1'000'000);
  name("sort", sort_row, 1'000'000);
  name(
      "insert",
      [](benchmark::State& state) {
        fragments_row(state, {"count", "prefix sum", "store"});
      },
      1'000'000);
  name(
      "frame", [](benchmark::State& state) { fragments_row(state, {}); }, 1'000'000);
  return true;
}();

}  // namespace
