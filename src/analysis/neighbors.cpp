#include "analysis/neighbors.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <memory>

#include "analysis/wider_neighborhoods.h"
#include "core/wide.h"

namespace sfumato::analysis {
namespace {

constexpr std::size_t shortest_leaf = 2, longest_leaf = 20;
constexpr std::size_t segment = 4'096;  // leaves end at its multiples, so that segments are cut in parallel
constexpr std::size_t leaves_per_block = 512;  // about 6,000 points between two looks at Progress
constexpr int most_candidates = 2'048;

struct Box {
  vec3 low{std::numeric_limits<float>::infinity()}, high{-std::numeric_limits<float>::infinity()};
  void add(const vec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  template <class Octet>
  void add(const Octet& octet, int child) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], octet.low[k][child]);
      high[k] = std::max(high[k], octet.high[k][child]);
    }
  }
};

struct Candidates {
  // One more than the limit: a candidate is written before it is known whether it is kept.
  alignas(32) float x[most_candidates + 1], y[most_candidates + 1], z[most_candidates + 1];
  std::uint32_t ids[most_candidates + 1];
  int count = 0;
};

/// A byte each: 1 where the value is at most the limit, 0 elsewhere and up to the next multiple of eight.
SFUMATO_WIDE void mark_up_to(const float* values, int count, float limit, std::uint8_t* marks) {
  for (int j = 0; j < count; ++j) marks[j] = values[j] <= limit;
  for (int j = count; j % 8 != 0; ++j) marks[j] = 0;
}

/// Squared distances from the box [low, high].
SFUMATO_WIDE void distances2_to_box(const Candidates& all, const vec3& low, const vec3& high, float* out) {
  const float low_x = low.x, low_y = low.y, low_z = low.z, high_x = high.x, high_y = high.y, high_z = high.z;
  for (int j = 0; j < all.count; ++j) {
    const float dx = std::max(std::max(low_x - all.x[j], all.x[j] - high_x), 0.0f);
    const float dy = std::max(std::max(low_y - all.y[j], all.y[j] - high_y), 0.0f);
    const float dz = std::max(std::max(low_z - all.z[j], all.z[j] - high_z), 0.0f);
    out[j] = dx * dx + dy * dy + dz * dz;
  }
}

/// Calls `take(j)` where marks[j] is 1, in order: one in five is, so eight are looked at at once.
template <class Take>
void for_each_marked(const std::uint8_t* marks, int count, const Take& take) {
  for (int j = 0; j < count; j += 8) {
    if constexpr (std::endian::native == std::endian::little) {
      std::uint64_t word;
      std::memcpy(&word, marks + j, 8);
      for (; word != 0; word &= word - 1) take(j + (std::countr_zero(word) >> 3));
    } else {
      for (int k = j; k < j + 8; ++k)
        if (marks[k]) take(k);
    }
  }
}

SFUMATO_WIDE void distances2_to(const Candidates& all, const vec3& p, float* out) {
  for (int j = 0; j < all.count; ++j) {
    const float dx = all.x[j] - p.x, dy = all.y[j] - p.y, dz = all.z[j] - p.z;
    out[j] = dx * dx + dy * dy + dz * dz;
  }
}

SFUMATO_WIDE int count_up_to(const float* values, int count, float limit) {
  int found = 0;
  for (int j = 0; j < count; ++j) found += values[j] <= limit;
  return found;
}

/// A limit below `high` that `least` to `most` of the values do not exceed, `high` where none was found;
/// `high_count` of them do not exceed `high`. Squared distances on a surface are nearly uniform, so
/// interpolation between two counts is soon there.
struct Limit {
  float value;
  int count;
};
Limit limit_for(const float* values, int count, int least, int most, Limit high) {
  Limit low{0, 0};
  for (int round = 0; round < 12 && high.count > most; ++round) {
    const float wanted = 0.5f * float(least + most) + 0.25f;
    float share = (wanted - float(low.count)) / float(high.count - low.count);
    if (round % 3 == 2) share = 0.5f;  // halving ends where interpolation creeps
    const float middle = low.value + share * (high.value - low.value);
    const int found = count_up_to(values, count, middle);
    (found < least ? low : high) = {middle, found};
  }
  return high;
}

