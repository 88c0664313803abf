#include "analysis/stroke_detail.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>

#include "analysis/stoppable_sort.h"
#include "core/interleave.h"
#include "core/symmetric3.h"

namespace sfumato::analysis {
namespace {

constexpr int value_count = 9, levels = 9;  // colour and the six of n n^T; cells of 4 to 1024 spacings
constexpr float finest_spacings = 2;        // of the parts of the smallest cells: some four points
constexpr float most_spacings = 1000;

using Values = std::array<float, value_count>;

struct Cell {
  std::uint64_t key = 0;
  double count = 0;
  std::array<double, value_count> sum{};
  double squares = 0;  ///< of all values of all points
};

double mean_square(const Cell& c) {
  double sum = 0;
  for (double v : c.sum) sum += v * v;
  return sum / (c.count * c.count);
}

/// One grid: its cells from fine to coarse, and the least length from coarse to fine.
class Grid {
 public:
  Grid(const std::vector<vec3>& positions, const std::vector<Values>& samples, const dvec3& corner,
       double size, const Progress& progress)
      : progress_(progress) {
    order_.resize(positions.size());
    tbb::parallel_for(std::size_t(0), positions.size(), [&](std::size_t i) {
      std::uint64_t key = 0;
      for (int k = 0; k < 3; ++k)
        key |= every_third_bit(
                   std::uint64_t(std::max(std::floor((double(positions[i][k]) + corner[k]) / size), 0.0)))
               << k;
      order_[i] = {key, std::uint32_t(i)};
    });
    stoppable_sort(order_, progress_);
    std::size_t done = 0;
    for (const auto& [key, i] : order_) {
      check_at(done++, progress_);
      if (cells_[0].empty() || cells_[0].back().key != key) cells_[0].push_back({key});
      Cell& cell = cells_[0].back();
      cell.count += 1;
      for (int k = 0; k < value_count; ++k) {
        const double v = samples[i][std::size_t(k)];
        cell.sum[std::size_t(k)] += v;
        cell.squares += v * v;
      }
    }
  }

  /// Least of `lengths` and what this grid finds.
  void measure(double size, std::vector<float>& lengths) {
    std::array<std::vector<float>, levels + 1> least;
    std::vector<double> within,
        free;  // squares of finest parts about their means, and their degrees of freedom
    for (const Cell& c : cells_[0])
      within.push_back(std::max(c.squares - c.count * mean_square(c), 0.0)), free.push_back(c.count - 1);
    for (int level = 1; level <= levels; ++level) {
      size *= 2;
      const std::vector<Cell>& parts = cells_[level - 1];
      std::vector<Cell>& cells = cells_[level];
      std::vector<double> next_within, next_free;
      for (std::size_t first = 0, end; first < parts.size(); first = end) {
        check_at(cells.size(), progress_);
        Cell cell{parts[first].key >> 3};
        double of_means = 0, inside = 0, freedom = 0;
        for (end = first; end < parts.size() && parts[end].key >> 3 == cell.key; ++end) {
          cell.count += parts[end].count;
          for (std::size_t k = 0; k < value_count; ++k) cell.sum[k] += parts[end].sum[k];
          cell.squares += parts[end].squares;
          of_means += parts[end].count * mean_square(parts[end]);
          inside += within[end], freedom += free[end];
        }
        const double pieces = double(end - first);
        const double between = of_means - cell.count * mean_square(cell);
        // Without two points in any part there is nothing to know noise by.
        const double noise = freedom > 0 ? inside / freedom : std::numeric_limits<double>::infinity();
        // Chance gives pieces - 1 times the noise, with a deviation of sqrt(2 (pieces - 1)): three of them
        // are no detail.
        const double chance = pieces - 1 + 3 * std::sqrt(2 * (pieces - 1));
        const double detail = pieces > 1 ? (between - chance * noise) / cell.count : 0;
        least[std::size_t(level)].push_back(detail > 1 ? float(size / std::sqrt(detail))
                                                       : std::numeric_limits<float>::infinity());
        cells.push_back(cell);
        next_within.push_back(inside), next_free.push_back(freedom);
      }
      within = std::move(next_within), free = std::move(next_free);
    }
    for (int level = levels - 1; level >= 0; --level) {
      progress_.check();
      std::vector<float>& mine = least[std::size_t(level)];
      mine.resize(cells_[level].size(), std::numeric_limits<float>::infinity());
      for (std::size_t c = 0, up = 0; c < mine.size(); ++c) {
        while (cells_[level + 1][up].key != cells_[level][c].key >> 3) ++up;
        mine[c] = std::min(mine[c], least[std::size_t(level) + 1][up]);
      }
    }
    std::size_t c = 0;
    for (const auto& [key, i] : order_) {
      check_at(i, progress_);
      while (cells_[0][c].key != key) ++c;
      lengths[i] = std::min(lengths[i], least[0][c]);
    }
  }

