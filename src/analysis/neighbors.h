// The k nearest neighbours of every point of a Morton-ordered cloud.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "core/progress.h"
#include "core/vec.h"

namespace sfumato::analysis {

/// A tree of boxes over an array of points, eight children a node. A leaf is a run of 2 to 20 consecutive
/// points that ends where the curve makes its longest jump; a node covers eight consecutive nodes of the
/// level below. Correct for any order of the points, fast for Morton order. Keeps a view of the positions.
class NeighborTree {
 public:
  explicit NeighborTree(std::span<const vec3> positions);

  std::span<const vec3> positions() const { return positions_; }
  std::size_t leaf_count() const { return leaf_first_.size() - 1; }
  /// Points [first, second) of a leaf.
  std::pair<std::uint32_t, std::uint32_t> leaf(std::size_t i) const {
    return {leaf_first_[i], leaf_first_[i + 1]};
  }

  /// Offers points to `nearest` from near to far, skipping everything at or beyond `nearest.limit()` (a
  /// squared distance): `nearest.add(index, squared_distance)`. Where `Nearest::merges_coincident`, a box of
  /// coincident points offers only one of them.
  template <class Nearest>
  void search(const vec3& p, Nearest& nearest) const;

  /// Calls `take(first, last)` for every leaf whose box is at most `radius` from the box [low, high], until
  /// it returns false. Returns whether it saw them all.
  template <class Take>
  bool leaves_near(const vec3& low, const vec3& high, float radius, const Take& take) const;

 private:
  struct Octet {  // boxes of eight children; a missing child is inside out and infinitely far
    float low[3][8], high[3][8];
  };
  /// Squared distances from the box [low, high] to the eight children. By value and child by child: so
  /// written it becomes vector instructions.
  static std::array<float, 8> distances2(const Octet& octet, const vec3& low, const vec3& high) {
    std::array<float, 8> out;
    const float low_x = low.x, low_y = low.y, low_z = low.z, high_x = high.x, high_y = high.y,
                high_z = high.z;
    for (std::size_t c = 0; c < 8; ++c) {
      const float dx = std::max(std::max(octet.low[0][c] - high_x, low_x - octet.high[0][c]), 0.0f);
      const float dy = std::max(std::max(octet.low[1][c] - high_y, low_y - octet.high[1][c]), 0.0f);
      const float dz = std::max(std::max(octet.low[2][c] - high_z, low_z - octet.high[2][c]), 0.0f);
      out[c] = dx * dx + dy * dy + dz * dz;
    }
    return out;
  }
  static constexpr int stack_size = 96;  // at most 7 siblings wait on each of 11 levels
  struct Waiting {
    float distance2;
    std::uint32_t level, index;
  };