constexpr std::uint32_t nobody = std::numeric_limits<std::uint32_t>::max();

/// Finds the neighbours of one leaf after the other. The points of a leaf share one set of candidates: all
/// points near enough to its box; distances to them are plain loops over arrays.
class LeafSearch {
 public:
  LeafSearch(const NeighborTree& tree, std::size_t k, const VisitNeighborhood& visit)
      : tree_(tree),
        positions_(tree.positions()),
        k_(k),
        visit_(visit),
        nearest_(k),
        around_center_(k + 1),
        ids_(k),
        distances2_(k) {}

  void run(std::size_t leaf) {
    const auto [first, last] = tree_.leaf(leaf);
    if (!gather(first, last)) {  // a stray point far from a dense region: one by one
      for (std::uint32_t i = first; i < last; ++i) {
        nearest_.start(i);
        tree_.search(positions_[i], nearest_);
        keys_ = nearest_.heap();
        std::swap(keys_.front(), keys_.back());  // the farthest last
        for (std::size_t j = 0; j < k_; ++j) ids_[j] = std::uint32_t(keys_[j]);
        report(i);
      }
      return;
    }
    for (std::uint32_t i = first; i < last; ++i) {
      // A ball that holds k + 1 points around another place, grown by the way from there to here, holds as
      // many around here.
      const float here = radius_at_center_ + glm::distance(center_, positions_[i]);
      const float from_last =
          i > first ? std::sqrt(distances2_[k_ - 1]) + glm::distance(positions_[i - 1], positions_[i]) : here;
      select(i, self_ + int(i - first), rounding * std::min(here, from_last));
      report(i);
    }
  }

 private:
  static constexpr float rounding = 1.00001f;  // more than the rounding of the sums above

  /// Candidates of a leaf; false where there are too many.
  bool gather(std::uint32_t first, std::uint32_t last) {
    Box box;
    for (std::uint32_t i = first; i < last; ++i) box.add(positions_[i]);
    center_ = 0.5f * box.low + 0.5f * box.high;
    const int needed = int(k_) + 1;
    // All points of the leaves in reach, by a radius that is too large: mostly the last leaf's, grown ...
    float limit = 1.4f * radius_at_center_ * radius_at_center_;
    int within = take_leaves(box, limit) ? count_up_to(all_distances2_, all_.count, limit) : 0;
    if (within < needed) {
      limit = limit_from_the_curve(first, last);
      if (!take_leaves(box, limit)) {  // much too large, where the curve jumps
        around_center_.start(nobody);
        tree_.search(center_, around_center_);
        limit = around_center_.limit();
        if (!take_leaves(box, limit)) return false;
      }
      within = count_up_to(all_distances2_, all_.count, limit);
    }
    // ... from which a smaller one follows that still holds more than k around the centre.
    const Limit tight = limit_for(all_distances2_, all_.count, needed, needed + needed / 8, {limit, within});
    radius_at_center_ = std::sqrt(tight.value);
    keep_near(box, first, reach_of(box, tight.value));
    return true;
  }

  /// A ball around the centre with more than k points, grown by this, has more than k around each place of
  /// the box.
  static float reach_of(const Box& box, float limit) {
    return rounding * (std::sqrt(limit) + 0.5f * glm::distance(box.low, box.high));
  }

  /// Points of the leaves that are near enough for a squared radius around the centre, with their squared
  /// distances from it; false where there are too many.
  bool take_leaves(const Box& box, float limit) {
    all_.count = 0;
    const bool all =
        tree_.leaves_near(box.low, box.high, reach_of(box, limit), [&](std::uint32_t from, std::uint32_t to) {
          if (all_.count + int(to - from) > most_candidates) return false;
          int at = all_.count;
          for (std::uint32_t j = from; j < to; ++j, ++at) {
            const vec3& p = positions_[j];
            all_.x[at] = p.x, all_.y[at] = p.y, all_.z[at] = p.z, all_.ids[at] = j;
          }
          all_.count = at;
          return true;
        });
    distances2_to(all_, center_, all_distances2_);
    return all;
  }

