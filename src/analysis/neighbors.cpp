#include "analysis/neighbors.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <cmath>
#include <memory>

namespace sfumato::analysis {
namespace {

constexpr std::size_t shortest_leaf = 8, longest_leaf = 20;
constexpr std::size_t segment = 4'096;        // leaves end at its multiples, so that segments are cut in parallel
constexpr std::size_t leaves_per_block = 512;  // about 7,000 points between two looks at Progress
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

std::uint64_t sort_key(float distance2, std::uint32_t id) {
  return std::uint64_t(std::bit_cast<std::uint32_t>(distance2)) << 32 | id;
}
float distance2_of(std::uint64_t key) { return std::bit_cast<float>(std::uint32_t(key >> 32)); }

/// The k nearest points of a place, as a heap with the farthest on top.
class KNearest {
 public:
  static constexpr bool merges_coincident = false;
  explicit KNearest(std::size_t k) : k_(k) { heap_.reserve(k); }
  /// `limit`: squared distance that all k points are known to be below.
  void start(std::uint32_t except, float limit = std::numeric_limits<float>::infinity()) {
    except_ = except;
    limit_ = limit;
    heap_.clear();
  }
  float limit() const { return limit_; }
  void add(std::uint32_t id, float distance2) {
    if (id == except_) return;
    if (heap_.size() == k_) {
      std::pop_heap(heap_.begin(), heap_.end());
      heap_.pop_back();
    }
    heap_.push_back(sort_key(distance2, id));
    std::push_heap(heap_.begin(), heap_.end());
    if (heap_.size() == k_) limit_ = distance2_of(heap_.front());
  }
  const std::vector<std::uint64_t>& heap() const { return heap_; }

 private:
  std::size_t k_;
  std::uint32_t except_ = 0;
  float limit_ = 0;
  std::vector<std::uint64_t> heap_;
};
constexpr std::uint32_t nobody = std::numeric_limits<std::uint32_t>::max();

/// Finds the neighbours of one leaf after the other. The points of a leaf share one set of candidates: all
/// points near enough to its box; distances to them are plain loops over arrays.
class LeafSearch {
 public:
  LeafSearch(const NeighborTree& tree, std::size_t k, const VisitNeighborhood& visit)
      : tree_(tree), positions_(tree.positions()), k_(k), visit_(visit), nearest_(k), around_center_(k + 1),
        ids_(k), distances2_(k) {}

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
      const float from_last = i > first ? std::sqrt(distances2_[k_ - 1]) +
                                              glm::distance(positions_[i - 1], positions_[i]) : here;
      select(i, self_ + (i - first), rounding * std::min(here, from_last));
      report(i);
    }
  }

 private:
  static constexpr float rounding = 1.00001f;  // more than the rounding of the sums above

  bool gather(std::uint32_t first, std::uint32_t last) {
    Box box;
    for (std::uint32_t i = first; i < last; ++i) box.add(positions_[i]);
    center_ = 0.5f * box.low + 0.5f * box.high;
    around_center_.start(nobody, limit_from_the_curve(first, last));
    tree_.search(center_, around_center_);
    if (around_center_.heap().size() <= k_) return false;
    radius_at_center_ = std::sqrt(around_center_.limit());
    const float reach = rounding * (radius_at_center_ + 0.5f * glm::distance(box.low, box.high));
    const float reach2 = reach * reach;
    count_ = 0;
    return tree_.leaves_near(box.low, box.high, reach, [&](std::uint32_t from, std::uint32_t to) {
      if (count_ + int(to - from) > most_candidates) return false;
      if (from == first) self_ = count_;  // all of the leaf's own points are taken
      for (std::uint32_t j = from; j < to; ++j) {
        const vec3 p = positions_[j];
        const vec3 d = glm::max(glm::max(box.low - p, p - box.high), vec3(0));
        x_[count_] = p.x, y_[count_] = p.y, z_[count_] = p.z, candidates_[count_] = j;
        count_ += glm::dot(d, d) <= reach2;
      }
      return true;
    });
  }

