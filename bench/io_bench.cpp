// Reading files, warm in the page cache: what a user waits for before anything is drawn.
#include <benchmark/benchmark.h>
#include <laszip/laszip_api.h>
#include <time.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "analysis/prepare.h"
#include "core/error.h"
#include "core/threads.h"
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

/// Seconds of the processor, all threads: what a busy machine does not change.
double processor_seconds() {
  struct timespec time {};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

/// The tori in another format, with normals and colours (text: without normals where `columns` is 6, places
/// alone where it is 3).
std::string written_tori(std::size_t count, const std::string& extension, int columns) {
  std::filesystem::path file = bench::tori_file(count);
  file.replace_filename(file.stem().string() + "_" + std::to_string(columns) + extension);
  if (!std::filesystem::exists(file)) {
    PointCloud cloud = io::read(bench::tori_file(count)).cloud;
    if (columns < 9) cloud.normals.clear();
    if (columns < 6) cloud.colors.clear();
    if (extension == ".xyz")  // as files have them: millimetres
      for (vec3& place : cloud.positions) place = glm::round(place * 1000.0f) / 1000.0f;
    io::write(file, cloud);
  }
  return file.string();
}

/// One thread.
void read_format(benchmark::State& state, const char* extension, int columns) {
  const std::string file = written_tori(std::size_t(state.range(0)), extension, columns);
  set_thread_count(1);
  setenv("SFUMATO_THREADS", "1", 1);
  for (auto _ : state) {
    const double before = processor_seconds();
    benchmark::DoNotOptimize(io::read(file));
    state.SetIterationTime(processor_seconds() - before);
  }
  set_thread_count(0);
  unsetenv("SFUMATO_THREADS");
}

#define SFUMATO_BENCH_FORMAT(name, ...) \
  BENCHMARK_CAPTURE(name, __VA_ARGS__)->Arg(1'000'000)->UseManualTime()->Unit(benchmark::kMillisecond)
SFUMATO_BENCH_FORMAT(read_format, las, ".las", 6)->Name("io/las/processor");
SFUMATO_BENCH_FORMAT(read_format, ply, ".ply", 6)->Name("io/ply/processor");
SFUMATO_BENCH_FORMAT(read_format, pcd, ".pcd", 6)->Name("io/pcd/processor");
SFUMATO_BENCH_FORMAT(read_format, xyz, ".xyz", 3)->Name("io/text3/processor");
SFUMATO_BENCH_FORMAT(read_format, xyzrgb, ".xyz", 6)->Name("io/text6/processor");

std::string data_file(const char* name) {
  const char* folder = std::getenv("SFUMATO_TEST_DATA");
  return std::string(folder ? folder : "../shared/data") + "/" + name;
}

/// A real scan, decoded on `threads` threads.
void read_laz(benchmark::State& state, const char* name, const char* threads) {
  const std::string file = data_file(name);
  setenv("SFUMATO_THREADS", threads, 1);
  try {
    for (auto _ : state) benchmark::DoNotOptimize(io::read(file));
  } catch (const Error& error) {
    state.SkipWithError(error.what());
  }
  unsetenv("SFUMATO_THREADS");
}
// 887,254 points of point format 1 in 18 chunks; 341,989 of LAS 1.4 with colour in the nodes of a COPC.
#define SFUMATO_BENCH_LAZ(id, file, threads) \
  BENCHMARK_CAPTURE(read_laz, id, file, threads)->UseRealTime()->Unit(benchmark::kMillisecond)
SFUMATO_BENCH_LAZ(one, "bcts_3.laz", "1")->Name("io/laz/one_thread");
SFUMATO_BENCH_LAZ(two, "bcts_3.laz", "2")->Name("io/laz/two_threads");
SFUMATO_BENCH_LAZ(one14, "lion_takanawa.copc.laz", "1")->Name("io/laz14/one_thread");
SFUMATO_BENCH_LAZ(two14, "lion_takanawa.copc.laz", "2")->Name("io/laz14/two_threads");

/// Processor time of one thread, decoding in this process.
void read_laz_processor(benchmark::State& state, const char* name) {
  const std::string file = data_file(name);
  setenv("SFUMATO_THREADS", "1", 1);
  setenv("SFUMATO_DECODER", "none", 1);
  try {
    for (auto _ : state) {
      const double start = processor_seconds();
      benchmark::DoNotOptimize(io::read(file));
      state.SetIterationTime(processor_seconds() - start);
    }
  } catch (const Error& error) {
    state.SkipWithError(error.what());
  }
  unsetenv("SFUMATO_THREADS");
  unsetenv("SFUMATO_DECODER");
}

/// LASzip's own reader, which hands every point over and keeps none: what nobody who decodes by it can be
/// faster than.
void read_laszip(benchmark::State& state, const char* name) {
  const std::string file = data_file(name);
  for (auto _ : state) {
    const double start = processor_seconds();
    laszip_POINTER reader = nullptr;
    laszip_header* header = nullptr;
    laszip_point* point = nullptr;
    laszip_BOOL compressed = 0;
    if (laszip_create(&reader) || laszip_open_reader(reader, file.c_str(), &compressed) ||
        laszip_get_header_pointer(reader, &header) || laszip_get_point_pointer(reader, &point)) {
      state.SkipWithError("LASzip cannot open the file");
      break;
    }
    const std::uint64_t count = header->number_of_point_records ? header->number_of_point_records
                                                                : header->extended_number_of_point_records;
    std::int64_t sum = 0;
    for (std::uint64_t i = 0; i < count && laszip_read_point(reader) == 0; ++i) sum += point->X;
    benchmark::DoNotOptimize(sum);
    laszip_close_reader(reader);
    laszip_destroy(reader);
    state.SetIterationTime(processor_seconds() - start);
  }
}
#define SFUMATO_BENCH_LASZIP(function, id, file) \
  BENCHMARK_CAPTURE(function, id, file)->UseManualTime()->Unit(benchmark::kMillisecond)
SFUMATO_BENCH_LASZIP(read_laz_processor, lion, "lion_takanawa.copc.laz")->Name("io/laz14/processor");
SFUMATO_BENCH_LASZIP(read_laszip, lion, "lion_takanawa.copc.laz")->Name("io/laz14/laszip_alone");
SFUMATO_BENCH_LASZIP(read_laz_processor, autzen, "autzen_full.laz")->Name("io/laz14_autzen/processor");
SFUMATO_BENCH_LASZIP(read_laszip, autzen, "autzen_full.laz")->Name("io/laz14_autzen/laszip_alone");

}  // namespace
