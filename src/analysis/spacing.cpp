#include "analysis/spacing.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <numbers>

namespace sfumato::analysis {
namespace {

constexpr std::size_t most_queries = 20'000, queries_per_batch = 16, near_on_curve = 12;

/// The eight places nearest to a point other than its own.
class NearestPlaces {
 public:
  static constexpr bool merges_coincident = true;
  NearestPlaces(std::span<const vec3> positions, const vec3& own) : positions_(positions), own_(own) {}

  float limit() const { return count_ < 8 ? std::numeric_limits<float>::infinity() : distance2_[7]; }

  void offer(std::size_t id) {
    const vec3 d = positions_[id] - own_;
    const float distance2 = d.x * d.x + d.y * d.y + d.z * d.z;
    if (distance2 < limit()) add(std::uint32_t(id), distance2);
  }

  void add(std::uint32_t id, float distance2) {
    const vec3& p = positions_[id];
    if (p == own_) return;
    int at = 0;
    for (; at < count_ && distance2_[at] <= distance2; ++at)
      if (distance2_[at] == distance2 && place_[at] == p) return;
    if (count_ < 8) ++count_;
    for (int i = count_ - 1; i > at; --i) distance2_[i] = distance2_[i - 1], place_[i] = place_[i - 1];
    distance2_[at] = distance2, place_[at] = p;
  }

  /// The disc through the m-th place holds m points' worth of area: pi R_m^2 = m s^2.
  float spacing() const {
    if (count_ == 0) return 0;
    return float(std::sqrt(double(distance2_[count_ - 1]) * std::numbers::pi / count_));
  }

 private:
  std::span<const vec3> positions_;
  vec3 own_;
  int count_ = 0;
  float distance2_[8];
  vec3 place_[8];
};

/// Median over `queries` points of [first, first + count), one out of each of as many equal runs, at a place hashed
/// from the run's number. 0 when no query found another place.
float sampled_median(const NeighborTree& tree, std::size_t first, std::size_t count, std::size_t queries) {
  queries = std::min(queries, count);
  std::vector<float> spacings(queries);
  using Range = tbb::blocked_range<std::size_t>;
  tbb::parallel_for(Range(0, queries, 256), [&](const Range& range) {
    for (std::size_t q = range.begin(); q < range.end(); ++q) {
      const std::size_t run = q * count / queries, end = (q + 1) * count / queries;
      const std::uint32_t hash = std::uint32_t(q) * 2654435769u >> 8;
      const std::size_t i = first + run + hash % (end - run), n = tree.positions().size();
      const vec3& p = tree.positions()[i];
      NearestPlaces nearest(tree.positions(), p);
      // Those before and after it on the curve are mostly near: the search then skips what is farther at once.
      for (std::size_t j = i - std::min(i, near_on_curve); j < std::min(n, i + near_on_curve); ++j) nearest.offer(j);
      tree.search(p, nearest);
      spacings[q] = nearest.spacing();
    }
  });
  std::erase_if(spacings, [](float s) { return !(s > 0) || !std::isfinite(s); });
  if (spacings.empty()) return 0;
  const auto middle = spacings.begin() + std::ptrdiff_t(spacings.size() / 2);
  std::nth_element(spacings.begin(), middle, spacings.end());
  return *middle;
}

}  // namespace

float median_spacing(const NeighborTree& tree) {
  const float spacing = sampled_median(tree, 0, tree.positions().size(), most_queries);
  return spacing > 0 ? spacing : 1;
}

void measure_batches(std::span<Batch> batches, const NeighborTree& tree, float fallback,
                     Progress& progress) {
  tbb::parallel_for(std::size_t(0), batches.size(), [&](std::size_t i) {
    progress.check();
    Batch& batch = batches[i];
    const float spacing = sampled_median(tree, batch.first, batch.count, queries_per_batch);
    batch.spacing = spacing > 0 ? spacing : fallback;
  });
}

}  // namespace sfumato::analysis
