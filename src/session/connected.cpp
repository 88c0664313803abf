#include "session/connected.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

namespace sfumato {
namespace {

constexpr double most = 1 << 20;  // voxels to each side: 21 bits an axis
constexpr std::uint64_t axis_mask = (1 << 21) - 1;

/// Where a place is along the four diagonals of a cube.
vec4 along_diagonals(const dvec3& p) {
  const glm::dvec4 along(p.x + p.y + p.z, p.x + p.y - p.z, p.x - p.y + p.z, -p.x + p.y + p.z);
  return vec4(along / std::sqrt(3.0));
}

struct Part {
  std::uint64_t key = 0;
  double points = 0;
  dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
  vec4 low_aslant{std::numeric_limits<float>::infinity()},
      high_aslant{-std::numeric_limits<float>::infinity()};
  void add(const Part& other) {
    points += other.points;
    low = glm::min(low, other.low), high = glm::max(high, other.high);
    low_aslant = glm::min(low_aslant, other.low_aslant),
    high_aslant = glm::max(high_aslant, other.high_aslant);
  }
  /// The mean width, of seven directions: what lies in a corner of a box adds to it.
  double size() const {
    return (glm::dot(high - low, dvec3(1)) + double(glm::dot(high_aslant - low_aslant, vec4(1)))) / 7;
  }
};

std::uint64_t key_of(std::uint64_t x, std::uint64_t y, std::uint64_t z) { return x << 42 | y << 21 | z; }
/// Of the voxel twice as wide `times` times over that holds it.
std::uint64_t wider(std::uint64_t key, int times) {
  return key_of(key >> 42 >> times, (key >> 21 & axis_mask) >> times, (key & axis_mask) >> times);
}

/// The voxel of each point.
std::vector<std::uint64_t> keys_of(std::span<const dvec3> points, const dvec3& from, double edge) {
  std::vector<std::uint64_t> keys(points.size());
  tbb::parallel_for(std::size_t(0), points.size(), [&](std::size_t i) {
    const dvec3 at = glm::clamp(glm::floor((points[i] - from) / edge) + most, dvec3(0), dvec3(2 * most - 1));
    keys[i] = key_of(std::uint64_t(at.x), std::uint64_t(at.y), std::uint64_t(at.z));
  });
  return keys;
}

using Keyed = std::pair<std::uint64_t, std::uint32_t>;

/// One part for each key, ascending, of what `add` adds to it: of each of the keyed, in their order.
template <class Add>
void merge(std::vector<Keyed>& keyed, std::vector<Part>& parts, const Add& add) {
  tbb::parallel_sort(keyed.begin(), keyed.end());
  constexpr std::size_t blocks = 64;
  std::array<std::size_t, blocks + 1> begins{}, firsts{};  // of the keyed, of parts
  for (std::size_t b = 1; b <= blocks; ++b) {
    std::size_t at = std::max(begins[b - 1], b * keyed.size() / blocks);
    while (at > 0 && at < keyed.size() && keyed[at].first == keyed[at - 1].first) ++at;
    begins[b] = at;
  }
  const auto is_new = [&](std::size_t k) { return k == 0 || keyed[k].first != keyed[k - 1].first; };
  tbb::parallel_for(std::size_t(0), blocks, [&](std::size_t b) {
    for (std::size_t k = begins[b]; k < begins[b + 1]; ++k) firsts[b + 1] += is_new(k);
  });
  std::partial_sum(firsts.begin(), firsts.end(), firsts.begin());
  parts.assign(firsts[blocks], {});
  tbb::parallel_for(std::size_t(0), blocks, [&](std::size_t b) {
    std::size_t to = firsts[b];
    for (std::size_t k = begins[b]; k < begins[b + 1]; ++k) {
      if (is_new(k) && k > begins[b]) ++to;
      parts[to].key = keyed[k].first;
      add(parts[to], keyed[k].second);
    }
  });
}

/// Of voxels, whose keys ascend, what touches by a side, an edge or a corner: each at the place of one of its
/// voxels, which is the root of all of them; nothing at the others.
void components(const std::vector<Part>& voxels, std::vector<std::uint32_t>& root, std::vector<Part>& parts) {
  root.resize(voxels.size());
  std::iota(root.begin(), root.end(), 0u);
  const auto find = [&](std::uint32_t i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  // Of those that come earlier four rows beside it, each from one below to one above it, and the one below it
  // in its own: as the keys ascend, so do the places where a row is met.
  constexpr std::array<std::pair<int, int>, 4> rows{{{-1, -1}, {-1, 0}, {-1, 1}, {0, -1}}};
  std::array<std::uint32_t, rows.size()> places{};
  for (std::uint32_t i = 0; i < voxels.size(); ++i) {
    const std::uint64_t key = voxels[i].key, z = key & axis_mask;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const std::uint64_t x = (key >> 42) + std::uint64_t(rows[r].first),
                          y = (key >> 21 & axis_mask) + std::uint64_t(rows[r].second);
      if (x > axis_mask || y > axis_mask) continue;
      const std::uint64_t low = key_of(x, y, z - (z > 0)), high = key_of(x, y, std::min(z + 1, axis_mask));
      std::uint32_t& place = places[r];
      while (voxels[place].key < low) ++place;
      for (std::uint32_t k = place; voxels[k].key <= high; ++k) root[find(i)] = find(k);
    }
    if (i > 0 && z > 0 && voxels[i - 1].key == key - 1) root[find(i)] = find(i - 1);
  }
  parts.assign(voxels.size(), {});
  for (std::uint32_t i = 0; i < voxels.size(); ++i) root[i] = find(i), parts[root[i]].add(voxels[i]);
}

void add_point(Part& part, const dvec3& p, const dvec3& from) {
  const vec4 aslant = along_diagonals(p - from);
  part.add({0, 1, p, p, aslant, aslant});
}

/// Of the points in a box those of the largest part that voxels of these keys join.
std::vector<bool> members_of(std::span<const dvec3> points, const Bounds& box, const dvec3& from,
                             const std::vector<std::uint64_t>& keys) {
  std::vector<Keyed> inside;
  for (std::uint32_t i = 0; i < points.size(); ++i)
    if (glm::all(glm::greaterThanEqual(points[i], box.min)) &&
        glm::all(glm::lessThanEqual(points[i], box.max)))
      inside.emplace_back(keys[i], i);
  std::vector<bool> members(points.size(), inside.empty());
  if (inside.empty()) return members;
  std::vector<Part> voxels, parts;
  merge(inside, voxels, [&](Part& part, std::uint32_t i) { add_point(part, points[i], from); });
  std::vector<std::uint32_t> root;
  components(voxels, root, parts);
  const auto largest = std::max_element(parts.begin(), parts.end(),
                                        [](const Part& a, const Part& b) { return a.points < b.points; });
  std::vector<std::uint64_t> joined;
  for (std::size_t i = 0; i < voxels.size(); ++i)
    if (root[i] == largest - parts.begin()) joined.push_back(voxels[i].key);
  for (std::size_t i = 0; i < points.size(); ++i)
    members[i] = std::binary_search(joined.begin(), joined.end(), keys[i]);
  return members;
}

}  // namespace

Connected connected(std::span<const dvec3> points, const Bounds& usual, double gain, Progress& progress) {
  constexpr double finest = 1024;  // of the usual size: a pixel or two
  const double edge = usual.diagonal() / finest;
  if (!(edge > 0)) return {usual, std::vector<bool>(points.size(), true)};
  std::vector<std::uint64_t> keys = keys_of(points, usual.min, edge);
  std::vector<Keyed> keyed(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) keyed[i] = {keys[i], i};
  std::vector<Part> voxels, narrower, parts;
  merge(keyed, voxels, [&](Part& part, std::uint32_t i) { add_point(part, points[i], usual.min); });
  std::vector<std::uint32_t> root;
  struct Found {
    Bounds box;
    double size = 0;
    std::uint64_t voxel = 0;  // one of it
    int joined = 0;           // doublings of the edge of what joins it
  };
  Found best{usual}, shown{usual};  // and with what goes on from it
  double highest = -std::numeric_limits<double>::infinity();
  for (int doublings = 0;; ++doublings) {
    progress.check();
    components(voxels, root, parts);
    for (const Part& part : parts) {
      progress.check();
      const double size = part.size();
      if (size < edge) continue;  // what a pixel of the usual picture holds is a place in it
      const double score = std::log(part.points) - gain * std::log(size);
      if (score <= highest) continue;
      highest = score;
      best = shown = {{part.low, part.high}, size, voxels[std::size_t(&part - parts.data())].key, doublings};
    }
    // Voxels that touch hold points up to two edges apart.
    if (doublings > best.joined && 2 * std::ldexp(edge, doublings) <= gap_that_shows * best.size) {
      const auto voxel =
          std::lower_bound(voxels.begin(), voxels.end(), wider(best.voxel, doublings - best.joined),
                           [](const Part& each, std::uint64_t key) { return each.key < key; });
      const Part& part = parts[root[std::size_t(voxel - voxels.begin())]];
      const bool is_too_much = part.size() > (1 + most_added) * best.size;
      shown = is_too_much ? best : Found{{part.low, part.high}, part.size(), voxel->key, doublings};
    }
    if (std::count(root.begin(), root.end(), root[0]) == std::ptrdiff_t(root.size())) break;
    progress.check();
    std::swap(voxels, narrower);
    keyed.resize(narrower.size());
    for (std::uint32_t i = 0; i < narrower.size(); ++i) keyed[i] = {wider(narrower[i].key, 1), i};
    merge(keyed, voxels, [&](Part& part, std::uint32_t i) { part.add(narrower[i]); });
  }
  tbb::parallel_for(std::size_t(0), keys.size(),
                    [&](std::size_t i) { keys[i] = wider(keys[i], shown.joined); });
  return {shown.box, members_of(points, shown.box, usual.min, keys)};
}

}  // namespace sfumato