 private:
  const Progress& progress_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order_;
  std::array<std::vector<Cell>, levels + 1> cells_;
};

}  // namespace

std::vector<float> detail_lengths(const std::vector<vec3>& positions, const std::vector<Rgba8>& colors,
                                  std::span<const vec3> normals, const dvec3& origin, float spacing,
                                  const DetailOptions& options, Progress& progress) {
  std::vector<float> lengths(positions.size(), most_spacings * spacing);
  if (positions.empty() || !(spacing > 0)) return lengths;
  std::vector<Values> samples(positions.size());
  const float color_scale = 1 / (255 * options.color_step), normal_scale = 1 / options.normal_step;
  dvec3 low(std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!colors.empty())
      samples[i] = {color_scale * colors[i].r, color_scale * colors[i].g, color_scale * colors[i].b};
    const vec3 n = normals[i], m = normal_scale * n,
               off = std::numbers::sqrt2_v<float> * m;  // n n^T has these twice
    samples[i][3] = m.x * n.x, samples[i][4] = m.y * n.y, samples[i][5] = m.z * n.z;
    samples[i][6] = off.x * n.y, samples[i][7] = off.y * n.z, samples[i][8] = off.z * n.x;
    low = glm::min(low, dvec3(positions[i]));
  }
  // Cells of the world, of a power of two: the next frame of a sequence has the same.
  const double size = std::exp2(std::round(std::log2(finest_spacings * spacing)));
  const double largest = size * std::exp2(levels);
  const dvec3 first = glm::floor((low + origin) / largest) * largest - origin;
  // A third of the largest cell is a third or two thirds of a cell at every level.
  for (double shift : {0.0, 1.0 / 3}) {
    progress.check();
    const dvec3 corner = dvec3(shift * largest) - first;
    Grid(positions, samples, corner, size, progress).measure(size, lengths);
  }
  return lengths;
}

NeighborhoodShape neighborhood_shape(const std::vector<vec3>& positions, std::uint32_t center,
                                     std::span<const std::uint32_t> neighbors, float spacing) {
  if (neighbors.size() < 4) return {};
  vec3 sum(0);
  float xx = 0, yy = 0, zz = 0, xy = 0, yz = 0, zx = 0;
  for (std::uint32_t j : neighbors) {
    const vec3 d = positions[j] - positions[center];
    sum += d;
    xx += d.x * d.x, yy += d.y * d.y, zz += d.z * d.z, xy += d.x * d.y, yz += d.y * d.z, zx += d.z * d.x;
  }
  const double n = double(neighbors.size()) + 1;
  const dvec3 m = dvec3(sum) / n;
  const dvec3 widths = eigenvalues({xx / n - m.x * m.x, xy / n - m.x * m.y, zx / n - m.z * m.x,
                                    yy / n - m.y * m.y, yz / n - m.y * m.z, zz / n - m.z * m.z});
  const double largest = widths.x, middle = widths.y, least = widths.z;
  if (!(middle > 1e-6 * largest)) return {};
  NeighborhoodShape shape{float(std::sqrt(std::max(least, 0.0) / middle))};
  // Evenly filled, a width w has the variance w^2 / 12. Twice as long as wide; half a disc, at the end of a
  // surface, is sqrt(1/4 : 1/4 - (4 / (3 pi))^2) = 1.9 times as long as wide.
  const float width = float(std::sqrt(12 * middle));
  if (largest > 2.2 * 2.2 * middle && width > 0.5f * spacing) shape.strip_width = width;
  return shape;
}

}  // namespace sfumato::analysis
