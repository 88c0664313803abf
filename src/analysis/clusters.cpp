#include "analysis/clusters.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numeric>

#include "analysis/memory.h"
#include "analysis/normals.h"
#include "analysis/stoppable_sort.h"

namespace sfumato::analysis {
namespace {

/// Sets that grow together from several threads; the lowest index is the root, whatever the order of the
/// calls.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parent_(n) {
    for (std::size_t i = 0; i < n; ++i) parent_[i].store(std::uint32_t(i), std::memory_order_relaxed);
  }
  std::uint32_t root(std::uint32_t i) {
    for (;;) {
      std::uint32_t up = parent_[i].load(std::memory_order_relaxed);
      if (up == i) return i;
      const std::uint32_t above = parent_[up].load(std::memory_order_relaxed);
      if (above != up) parent_[i].compare_exchange_weak(up, above, std::memory_order_relaxed);
      i = above;
    }
  }
  void join(std::uint32_t a, std::uint32_t b) {
    for (;;) {
      a = root(a), b = root(b);
      if (a == b) return;
      if (a < b) std::swap(a, b);
      std::uint32_t expected = a;
      if (parent_[a].compare_exchange_strong(expected, b, std::memory_order_relaxed)) return;
    }
  }

 private:
  std::vector<std::atomic<std::uint32_t>> parent_;
};

float color_distance2(const Rgba8& a, const Rgba8& b) {
  const int r = int(a.r) - b.r, g = int(a.g) - b.g, c = int(a.b) - b.b;
  return float(r * r + g * g + c * c);
}

/// Nearest distance between two neighbouring segments, a < b.
struct Border {
  std::uint32_t a, b;
  float distance2;
  bool operator<(const Border& other) const {
    return std::tie(a, b, distance2) < std::tie(other.a, other.b, other.distance2);
  }
};
struct Beyond {  // one side of a border
  float distance2;
  std::uint32_t segment;
  bool operator<(const Beyond& other) const {
    return std::tie(distance2, segment) < std::tie(other.distance2, other.segment);
  }
};

class RegionGrowing {
 public:
  RegionGrowing(const PointCloud& cloud, const NeighborGraph& graph, float gap, const ClusterOptions& options,
                Progress& progress)
      : cloud_(cloud), graph_(graph), gap2_(gap * gap), options_(options), progress_(progress) {}

  Clusters run() {
    cloud_.colors.empty() ? grow_by_normals() : grow_by_colors();
    find_borders();
    merge_like_colors();
    merge_small();
    return number(region_);
  }

 private:
  void number_segments(DisjointSets& sets) {
    Clusters found;
    found.label.resize(cloud_.size());
    for (std::uint32_t i = 0; i < cloud_.size(); ++i) found.label[i] = sets.root(i);
    // The root is the first point of its set, so this numbers segments as a serial growth would.
    std::vector<std::uint32_t> name(cloud_.size());
    for (std::uint32_t i = 0; i < cloud_.size(); ++i)
      if (found.label[i] == i) name[i] = segment_count_++;
    for (std::uint32_t& label : found.label) label = name[label];
    segment_ = std::move(found.label);
    size_.assign(segment_count_, 0);
    for (std::uint32_t s : segment_) ++size_[s];
    progress_.check();
  }

  /// As PCL does it, along the directed edges of the graph, but from seeds in the order of the points.
  void grow_serially(float limit2) {
    constexpr std::uint32_t none = ~0u;
    std::vector<std::uint32_t> queue;
    segment_.assign(cloud_.size(), none);
    for (std::uint32_t seed = 0; seed < cloud_.size(); ++seed) {
      check_at(seed, progress_);
      if (segment_[seed] != none) continue;
      segment_[seed] = segment_count_;
      queue.assign(1, seed);
      for (std::size_t at = 0; at < queue.size(); ++at)
        for (std::uint32_t j : graph_.of(queue[at])) {
          if (segment_[j] != none || color_distance2(cloud_.colors[queue[at]], cloud_.colors[j]) > limit2)
            continue;
          segment_[j] = segment_count_;
          queue.push_back(j);
        }
      size_.push_back(queue.size());
      ++segment_count_;
    }
    progress_.check();
  }

  void grow_by_colors() {
    const float limit2 = options_.point_threshold * options_.point_threshold;
    if (graph_.keeps()) return grow_serially(limit2);
    DisjointSets sets(cloud_.size());
    graph_.for_each(
        [&](std::uint32_t i, std::span<const std::uint32_t> ids) {
          for (std::uint32_t j : ids)
            if (color_distance2(cloud_.colors[i], cloud_.colors[j]) <= limit2) sets.join(i, j);
        },
        "growing clusters");
    number_segments(sets);
  }

