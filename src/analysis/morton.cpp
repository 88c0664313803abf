#include "analysis/morton.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <limits>
#include <span>
#include <string>

#include "core/error.h"

namespace sfumato::analysis {
namespace {

constexpr std::size_t grain = 65'536;       // points between two looks at Progress
constexpr std::size_t refined_from = 16;    // longer runs of one cell are sorted again inside their own box
constexpr double largest_extent = 1e18;     // squared distances must stay finite in float
constexpr int bits_per_axis = 21;           // 3 x 21 = 63 bits

struct Entry {
  std::uint64_t key;
  std::uint32_t file_index, index;
  bool operator<(const Entry& other) const {
    return key != other.key ? key < other.key : file_index < other.file_index;
  }
};

struct Box {
  vec3 min{std::numeric_limits<float>::infinity()}, max{-std::numeric_limits<float>::infinity()};
};

using Range = tbb::blocked_range<std::size_t>;

Box box_of(std::span<const Entry> entries, const std::vector<vec3>& positions) {
  return tbb::parallel_reduce(
      Range(0, entries.size(), grain), Box(),
      [&](const Range& range, Box box) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
          const vec3& p = positions[entries[i].index];
          box.min = glm::min(box.min, p);
          box.max = glm::max(box.max, p);
        }
        return box;
      },
      [](const Box& a, const Box& b) { return Box{glm::min(a.min, b.min), glm::max(a.max, b.max)}; });
}

/// Spreads the low 21 bits so that two zero bits follow each of them.
std::uint64_t spread(std::uint64_t x) {
  x = (x | x << 32) & 0x001f00000000ffff;
  x = (x | x << 16) & 0x001f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  x = (x | x << 2) & 0x1249249249249249;
  return x;
}

void sort_along_curve(std::span<Entry> entries, const std::vector<vec3>& positions, const Progress& progress) {
  const Box box = box_of(entries, positions);
  const dvec3 low(box.min), size = dvec3(box.max) - low;
  const double extent = std::max({size.x, size.y, size.z});
  if (!(extent > 0)) return;  // coincident: the order of the file stays
  const double cells = double(1 << bits_per_axis), scale = cells / extent;
  tbb::parallel_for(Range(0, entries.size(), grain), [&](const Range& range) {
    progress.check();
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const dvec3 cell = glm::min((dvec3(positions[entries[i].index]) - low) * scale, dvec3(cells - 1));
      entries[i].key = spread(std::uint64_t(cell.x)) | spread(std::uint64_t(cell.y)) << 1 |
                       spread(std::uint64_t(cell.z)) << 2;
    }
  });
  tbb::parallel_sort(entries.begin(), entries.end());
  progress.check();

  std::vector<std::span<Entry>> crowded;
  for (std::size_t first = 0, i = 1; i <= entries.size(); ++i) {
    if (i < entries.size() && entries[i].key == entries[first].key) continue;
    if (i - first > refined_from) crowded.push_back(entries.subspan(first, i - first));
    first = i;
  }
  // A cell is 2^-21 of its box, so this ends after a few rounds.
  tbb::parallel_for(std::size_t(0), crowded.size(),
                    [&](std::size_t i) { sort_along_curve(crowded[i], positions, progress); });
}

template <class T>
void gather(std::vector<T>& values, const std::vector<std::uint32_t>& order) {
  if (values.empty()) return;
  std::vector<T> out(order.size());
  tbb::parallel_for(Range(0, order.size(), grain), [&](const Range& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) out[i] = values[order[i]];
  });
  values = std::move(out);
}

}  // namespace

std::vector<std::uint32_t> morton_order(const PointCloud& cloud, Progress& progress) {
  const std::size_t n = cloud.size();
  if (n > std::numeric_limits<std::uint32_t>::max())
    throw Error(ErrorCode::bad_input, "the cloud has " + std::to_string(n) +
                                          " points, more than the 4294967295 that can be shown at once: thin it "
                                          "or cut it into parts");
  progress.update(0, "sorting");
  std::vector<Entry> entries(n);
  tbb::parallel_for(Range(0, n, grain), [&](const Range& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i)
      entries[i] = {0, cloud.source_index.empty() ? std::uint32_t(i) : cloud.source_index[i], std::uint32_t(i)};
  });
  // Coincident points are never compared by key: bring them into the order of the file first.
  if (!std::is_sorted(entries.begin(), entries.end())) tbb::parallel_sort(entries.begin(), entries.end());
  const Box box = box_of(entries, cloud.positions);
  if (n > 0 && glm::distance(dvec3(box.min), dvec3(box.max)) > largest_extent)
    throw Error(ErrorCode::bad_input,
                "the points spread over more than 1e18 units: some coordinates are damaged, filter them out");
  sort_along_curve(entries, cloud.positions, progress);
  std::vector<std::uint32_t> order(n);
  tbb::parallel_for(Range(0, n, grain), [&](const Range& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) order[i] = entries[i].index;
  });
  progress.update(1, "sorting");
  return order;
}

void reorder(PointCloud& cloud, const std::vector<std::uint32_t>& order) {
  gather(cloud.positions, order);
  gather(cloud.normals, order);
  gather(cloud.colors, order);
  gather(cloud.radii, order);
  for (ScalarField& field : cloud.scalars) gather(field.values, order);
  if (cloud.source_index.empty())
    cloud.source_index = order;
  else
    gather(cloud.source_index, order);
  cloud.grids.clear();
  cloud.grid_index.clear();
}

}  // namespace sfumato::analysis