  void keep_near(const Box& box, std::uint32_t first, float reach) {
    distances2_to_box(all_, box.low, box.high, to_box2_);
    mark_up_to(to_box2_, all_.count, reach * reach, marks_);
    int kept = 0;
    for_each_marked(marks_, all_.count, [&](int j) {
      if (all_.ids[j] == first) self_ = kept;  // the leaf's own points are kept, one after the other
      all_.x[kept] = all_.x[j], all_.y[kept] = all_.y[j], all_.z[kept] = all_.z[j],
      all_.ids[kept] = all_.ids[j];
      ++kept;
    });
    all_.count = kept;
  }

  /// A squared distance from the centre up to which there are more than k points: those before and after the
  /// leaf on the curve are mostly near. Infinite where they are too few.
  float limit_from_the_curve(std::uint32_t first, std::uint32_t last) {
    const std::size_t margin = k_;
    const std::size_t from = first > margin ? first - margin : 0,
                      to = std::min(positions_.size(), last + margin);
    if (to - from <= k_) return std::numeric_limits<float>::infinity();
    nearby_.resize(to - from);
    for (std::size_t i = from; i < to; ++i) {
      const vec3 d = positions_[i] - center_;
      nearby_[i - from] = d.x * d.x + d.y * d.y + d.z * d.z;
    }
    const auto last_needed = nearby_.begin() + std::ptrdiff_t(k_);
    std::nth_element(nearby_.begin(), last_needed, nearby_.end());
    return *last_needed;
  }

  /// The k candidates nearest to point i, all of which are within `radius`.
  void select(std::uint32_t i, int self, float radius) {
    distances2_to(all_, positions_[i], all_distances2_);
    all_distances2_[self] = std::numeric_limits<float>::infinity();
    const int k = int(k_);
    const float radius2 = radius * radius;
    const Limit limit = limit_for(all_distances2_, all_.count, k, k,
                                  {radius2, count_up_to(all_distances2_, all_.count, radius2)});
    keys_.resize(std::max(keys_.size(), std::size_t(all_.count)));
    std::size_t inside = 0;
    mark_up_to(all_distances2_, all_.count, limit.value, marks_);
    for_each_marked(marks_, all_.count,
                    [&](int j) { keys_[inside++] = sort_key(all_distances2_[j], std::uint32_t(j)); });
    const auto end = keys_.begin() + std::ptrdiff_t(inside),
               farthest = keys_.begin() + std::ptrdiff_t(k_ - 1);
    if (inside == k_)
      std::iter_swap(farthest, std::max_element(keys_.begin(), end));
    else  // several equally far
      std::nth_element(keys_.begin(), farthest, end);
    for (std::size_t j = 0; j < k_; ++j) ids_[j] = all_.ids[std::uint32_t(keys_[j])];
  }

  void report(std::uint32_t i) {
    for (std::size_t j = 0; j < k_; ++j) distances2_[j] = distance2_of(keys_[j]);
    visit_(i, ids_, distances2_);
  }

  const NeighborTree& tree_;
  std::span<const vec3> positions_;
  std::size_t k_;
  const VisitNeighborhood& visit_;
  KNearest nearest_, around_center_;
  std::vector<std::uint64_t> keys_;
  std::vector<std::uint32_t> ids_;
  std::vector<float> distances2_, nearby_;
  vec3 center_;
  float radius_at_center_ = 0;
  int self_ = 0;
  Candidates all_;
  alignas(32) float all_distances2_[most_candidates + 1], to_box2_[most_candidates + 1];
  alignas(32) std::uint8_t marks_[most_candidates + 8];
};

}  // namespace