  // The paper leaves clouds without colours as a limit; PCL's RegionGrowing tests normals and curvature.
  void grow_by_normals() {
    std::vector<vec3> normals(cloud_.size());
    const bool given = !cloud_.normals.empty();
    graph_.for_each(
        [&](std::uint32_t i, std::span<const std::uint32_t> ids) {
          if (given) normals[i] = cloud_.normals[i];
          if (normals[i] == vec3(0))
            normals[i] = thinnest_direction(cloud_.positions, i, ids).value_or(vec3(0, 0, 1));
        },
        "normals");
    std::vector<std::uint8_t> bent(cloud_.size());
    const float flat = std::cos(glm::radians(options_.bend_deg)),
                alike = std::cos(glm::radians(options_.angle_deg));
    graph_.for_each(
        [&](std::uint32_t i, std::span<const std::uint32_t> ids) {
          float sum = 0;
          for (std::uint32_t j : ids) sum += std::abs(glm::dot(normals[i], normals[j]));
          bent[i] = sum < flat * float(ids.size());
        },
        "bends");
    DisjointSets sets(cloud_.size());
    graph_.for_each(
        [&](std::uint32_t i, std::span<const std::uint32_t> ids) {
          for (std::uint32_t j : ids)
            if (!bent[i] && !bent[j] && std::abs(glm::dot(normals[i], normals[j])) >= alike) sets.join(i, j);
        },
        "growing clusters");
    number_segments(sets);
  }

  void find_borders() {
    tbb::enumerable_thread_specific<std::vector<Border>> found;
    graph_.for_each(
        [&](std::uint32_t i, std::span<const std::uint32_t> ids) {
          std::vector<Border>& mine = found.local();
          const std::size_t before = mine.size();
          for (std::uint32_t j : ids) {
            if (segment_[j] == segment_[i]) continue;
            const vec3 d = cloud_.positions[j] - cloud_.positions[i];
            const Border border{std::min(segment_[i], segment_[j]), std::max(segment_[i], segment_[j]),
                                glm::dot(d, d)};
            const auto same =
                std::find_if(mine.begin() + std::ptrdiff_t(before), mine.end(),
                             [&](const Border& b) { return b.a == border.a && b.b == border.b; });
            if (same == mine.end())
              mine.push_back(border);
            else
              same->distance2 = std::min(same->distance2, border.distance2);
          }
        },
        "borders of clusters");
    std::vector<Border> borders;
    for (const auto& part : found) borders.insert(borders.end(), part.begin(), part.end());
    stoppable_sort(borders, progress_);
    borders.erase(std::unique(borders.begin(), borders.end(),
                              [](const Border& x, const Border& y) { return x.a == y.a && x.b == y.b; }),
                  borders.end());
    progress_.check();
    beyond_.assign(segment_count_, {});
    for (const Border& border : borders) {
      beyond_[border.a].push_back({border.distance2, border.b});
      beyond_[border.b].push_back({border.distance2, border.a});
    }
    progress_.check();
    for (auto& list : beyond_) std::sort(list.begin(), list.end());
  }

  /// Regions of segments: a segment takes in the neighbours of like mean colour that no region has yet.
  void merge_like_colors() {
    constexpr std::uint32_t none = ~0u;
    region_.assign(segment_count_, none);
    const std::vector<std::array<int, 3>> mean = mean_colors();
    const float limit2 = options_.region_threshold * options_.region_threshold;
    std::uint32_t regions = 0;
    for (std::uint32_t s = 0; s < segment_count_; ++s) {
      check_at(s, progress_);
      if (region_[s] == none) region_[s] = regions++;
      for (const Beyond& next : beyond_[s]) {
        if (next.distance2 > gap2_ || mean.empty()) break;
        if (region_[next.segment] != none) continue;
        int difference2 = 0;
        for (int k = 0; k < 3; ++k) {
          const int d = mean[s][std::size_t(k)] - mean[next.segment][std::size_t(k)];
          difference2 += d * d;
        }
        if (float(difference2) < limit2) region_[next.segment] = region_[s];
      }
    }
    region_count_ = regions;
  }

