// Reading files, warm in the page cache: what a user waits for before anything is drawn.
#include <benchmark/benchmark.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "analysis/prepare.h"
#include "core/error.h"
#include "io/io.h"
#include "tori.h"

namespace {

using namespace sfumato;

void read_ply(benchmark::State& state) {
  const auto file = bench::tori_file(std::size_t(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(io::read(file));
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(read_ply)->Name("io/ply")->Arg(1'000'000)->Arg(6'000'000)->UseRealTime()->Unit(
    benchmark::kMillisecond);

void read_and_sort_ply(benchmark::State& state) {
  const auto file = bench::tori_file(std::size_t(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(analysis::prepare(io::read(file).cloud, {}, {}));
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(read_and_sort_ply)
    ->Name("io/ply_sorted")
    ->Arg(1'000'000)
    ->Arg(6'000'000)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

/// The floor: one fread and a copy of position and colour to 16 bytes a point, without a check.
void fread_and_repack(benchmark::State& state) {
  struct Packed {
    float xyz[3];
    std::uint8_t rgba[4];
  };
  const std::size_t count = std::size_t(state.range(0));
  const std::string file = bench::tori_file(count).string();
  for (auto _ : state) {
    std::vector<bench::TorusPoint> records(count);
    std::vector<Packed> points(count);
    std::FILE* in = std::fopen(file.c_str(), "rb");
    char line[256];
    while (std::fgets(line, sizeof line, in) && std::strncmp(line, "end_header", 10) != 0) {
    }
    const bool complete = std::fread(records.data(), sizeof records[0], count, in) == count;
    std::fclose(in);
    if (!complete) return state.SkipWithError("short tori file");
    for (std::size_t i = 0; i < count; ++i) {
      std::memcpy(points[i].xyz, records[i].position, sizeof points[i].xyz);
      std::memcpy(points[i].rgba, records[i].rgba.data(), sizeof points[i].rgba);
    }
    benchmark::DoNotOptimize(points.data());
  }
}
BENCHMARK(fread_and_repack)
    ->Name("io/fread_repack")
    ->Arg(1'000'000)
    ->Arg(6'000'000)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

/// A real airborne scan of 887,254 points in 18 chunks, decoded on `threads` threads.
void read_laz(benchmark::State& state, const char* threads) {
  const char* folder = std::getenv("SFUMATO_TEST_DATA");
  const std::string file = std::string(folder ? folder : "../shared/data") + "/bcts_3.laz";
  setenv("SFUMATO_THREADS", threads, 1);
  try {
    for (auto _ : state) benchmark::DoNotOptimize(io::read(file));
  } catch (const Error& error) {
    state.SkipWithError(error.what());
  }
  unsetenv("SFUMATO_THREADS");
}
BENCHMARK_CAPTURE(read_laz, one, "1")
    ->Name("io/laz/one_thread")
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_laz, two, "2")
    ->Name("io/laz/two_threads")
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
