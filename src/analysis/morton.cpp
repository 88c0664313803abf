#include "analysis/morton.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <numeric>
#include <span>
#include <string>
#include <utility>

#include "analysis/memory.h"
#include "core/error.h"
#include "core/typed_attributes.h"

namespace sfumato::analysis {
namespace {

constexpr std::size_t grain = 65'536;        // points between two looks at Progress
constexpr std::size_t refined_from = 16;     // longer runs of one cell are sorted again inside their own box
constexpr double largest_extent = 1e18;      // squared distances must stay finite in float
constexpr int bits_per_axis = 21;            // 3 x 21 = 63 bits
constexpr std::size_t few = 4'096;           // so few are not cut into buckets
constexpr std::size_t insertion_up_to = 24;  // shorter runs are sorted by insertion

using Range = tbb::blocked_range<std::size_t>;
using Ids = std::span<std::uint32_t>;

struct Entry {
  std::uint32_t key;  // 32 of the 63 bits: half the memory to move, and few cells need the others
  std::uint32_t id;
};

struct Extent {
  vec3 min{std::numeric_limits<float>::infinity()}, max{-std::numeric_limits<float>::infinity()};
};

Extent box_of(std::span<const std::uint32_t> ids, const std::vector<vec3>& positions) {
  return tbb::parallel_reduce(
      Range(0, ids.size(), grain), Extent(),
      [&](const Range& range, Extent box) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
          const vec3 p = positions[ids[i]];
          box.min = glm::min(box.min, p);
          box.max = glm::max(box.max, p);
        }
        return box;
      },
      [](const Extent& a, const Extent& b) {
        return Extent{glm::min(a.min, b.min), glm::max(a.max, b.max)};
      });
}

/// The numbers below 128 with two zero bits after each bit.
constexpr std::array<std::uint32_t, 128> spread = [] {
  std::array<std::uint32_t, 128> table{};
  for (std::uint32_t i = 0; i < 128; ++i)
    for (int bit = 0; bit < 7; ++bit) table[i] |= (i >> bit & 1) << 3 * bit;
  return table;
}();

/// The cells of a box: 2^21 along its longest side.
class Cells {
 public:
  explicit Cells(const Extent& box) : low_(box.min) {
    const dvec3 size = dvec3(box.max) - dvec3(box.min);
    scale_ = float(double(1 << bits_per_axis) / std::max({size.x, size.y, size.z}));
  }
  /// False where all points are one place, as far as float can tell them apart.
  bool any() const { return scale_ <= std::numeric_limits<float>::max(); }
  std::uint64_t key(const vec3& p) const {
    const Cell c = cell(p);
    return std::uint64_t(seven_bits(c, 14)) << 42 | std::uint64_t(seven_bits(c, 7)) << 21 | seven_bits(c, 0);
  }
  /// The first 21 of the 63 bits of the key.
  std::uint32_t key_begin(const vec3& p) const { return seven_bits(cell(p), 14); }

 private:
  struct Cell {
    std::uint32_t x, y, z;
  };
  // In float: each step keeps the order of coordinates, and 24 bits tell 2^21 cells apart.
  std::uint32_t along(float value, float low) const {
    return std::min(std::uint32_t(std::int32_t((value - low) * scale_)), (1u << bits_per_axis) - 1);
  }
  Cell cell(const vec3& p) const { return {along(p.x, low_.x), along(p.y, low_.y), along(p.z, low_.z)}; }
  static std::uint32_t seven_bits(const Cell& c, int shift) {
    return spread[c.x >> shift & 127] | spread[c.y >> shift & 127] << 1 | spread[c.z >> shift & 127] << 2;
  }

  vec3 low_;
  float scale_;
};

/// Stable. By two digits from the highest bit in which the keys differ, the lower one first, and the few
/// entries that agree in both in the same way: next to no branch depends on the keys.
void sort_by_key(std::span<Entry> entries, Entry* scratch) {
  if (entries.size() <= insertion_up_to) {
    for (std::size_t i = 1; i < entries.size(); ++i) {
      const Entry entry = entries[i];
      std::size_t at = i;
      for (; at > 0 && entries[at - 1].key > entry.key; --at) entries[at] = entries[at - 1];
      entries[at] = entry;
    }
    return;
  }
  std::uint32_t differing = 0;
  for (const Entry& entry : entries) differing |= entry.key ^ entries[0].key;
  if (differing == 0) return;
  constexpr int most_digit_bits = 9;
  const int digit_bits = std::clamp(int(std::bit_width(entries.size())) - 1, 5, most_digit_bits);
  const int shift = std::max(0, int(std::bit_width(differing)) - 2 * digit_bits);
  const std::uint32_t digits = 1u << digit_bits;
  const auto low = [&](const Entry& entry) { return entry.key >> shift & (digits - 1); };
  const auto high = [&](const Entry& entry) { return entry.key >> shift >> digit_bits & (digits - 1); };
  std::array<std::uint32_t, 1 << most_digit_bits> low_places, high_places;
  std::fill_n(low_places.begin(), digits, 0u);
  std::fill_n(high_places.begin(), digits, 0u);
  for (const Entry& entry : entries) ++low_places[low(entry)], ++high_places[high(entry)];
  std::uint32_t low_place = 0, high_place = 0;
  for (std::uint32_t d = 0; d < digits; ++d) {
    low_place += std::exchange(low_places[d], low_place);
    high_place += std::exchange(high_places[d], high_place);
  }
  for (const Entry& entry : entries) scratch[low_places[low(entry)]++] = entry;
  for (std::size_t i = 0; i < entries.size(); ++i) entries[high_places[high(scratch[i])]++] = scratch[i];
  if (shift == 0) return;
  for (std::size_t first = 0, i = 1; i <= entries.size(); ++i) {
    if (i < entries.size() && (entries[i].key ^ entries[first].key) >> shift == 0) continue;
    if (i - first > 1) sort_by_key(entries.subspan(first, i - first), scratch);
    first = i;
  }
}