  void cut_leaves();
  std::span<const vec3> positions_;
  std::vector<std::uint32_t> leaf_first_;   // and the number of points at the end
  std::vector<std::vector<Octet>> levels_;  // levels_[0] holds the boxes of leaves; the last has one octet
};

/// A squared distance and an index as one number that sorts by distance, then by index.
inline std::uint64_t sort_key(float distance2, std::uint32_t id) {
  return std::uint64_t(std::bit_cast<std::uint32_t>(distance2)) << 32 | id;
}
inline float distance2_of(std::uint64_t key) { return std::bit_cast<float>(std::uint32_t(key >> 32)); }
inline std::uint32_t id_of(std::uint64_t key) { return std::uint32_t(key); }

/// What `NeighborTree::search` finds: the k nearest points of a place.
class KNearest {
 public:
  static constexpr bool merges_coincident = false;
  explicit KNearest(std::size_t k) : k_(k) { heap_.reserve(k); }
  /// Forgets what it found. `except`: a point that does not count.
  void start(std::uint32_t except) {
    except_ = except;
    limit_ = std::numeric_limits<float>::infinity();
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
  /// `sort_key`s as a heap, the farthest on top.
  const std::vector<std::uint64_t>& heap() const { return heap_; }

 private:
  std::size_t k_;
  std::uint32_t except_ = std::numeric_limits<std::uint32_t>::max();
  float limit_ = std::numeric_limits<float>::infinity();
  std::vector<std::uint64_t> heap_;
};

/// Called for every point: its index, the indices of its neighbours and their squared distances. The
/// neighbours come in no order, but the last is the farthest. Called from several threads, for different
/// points.
using VisitNeighborhood = std::function<void(std::uint32_t point, std::span<const std::uint32_t> ids,
                                             std::span<const float> distances2)>;

/// Visits the min(k, n - 1) nearest neighbours of every point, itself excluded; coincident points count.
/// Which of several equally far points is taken is not specified, but always the same for any number of
/// threads. Nothing is stored: what is needed longer the visitor keeps. `text` names the step to `progress`.
void for_each_neighborhood(const NeighborTree& tree, int k, const VisitNeighborhood& visit,
                           std::string_view text = "neighbors", Progress& progress = no_progress());

template <class Nearest>
void NeighborTree::search(const vec3& p, Nearest& nearest) const {
  if (positions_.empty()) return;
  Waiting stack[stack_size];
  int waiting = 0;
  stack[waiting++] = {0, std::uint32_t(levels_.size() - 1), 0};
  while (waiting > 0) {
    const Waiting node = stack[--waiting];
    if (node.distance2 >= nearest.limit()) continue;
    const Octet& octet = levels_[node.level][node.index];
    const std::array<float, 8> d2 = distances2(octet, p, p);
    std::uint64_t near[8];  // distance above, child below: sorts by distance
    int count = 0;
    for (std::uint32_t c = 0; c < 8; ++c) {
      if (!(d2[c] < nearest.limit())) continue;
      const std::uint64_t key = std::uint64_t(std::bit_cast<std::uint32_t>(d2[c])) << 32 | c;
      int at = count++;
      for (; at > 0 && near[at - 1] > key; --at) near[at] = near[at - 1];
      near[at] = key;
    }
    if constexpr (Nearest::merges_coincident) {
      int kept = 0;
      for (int i = 0; i < count; ++i) {
        const std::uint32_t c = std::uint32_t(near[i]);
        bool one_place = true;
        for (int k = 0; k < 3; ++k) one_place = one_place && octet.low[k][c] == octet.high[k][c];
        if (!one_place)
          near[kept++] = near[i];
        else if (d2[c] < nearest.limit())  // which shrinks as places are added
          nearest.add(leaf_first_[(std::size_t(node.index) * 8 + c) << 3 * node.level], d2[c]);
      }
      count = kept;
    }
    if (node.level > 0) {
      for (int i = count; i-- > 0;)
        stack[waiting++] = {std::bit_cast<float>(std::uint32_t(near[i] >> 32)), node.level - 1,
                            node.index * 8 + std::uint32_t(near[i])};
      continue;
    }
    for (int i = 0; i < count; ++i) {
      const std::uint32_t child = std::uint32_t(near[i]);
      if (d2[child] >= nearest.limit()) break;
      const auto [first, last] = leaf(std::size_t(node.index) * 8 + child);
      for (std::uint32_t j = first; j < last; ++j) {
        const vec3 d = positions_[j] - p;
        const float distance2 = d.x * d.x + d.y * d.y + d.z * d.z;
        if (distance2 < nearest.limit()) nearest.add(j, distance2);
      }
    }
  }
}

template <class Take>
bool NeighborTree::leaves_near(const vec3& low, const vec3& high, float radius, const Take& take) const {
  if (positions_.empty()) return true;
  const float radius2 = radius * radius;
  Waiting stack[stack_size];
  int waiting = 0;
  stack[waiting++] = {0, std::uint32_t(levels_.size() - 1), 0};
  while (waiting > 0) {
    const Waiting node = stack[--waiting];
    const std::array<float, 8> d2 = distances2(levels_[node.level][node.index], low, high);
    for (std::uint32_t c = 0; c < 8; ++c) {
      if (!(d2[c] <= radius2)) continue;
      const std::uint32_t child = node.index * 8 + c;
      if (node.level > 0) {
        stack[waiting++] = {d2[c], node.level - 1, child};
      } else {
        const auto [first, last] = leaf(child);
        if (!take(first, last)) return false;
      }
    }
  }
  return true;
}

}  // namespace sfumato::analysis
