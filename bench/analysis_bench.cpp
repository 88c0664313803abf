// Preparing a cloud: sorting, spacing, normals. The baseline is nanoflann on the same cloud with the same
// fit, in random order as a file brings it and in the order our sort makes.
#include <benchmark/benchmark.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <map>
#include <nanoflann.hpp>
#include <random>

#include "analysis/morton.h"
#include "analysis/normals.h"
#include "analysis/prepare.h"
#include "analysis/spacing.h"
#include "tori.h"

namespace {

using namespace sfumato;
using namespace sfumato::analysis;

/// Three nested tori in random order; the last one asked for is kept.
const PointCloud& tori_cloud(std::size_t count) {
  static std::map<std::size_t, PointCloud> kept;
  if (!kept.contains(count)) {
    kept.clear();
    PointCloud cloud;
    for (const bench::TorusPoint& p : bench::tori(count))
      cloud.positions.push_back(vec3(p.position[0], p.position[1], p.position[2]));
    kept[count] = std::move(cloud);
  }
  return kept[count];
}

void per_point(benchmark::State& state, std::size_t points) {
  state.SetItemsProcessed(std::int64_t(state.iterations()) * std::int64_t(points));
}

void sort(benchmark::State& state) {
  const PointCloud& cloud = tori_cloud(std::size_t(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(morton_order(cloud));
  per_point(state, cloud.size());
}

/// Of the sorted cloud, with the tree it needs.
void spacing(benchmark::State& state) {
  PointCloud cloud = tori_cloud(std::size_t(state.range(0)));
  reorder(cloud, morton_order(cloud));
  std::vector<Batch> batches = cut_batches(cloud.positions);
  for (auto _ : state) {
    const NeighborTree tree(cloud.positions);
    benchmark::DoNotOptimize(measure_spacing(batches, tree));
  }
  per_point(state, cloud.size());
}

/// Everything between the positions of a file in random order and the normals: sort, batches, spacing, tree,
/// K = 24 neighbours, fit.
void normals(benchmark::State& state) {
  const PointCloud& cloud = tori_cloud(std::size_t(state.range(0)));
  for (auto _ : state) {
    state.PauseTiming();
    PointCloud copy = cloud;
    state.ResumeTiming();
    benchmark::DoNotOptimize(prepare(std::move(copy), Attribute::normal, {.neighbors = 24}));
  }
  per_point(state, cloud.size());
}

/// The same with noise of one spacing, which only wider planes see through.
void noisy_normals(benchmark::State& state) {
  PointCloud noisy = tori_cloud(std::size_t(state.range(0)));
  const float spacing = prepare(noisy, {}, {}).median_spacing;
  std::mt19937 random(5);
  std::normal_distribution<float> gauss(0, spacing);
  for (vec3& p : noisy.positions) p += vec3(gauss(random), gauss(random), gauss(random));
  for (auto _ : state) {
    state.PauseTiming();
    PointCloud copy = noisy;
    state.ResumeTiming();
    benchmark::DoNotOptimize(prepare(std::move(copy), Attribute::normal, {.neighbors = 24}));
  }
  per_point(state, noisy.size());
}

struct Adaptor {
  const std::vector<vec3>& points;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t k) const { return points[i][int(k)]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

void nanoflann_of(benchmark::State& state, const PointCloud& cloud) {
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Adaptor>, Adaptor, 3,
                                                   std::uint32_t>;
  for (auto _ : state) {
    const Adaptor adaptor{cloud.positions};
    Tree tree(3, adaptor, nanoflann::KDTreeSingleIndexAdaptorParams(10));
    std::vector<vec3> found(cloud.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cloud.size(), 4'096), [&](const auto& range) {
      std::uint32_t ids[25];  // the nearest is the point itself, which the fit adds on its own
      float distances2[25];
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        tree.knnSearch(&cloud.positions[i].x, 25, ids, distances2);
        found[i] = thinnest_direction(cloud.positions, std::uint32_t(i), {ids + 1, 24}).value_or(vec3(0));
      }
    });
    benchmark::DoNotOptimize(found.data());
  }
  per_point(state, cloud.size());
}

void nanoflann_normals(benchmark::State& state) {
  nanoflann_of(state, tori_cloud(std::size_t(state.range(0))));
}

void nanoflann_normals_sorted(benchmark::State& state) {
  PointCloud cloud = tori_cloud(std::size_t(state.range(0)));
  reorder(cloud, morton_order(cloud));
  nanoflann_of(state, cloud);
}

void uncertainty(benchmark::State& state) {
  const PointCloud& cloud = tori_cloud(std::size_t(state.range(0)));
  for (auto _ : state) {
    state.PauseTiming();
    PointCloud copy = cloud;
    state.ResumeTiming();
    benchmark::DoNotOptimize(prepare(std::move(copy), Attribute::uncertainty, {.neighbors = 24}));
  }
  per_point(state, cloud.size());
}

constexpr int small = 128'000, medium = 1'000'000, large = 10'000'000;

#define SFUMATO_BENCH_ROW(function) \
  BENCHMARK(function)->Name("analysis/" #function)->Unit(benchmark::kMillisecond)->UseRealTime()->MinTime(1)
SFUMATO_BENCH_ROW(sort)->Arg(medium)->Arg(large);
SFUMATO_BENCH_ROW(spacing)->Arg(medium)->Arg(large);
SFUMATO_BENCH_ROW(normals)->Arg(small)->Arg(medium);
SFUMATO_BENCH_ROW(noisy_normals)->Arg(medium);
SFUMATO_BENCH_ROW(nanoflann_normals)->Arg(small)->Arg(medium);
SFUMATO_BENCH_ROW(nanoflann_normals_sorted)->Arg(small)->Arg(medium);
SFUMATO_BENCH_ROW(uncertainty)->Arg(medium);

}  // namespace