class CurveSort {
 public:
  CurveSort(const std::vector<vec3>& positions, const Progress& progress)
      : positions_(positions), progress_(progress) {}

  /// Sorts `ids`, which come in the order that coincident points keep. First into buckets by the first bits
  /// of their keys, on all threads, then each bucket within the cache of one thread.
  void sort(Ids ids, const Extent& box) const {
    const Cells cells(box);
    if (!cells.any()) return;
    const std::size_t n = ids.size();
    const int bits = n < few ? 0 : n < std::size_t(2'000'000) ? 12 : 15;
    const auto entries = unset_array<Entry>(n);
    const std::vector<std::size_t> ends = fill_buckets(ids, cells, bits, entries.get());
    tbb::parallel_for(Range(0, ends.size(), 8), [&](const Range& range) {
      progress_.check();
      std::vector<Entry> scratch;
      for (std::size_t b = range.begin(); b < range.end(); ++b) {
        const std::size_t first = b == 0 ? 0 : ends[b - 1], count = ends[b] - first;
        const std::span<Entry> bucket(entries.get() + first, count);
        const Ids its_ids = ids.subspan(first, count);
        const bool crowded = n >= few && count > n / 2;  // it is sorted inside its own box
        if (crowded) {
          for (std::size_t i = 0; i < count; ++i) its_ids[i] = bucket[i].id;
          sort(its_ids);
        } else {
          scratch.resize(std::max(scratch.size(), count));
          sort_bucket(bucket, scratch.data(), cells, 3 * bits_per_axis - bits - 32, its_ids);
        }
      }
    });
  }

 private:
  void sort(Ids ids) const { sort(ids, box_of(ids, positions_)); }

  /// Entries of `ids` in the order of the first `bits` bits of their keys, with the next 32. Returns where
  /// each bucket ends.
  std::vector<std::size_t> fill_buckets(Ids ids, const Cells& cells, int bits, Entry* entries) const {
    const std::size_t n = ids.size(), buckets = std::size_t(1) << bits;
    const std::size_t parts = std::clamp<std::size_t>(n / grain, 1, 16);
    const auto bucket_of = [&](std::uint32_t key_begin) { return key_begin >> (bits_per_axis - bits); };
    std::vector<std::uint32_t> places(parts * buckets);
    tbb::parallel_for(std::size_t(0), parts, [&](std::size_t part) {
      progress_.check();
      std::uint32_t* count = &places[part * buckets];
      for (std::size_t i = part * n / parts; i < (part + 1) * n / parts; ++i)
        ++count[bucket_of(cells.key_begin(positions_[ids[i]]))];
    });
    std::vector<std::size_t> ends(buckets);
    std::uint32_t place = 0;
    for (std::size_t b = 0; b < buckets; ++b) {
      for (std::size_t part = 0; part < parts; ++part)
        place += std::exchange(places[part * buckets + b], place);
      ends[b] = place;
    }
    tbb::parallel_for(std::size_t(0), parts, [&](std::size_t part) {
      progress_.check();
      std::uint32_t* next = &places[part * buckets];
      for (std::size_t i = part * n / parts; i < (part + 1) * n / parts; ++i) {
        const std::uint64_t key = cells.key(positions_[ids[i]]);
        const std::uint32_t key_part = std::uint32_t(key >> (3 * bits_per_axis - bits - 32));
        entries[next[bucket_of(std::uint32_t(key >> 42))]++] = {key_part, ids[i]};
      }
    });
    return ends;
  }