  std::vector<std::array<int, 3>> mean_colors() const {
    if (cloud_.colors.empty()) return {};
    std::vector<std::array<std::uint64_t, 3>> sums(segment_count_);
    for (std::size_t i = 0; i < cloud_.size(); ++i) {
      auto& sum = sums[segment_[i]];
      sum[0] += cloud_.colors[i].r, sum[1] += cloud_.colors[i].g, sum[2] += cloud_.colors[i].b;
    }
    std::vector<std::array<int, 3>> mean(segment_count_);
    for (std::size_t s = 0; s < mean.size(); ++s)
      for (std::size_t k = 0; k < 3; ++k) mean[s][k] = int(sums[s][k] / size_[s]);
    return mean;
  }

  /// Each region in turn, when it is small, joins the one that owns the segment nearest to it.
  void merge_small() {
    std::vector<std::vector<std::uint32_t>> members(region_count_);
    std::vector<std::vector<Beyond>> beyond(region_count_);
    std::vector<std::uint64_t> points(region_count_, 0);
    for (std::uint32_t s = 0; s < segment_count_; ++s) {
      check_at(s, progress_);
      const std::uint32_t r = region_[s];
      members[r].push_back(s);
      points[r] += size_[s];
      beyond[r].insert(beyond[r].end(), beyond_[s].begin(), beyond_[s].end());
    }
    for (std::uint32_t r = 0; r < region_count_; ++r) {
      check_at(r, progress_);
      if (points[r] >= std::uint64_t(options_.min_size)) continue;
      const Beyond* nearest = nullptr;
      for (const Beyond& next : beyond[r])
        if (region_[next.segment] != r && (!nearest || next < *nearest)) nearest = &next;
      if (!nearest) continue;
      const std::uint32_t host = region_[nearest->segment];
      for (std::uint32_t s : members[r]) region_[s] = host;
      points[host] += std::exchange(points[r], 0);
      take_over(members[host], members[r]);
      take_over(beyond[host], beyond[r]);
    }
  }

  template <class T>
  static void take_over(std::vector<T>& into, std::vector<T>& from) {
    if (into.size() < from.size()) std::swap(into, from);
    into.insert(into.end(), from.begin(), from.end());
    from = {};
  }

  /// Regions without gaps in their numbers, in the order of their first segments.
  Clusters number(const std::vector<std::uint32_t>& region) const {
    Clusters out;
    std::vector<std::uint32_t> name(region_count_, ~0u);
    for (std::uint32_t s = 0; s < segment_count_; ++s)
      if (name[region[s]] == ~0u) name[region[s]] = out.count++;
    out.label.resize(cloud_.size());
    for (std::size_t i = 0; i < cloud_.size(); ++i) out.label[i] = name[region[segment_[i]]];
    return out;
  }

  const PointCloud& cloud_;
  const NeighborGraph& graph_;
  const float gap2_;
  const ClusterOptions& options_;
  Progress& progress_;
  std::vector<std::uint32_t> segment_, region_;  // of points; of segments
  std::uint32_t segment_count_ = 0, region_count_ = 0;
  std::vector<std::uint64_t> size_;          // of segments, points
  std::vector<std::vector<Beyond>> beyond_;  // of segments, nearest first
};

}  // namespace

NeighborGraph::NeighborGraph(std::span<const vec3> positions, int k, Progress& progress)
    : tree_(positions),
      k_(positions.empty() ? 0 : std::min(std::size_t(std::max(k, 1)), positions.size() - 1)),
      keeps_(positions.size() * k_ * sizeof(std::uint32_t) <= most_kept_bytes),
      progress_(progress) {
  if (!keeps_ || k_ == 0) return;
  kept_.resize(positions.size() * k_);
  for_each_neighborhood(
      tree_, int(k_),
      [&](std::uint32_t i, std::span<const std::uint32_t> ids, std::span<const float>) {
        std::copy(ids.begin(), ids.end(), kept_.begin() + std::ptrdiff_t(i * k_));
      },
      "neighbors", progress);
}

void NeighborGraph::for_each(const Visit& visit, std::string_view text) const {
  if (!keeps_) {
    for_each_neighborhood(
        tree_, int(k_), [&](std::uint32_t i, auto ids, auto) { visit(i, ids); }, text, progress_);
    return;
  }
  progress_.update(0, text);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, positions().size(), 16'384), [&](const auto& range) {
    progress_.check();
    for (std::size_t i = range.begin(); i < range.end(); ++i)
      visit(std::uint32_t(i), {kept_.data() + i * k_, k_});
  });
}

Clusters grow_clusters(const PointCloud& cloud, const NeighborGraph& graph, float median_spacing,
                       const ClusterOptions& options, Progress& progress) {
  return RegionGrowing(cloud, graph, options.gap.value_or(5 * median_spacing), options, progress).run();
}

}  // namespace sfumato::analysis