NeighborTree::NeighborTree(std::span<const vec3> positions) : positions_(positions) {
  cut_leaves();
  std::size_t children = leaf_count();
  while (children > 1 || (levels_.empty() && children > 0)) {
    std::vector<Octet> level((children + 7) / 8);
    const std::vector<Octet>* below = levels_.empty() ? nullptr : &levels_.back();
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, level.size(), 1'024), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i)
        for (std::size_t c = 0; c < 8; ++c) {
          const std::size_t child = 8 * i + c;
          Box box;  // stays inside out where there is no child
          if (child < children && below)
            for (int grandchild = 0; grandchild < 8; ++grandchild) box.add((*below)[child], grandchild);
          else if (child < children)
            for (std::uint32_t j = leaf_first_[child]; j < leaf_first_[child + 1]; ++j)
              box.add(positions_[j]);
          for (int k = 0; k < 3; ++k) level[i].low[k][c] = box.low[k], level[i].high[k][c] = box.high[k];
        }
    });
    levels_.push_back(std::move(level));
    children = levels_.back().size();
  }
}

void NeighborTree::cut_leaves() {
  const std::size_t n = positions_.size(), segments = (n + segment - 1) / segment;
  std::vector<std::vector<std::uint32_t>> starts(segments);
  tbb::parallel_for(std::size_t(0), segments, [&](std::size_t s) {
    std::size_t first = s * segment;
    const std::size_t end = std::min(n, first + segment);
    while (first < end) {
      starts[s].push_back(std::uint32_t(first));
      if (end - first <= longest_leaf) break;
      std::size_t cut = first + shortest_leaf;
      float longest_jump = -1;
      for (std::size_t i = first + shortest_leaf; i <= first + longest_leaf; ++i) {
        const vec3 jump = positions_[i] - positions_[i - 1];
        const float length2 = glm::dot(jump, jump);
        if (length2 >= longest_jump) longest_jump = length2, cut = i;
      }
      first = cut;
    }
  });
  for (const auto& part : starts) leaf_first_.insert(leaf_first_.end(), part.begin(), part.end());
  leaf_first_.push_back(std::uint32_t(n));
}

void for_each_neighborhood(const NeighborTree& tree, int k, const VisitNeighborhood& visit,
                           std::string_view text, Progress& progress) {
  for_each_neighborhood(tree, k, k, {}, visit, text, progress);
}

void for_each_neighborhood(const NeighborTree& tree, int k, int wide_k,
                           const std::function<bool(std::uint32_t)>& is_wide, const VisitNeighborhood& visit,
                           std::string_view text, Progress& progress) {
  const std::size_t n = tree.positions().size();
  const auto found_of = [&](int wanted) {
    return n == 0 ? 0 : std::min(std::size_t(std::max(wanted, 0)), n - 1);
  };
  const std::size_t found = found_of(k);
  if (found == 0) {
    for (std::size_t i = 0; i < n; ++i) visit(std::uint32_t(i), {}, {});
    return;
  }
  progress.update(0, text);
  std::atomic<std::size_t> done = 0;
  const std::size_t leaves = tree.leaf_count();
  tbb::parallel_for(std::size_t(0), (leaves + leaves_per_block - 1) / leaves_per_block,
                    [&](std::size_t block) {
                      progress.check();
                      const auto search = std::make_unique<LeafSearch>(tree, found, visit);
                      std::unique_ptr<LeafSearch> wide;
                      const std::size_t last = std::min(leaves, (block + 1) * leaves_per_block);
                      for (std::size_t leaf = block * leaves_per_block; leaf < last; ++leaf) {
                        const auto [from, to] = tree.leaf(leaf);
                        const bool here = is_wide && (is_wide(from) || is_wide(to - 1));
                        if (here && !wide) wide = std::make_unique<LeafSearch>(tree, found_of(wide_k), visit);
                        (here ? *wide : *search).run(leaf);
                      }
                      done += last - block * leaves_per_block;
                      progress.update(double(done) / double(leaves), text);
                    });
}

}  // namespace sfumato::analysis