  /// Sorts entries whose keys are those from the cells without their last `rest` bits, first of all by these.
  void sort_bucket(std::span<Entry> bucket, Entry* scratch, const Cells& cells, int rest, Ids ids) const {
    sort_by_key(bucket, scratch);
    each_run(bucket, [&](std::size_t first, std::size_t count) {
      const std::span<Entry> run = bucket.subspan(first, count);
      const Ids run_ids = ids.subspan(first, count);
      if (count > 1) {
        const std::uint64_t mask = (std::uint64_t(1) << rest) - 1;
        for (Entry& entry : run) entry.key = std::uint32_t(cells.key(positions_[entry.id]) & mask);
        sort_by_key(run, scratch);
      }
      for (std::size_t i = 0; i < count; ++i) run_ids[i] = run[i].id;
      // A cell is 2^-21 of its box, so this ends after a few rounds.
      if (count > 1)
        each_run(run, [&](std::size_t begin, std::size_t length) {
          if (length > refined_from)
            sort(run_ids.subspan(begin, length));
          else if (length > 1)
            sort_by_place(run_ids.subspan(begin, length));
        });
    });
  }

  /// Few points of one cell, so that no order of the file shows; stable.
  void sort_by_place(Ids ids) const {
    auto before = [&](std::uint32_t a, std::uint32_t b) {
      const vec3 &p = positions_[a], &q = positions_[b];
      return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : p.z < q.z;
    };
    for (std::size_t i = 1; i < ids.size(); ++i)
      for (std::size_t at = i; at > 0 && before(ids[at], ids[at - 1]); --at) std::swap(ids[at], ids[at - 1]);
  }

  /// Calls `run(first, count)` for the entries of each key.
  template <class Run>
  static void each_run(std::span<const Entry> sorted, const Run& run) {
    for (std::size_t first = 0, i = 1; i <= sorted.size(); ++i) {
      if (i < sorted.size() && sorted[i].key == sorted[first].key) continue;
      run(first, i - first);
      first = i;
    }
  }

  const std::vector<vec3>& positions_;
  const Progress& progress_;
};

/// Permutes `values` by way of `scratch`, which stays touched and warm from one attribute to the next.
template <class T>
void permute(std::vector<T>& values, const std::vector<std::uint32_t>& order, std::byte* scratch) {
  static_assert(sizeof(T) <= sizeof(vec3), "reorder() makes scratch as large as the positions");
  if (values.empty()) return;
  T* const sorted = reinterpret_cast<T*>(scratch);
  tbb::parallel_for(Range(0, order.size(), grain), [&](const Range& range) {
    constexpr std::size_t ahead = 64;  // each value is a cache miss: more of them under way at once
    const std::size_t near_end = range.end() - std::min(range.size(), ahead);
    std::size_t i = range.begin();
    for (; i < near_end; ++i) {
      __builtin_prefetch(&values[order[i + ahead]]);
      sorted[i] = values[order[i]];
    }
    for (; i < range.end(); ++i) sorted[i] = values[order[i]];
  });
  tbb::parallel_for(Range(0, order.size(), grain), [&](const Range& range) {
    std::copy(sorted + range.begin(), sorted + range.end(), values.begin() + std::ptrdiff_t(range.begin()));
  });
}

}  // namespace

std::vector<std::uint32_t> morton_order(const PointCloud& cloud, Progress& progress) {
  const std::size_t n = cloud.size();
  if (n > std::numeric_limits<std::uint32_t>::max())
    throw Error(ErrorCode::bad_input,
                "the cloud has " + std::to_string(n) +
                    " points, more than the 4294967295 that can be shown at once: thin it "
                    "or cut it into parts");
  progress.update(0, "sorting");
  std::vector<std::uint32_t> order(n);
  std::iota(order.begin(), order.end(), 0u);
  const std::vector<std::uint32_t>& source = cloud.source_index;
  // Coincident points are never compared by key: bring them into the order of the file first.
  if (!std::is_sorted(source.begin(), source.end()))
    tbb::parallel_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return source[a] != source[b] ? source[a] < source[b] : a < b;
    });
  const Extent box = box_of(order, cloud.positions);
  if (n > 0 && glm::distance(dvec3(box.min), dvec3(box.max)) > largest_extent)
    throw Error(ErrorCode::bad_input,
                "the points spread over more than 1e18 units: some coordinates are damaged, filter them out");
  if (n > 0) CurveSort(cloud.positions, progress).sort(order, box);
  progress.update(1, "sorting");
  return order;
}

std::vector<std::uint64_t> curve_keys(std::span<const vec3> places, const vec3& box_min,
                                      const vec3& box_max) {
  const Cells cells({box_min, box_max});
  std::vector<std::uint64_t> keys(places.size());
  if (cells.any())
    std::transform(places.begin(), places.end(), keys.begin(),
                   [&](const vec3& place) { return cells.key(glm::clamp(place, box_min, box_max)); });
  return keys;
}

void reorder(PointCloud& cloud, std::vector<std::uint32_t> order) {
  const auto scratch = unset_array<std::byte>(order.size() * sizeof(vec3));
  permute(cloud.positions, order, scratch.get());
  for_each_attribute([&](const auto& each) { permute(each.of(cloud), order, scratch.get()); });
  for (ScalarField& field : cloud.scalars) permute(field.values, order, scratch.get());
  if (cloud.source_index.empty())
    cloud.source_index = std::move(order);
  else
    permute(cloud.source_index, order, scratch.get());
  cloud.grids.clear();
  cloud.grid_index.clear();
}

}  // namespace sfumato::analysis
