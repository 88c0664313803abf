// What a GPU does with clouds that fill its memory, beside what its memory can do: scripts/gpu-report.
#include <unistd.h>

#include <atomic>
#include <thread>

#include "gl/context.h"
#include "scene.h"
#include "tori.h"

using namespace sfumato;
using namespace sfumato::bench;

namespace {

/// The tori of `tori.h` in parts of a million, each of its own seed, made by all processors.
PointCloud tori_in_parts(std::size_t count) {
  constexpr std::size_t part = 1'000'000;
  PointCloud cloud;
  cloud.positions.resize(count);
  cloud.colors.resize(count);
  std::atomic<std::size_t> next{0};
  const auto fill = [&] {
    for (std::size_t first; (first = next.fetch_add(part)) < count;) {
      const std::vector<TorusPoint> points = tori(std::min(part, count - first), Order::random, first + 1);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const TorusPoint& p = points[i];
        cloud.positions[first + i] = {p.position[0], p.position[1], p.position[2]};
        cloud.colors[first + i] = {p.rgba[0], p.rgba[1], p.rgba[2], 255};
      }
    }
  };
  std::vector<std::jthread> workers;
  for (unsigned k = 0; k < std::max(1u, std::thread::hardware_concurrency()); ++k) workers.emplace_back(fill);
  workers.clear();
  return cloud;
}

/// Sorting holds the cloud twice, with its keys: 90 bytes a point at the peak.
PointCloud tori_that_fit(std::size_t count) {
  const double needed = 90.0 * double(count),
               free = double(sysconf(_SC_AVPHYS_PAGES)) * double(sysconf(_SC_PAGESIZE));
  if (needed > free)
    throw Error(ErrorCode::out_of_memory,
                "needs " + std::to_string(std::int64_t(needed / 1e9)) + " GB of free memory");
  return tori_in_parts(count);
}

/// Frames of `count` points at 1920 x 1080, all of them in the memory of the GPU.
void resident(benchmark::State& state, const char* technique_name) {
  const std::size_t count = std::size_t(state.range(0));
  auto technique = find_technique(technique_name).create();
  const RenderSettings settings;
  Renderer* loaded = nullptr;
  try {
    loaded = &cloud_renderer(
        "tori in parts " + std::to_string(count), [&] { return tori_that_fit(count); }, technique->needs());
  } catch (const Error& error) {
    state.SkipWithError(error.what());
    return;
  }
  Renderer& renderer = *loaded;
  warm_up(renderer, *technique, tori_camera(0, 1920, 1080), settings);
  int frame = 0;
  double seconds = 0;
  for (auto _ : state) {
    const double ms = renderer.render(*technique, tori_camera(++frame, 1920, 1080), settings).total_ms;
    state.SetIterationTime(1e-3 * ms);
    seconds += 1e-3 * ms;
  }
  state.counters["points_per_second"] = double(count) * frame / seconds;
}

/// A kernel that copies as much as one storage buffer may hold, at most 1 GiB: bytes read and written a
/// second.
void copy(benchmark::State& state) {
  cloud_renderer("tori in parts 1000", [] { return tori_in_parts(1000); }, {});  // a context
  const std::size_t bytes =
      std::min<std::size_t>(std::size_t(gl::limits().max_storage_block_size), std::size_t(1) << 30) / 4096 *
      4096;
  const gl::Buffer from("from", bytes), to("to", bytes);
  const char* const source = R"(#version 450
    layout(local_size_x = 256) in;
    layout(std430, binding = 0) readonly buffer From { vec4 from[]; };
    layout(std430, binding = 1) writeonly buffer To { vec4 to[]; };
    void main() {
      uint i = gl_GlobalInvocationID.x + gl_GlobalInvocationID.y * gl_NumWorkGroups.x * gl_WorkGroupSize.x;
      if (i < from.length()) to[i] = from[i];
    })";
  const GLuint program = glCreateShaderProgramv(GL_COMPUTE_SHADER, 1, &source);
  glUseProgram(program);
  from.bind_storage(0);
  to.bind_storage(1);
  const GLuint groups = GLuint(bytes / 4096), rows = (groups + 32767) / 32768;
  for (auto _ : state) {
    glFinish();
    const auto start = std::chrono::steady_clock::now();
    for (int k = 0; k < 10; ++k) glDispatchCompute(std::min(groups, 32768u), rows, 1);
    glFinish();
    state.SetIterationTime(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() /
                           10);
  }
  state.SetBytesProcessed(std::int64_t(2 * bytes) * std::int64_t(state.iterations()));
  glDeleteProgram(program);
}

const bool registered = [] {
  benchmark::RegisterBenchmark("gpu/copy", copy)->UseManualTime()->Unit(benchmark::kMillisecond);
  for (int millions : {10, 100, 1000})
    for (const char* technique : {"points", "surface"})
      benchmark::RegisterBenchmark((std::string("gpu/") + technique).c_str(),
                                   [technique](benchmark::State& state) { resident(state, technique); })
          ->Arg(std::int64_t(millions) * 1'000'000)
          ->UseManualTime()
          ->Unit(benchmark::kMillisecond)
          ->Iterations(20);
  return true;
}();

}  // namespace