  /// A squared distance from the centre below which there are more than k points: those before and after the leaf
  /// on the curve are mostly near, and finding the last of them is quicker than narrowing a search from infinity.
  float limit_from_the_curve(std::uint32_t first, std::uint32_t last) {
    const std::size_t margin = k_;
    const std::size_t from = first > margin ? first - margin : 0, to = std::min(positions_.size(), last + margin);
    if (to - from <= k_) return std::numeric_limits<float>::infinity();
    distances2_.resize(to - from);
    for (std::size_t i = from; i < to; ++i) {
      const vec3 d = positions_[i] - center_;
      distances2_[i - from] = d.x * d.x + d.y * d.y + d.z * d.z;
    }
    const auto last_needed = distances2_.begin() + std::ptrdiff_t(k_);
    std::nth_element(distances2_.begin(), last_needed, distances2_.end());
    const float limit = std::nextafter(*last_needed, std::numeric_limits<float>::infinity());
    distances2_.resize(k_);
    return limit;
  }

  /// The k candidates nearest to point i, all of which are within `radius`.
  void select(std::uint32_t i, int self, float radius) {
    const vec3 p = positions_[i];
    const float radius2 = radius * radius;
    for (int j = 0; j < count_; ++j) {
      const float dx = x_[j] - p.x, dy = y_[j] - p.y, dz = z_[j] - p.z;
      candidate_distances2_[j] = dx * dx + dy * dy + dz * dz;
    }
    candidate_distances2_[self] = std::numeric_limits<float>::infinity();
    keys_.resize(std::size_t(count_));
    std::size_t inside = 0;
    for (int j = 0; j < count_; ++j) {
      keys_[inside] = sort_key(candidate_distances2_[j], std::uint32_t(j));
      inside += candidate_distances2_[j] <= radius2;
    }
    std::nth_element(keys_.begin(), keys_.begin() + std::ptrdiff_t(k_ - 1), keys_.begin() + std::ptrdiff_t(inside));
    for (std::size_t j = 0; j < k_; ++j) ids_[j] = candidates_[std::uint32_t(keys_[j])];
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
  std::vector<float> distances2_;
  vec3 center_;
  float radius_at_center_ = 0;
  int self_ = 0, count_ = 0;
  // One more than the limit: `gather` writes a candidate before it knows whether to keep it.
  float x_[most_candidates + 1], y_[most_candidates + 1], z_[most_candidates + 1];
  float candidate_distances2_[most_candidates + 1];
  std::uint32_t candidates_[most_candidates + 1];
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
            for (std::uint32_t j = leaf_first_[child]; j < leaf_first_[child + 1]; ++j) box.add(positions_[j]);
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

void for_each_neighborhood(const NeighborTree& tree, int k, const VisitNeighborhood& visit, std::string_view text,
                           Progress& progress) {
  const std::size_t n = tree.positions().size();
  const std::size_t found = n == 0 ? 0 : std::min(std::size_t(std::max(k, 0)), n - 1);
  if (found == 0) {
    for (std::size_t i = 0; i < n; ++i) visit(std::uint32_t(i), {}, {});
    return;
  }
  progress.update(0, text);
  std::atomic<std::size_t> done = 0;
  const std::size_t leaves = tree.leaf_count();
  tbb::parallel_for(std::size_t(0), (leaves + leaves_per_block - 1) / leaves_per_block, [&](std::size_t block) {
    progress.check();
    const auto search = std::make_unique<LeafSearch>(tree, found, visit);
    const std::size_t last = std::min(leaves, (block + 1) * leaves_per_block);
    for (std::size_t leaf = block * leaves_per_block; leaf < last; ++leaf) search->run(leaf);
    done += last - block * leaves_per_block;
    progress.update(double(done) / double(leaves), text);
  });
}

}  // namespace sfumato::analysis
