#include "analysis/prepare.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <limits>

#include "analysis/attributes.h"
#include "analysis/coincident.h"
#include "analysis/given_normals.h"
#include "analysis/morton.h"
#include "analysis/range_image.h"
#include "analysis/spacing.h"
#include "analysis/surface_noise.h"
#include "core/error.h"

namespace sfumato::analysis {
namespace {

constexpr std::size_t largest_batch = 10'240, smallest_batch = 512, wanted_batches = 512;

/// Grids are lost by sorting, their viewpoints must not be: normals point towards them.
void keep_viewpoints(PointCloud& cloud) {
  if (!cloud.scanners.empty() || cloud.scalar("scanner")) return;
  ScalarField scanner{"scanner", 0,
                      std::vector<float>(cloud.size(), std::numeric_limits<float>::quiet_NaN())};
  for (const Grid& grid : cloud.grids) {
    if (!grid.viewpoint) continue;
    const std::size_t last = std::min(cloud.size(), grid.first + grid.count);
    for (std::size_t i = grid.first; i < last; ++i) scanner.values[i] = float(cloud.scanners.size());
    cloud.scanners.push_back(*grid.viewpoint);
  }
  if (!cloud.scanners.empty()) cloud.set_scalar(std::move(scanner));
}

}  // namespace

std::size_t batch_count(std::uint64_t points) {
  // A small scan gets smaller batches: its density varies as much as that of a large one, and a batch has one
  // spacing. 69,000 points of a street sweep in batches of 10,240 gave discs of 60 px among points 2 px
  // apart.
  const std::uint64_t each =
      std::clamp<std::uint64_t>(points / wanted_batches, smallest_batch, largest_batch);
  return std::size_t((points + each - 1) / each);
}

std::vector<Batch> cut_batches(const std::vector<vec3>& positions) {
  const std::size_t n = positions.size(), count = batch_count(n);
  std::vector<Batch> batches(count);
  tbb::parallel_for(std::size_t(0), count, [&](std::size_t b) {
    const std::size_t first = b * n / count, last = (b + 1) * n / count;
    Batch& batch = batches[b];
    batch.first = std::uint32_t(first);
    batch.count = std::uint32_t(last - first);
    batch.box_min = batch.box_max = positions[first];
    for (std::size_t i = first; i < last; ++i) {
      batch.box_min = glm::min(batch.box_min, positions[i]);
      batch.box_max = glm::max(batch.box_max, positions[i]);
    }
  });
  return batches;
}

void PrepareOptions::describe(ParamList& p) {
  p.add("neighbors", neighbors)
      .range(3, 256)
      .help("points that a normal, a radius or an uncertainty is computed from")
      .paper("Seemann 2018, K");
  // The least with which neighbours on a square grid close what may be a noisy surface is 0.42 (discs are
  // drawn 1.5 times as large), and a random sample needs more. What twigs hide would be 0.2: K discs that
  // point anywhere hide 1 - exp(-K r^2 / 2 R^2) of what lies behind their ball of radius R. That perforates
  // curved and noisy surfaces, and a reader marked it lower (docs/measurements/dots.md).
  p.add("clutter_radius", clutter_radius)
      .range(0.05, 1)
      .unit("factor")
      .help("radius of points in clutter such as foliage, on no surface; 1: no disc shrinks");
  strokes.describe(p);
}

PreparedCloud prepare(PointCloud cloud, Attributes needs, const PrepareOptions& options, Progress& progress) {
  SortedCloud sorted = sort_cloud(std::move(cloud), options, progress);
  complete(sorted.cloud, needs, options, sorted.tree.get(), progress);
  return std::move(sorted.cloud);
}

SortedCloud sort_cloud(PointCloud cloud, const PrepareOptions& options, Progress& progress,
                       std::shared_ptr<const WholeCloud> whole) {
  if (whole && !cloud.empty() && cloud.origin != whole->origin)
    throw Error(ErrorCode::usage, "the parts of a cloud have one origin: move them to that of the whole");
  SortedCloud sorted;
  PreparedCloud& prepared = sorted.cloud;
  prepared.cloud = std::move(cloud);
  prepared.whole = std::move(whole);
  if (prepared.cloud.normals.empty() || prepared.cloud.radii.empty()) recover_grid(prepared.cloud);
  // Who brings both needs no neighbours.
  if (!prepared.whole && (prepared.cloud.normals.empty() || prepared.cloud.radii.empty()))
    prepared.pictures = depth_pictures(prepared.cloud);
  keep_viewpoints(prepared.cloud);
  std::vector<std::uint32_t> order = morton_order(prepared.cloud, progress);
  prepared.views = view_places(prepared.cloud, order);
  reorder(prepared.cloud, std::move(order));
  progress.check();
  thin_places(prepared);
  prepared.batches = cut_batches(prepared.cloud.positions);
  sorted.tree = std::make_unique<NeighborTree>(prepared.cloud.positions);
  const NeighborTree& tree = *sorted.tree;
  prepared.median_spacing = measure_spacing(prepared.batches, tree, progress);
  progress.check();
  if (prepared.whole) {
    prepared.median_spacing = prepared.whole->median_spacing, prepared.noise = prepared.whole->noise;
    if (!prepared.whole->has_normals) prepared.cloud.normals = {};
  } else {
    prepared.noise = surface_noise(tree);
    if (are_rough(prepared.cloud.normals, tree, options.neighbors)) prepared.cloud.normals = {};
  }
  prepared.surface_noise = prepared.noise;
  progress.check();
  return sorted;
}

}  // namespace sfumato::analysis
