#include "session/connected.h"

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

/// One part for each key, ascending. `room` spares pages where there are several in turn.
void merge(std::vector<Part>& parts, std::vector<Part>& room) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order(
      parts.size());  // far smaller than what it orders
  for (std::uint32_t i = 0; i < parts.size(); ++i) order[i] = {parts[i].key, i};
  tbb::parallel_sort(order.begin(), order.end());
  room.clear();
  room.reserve(parts.size());
  for (const auto& [key, i] : order)
    if (!room.empty() && room.back().key == key)
      room.back().add(parts[i]);
    else
      room.push_back(parts[i]);
  std::swap(parts, room);
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
  // The neighbours that come earlier: as the keys ascend, so do theirs, each by its own place.
  std::array<std::uint32_t, 13> places{};
  for (std::uint32_t i = 0; i < voxels.size(); ++i) {
    const std::uint64_t key = voxels[i].key;
    for (std::size_t step = 0; step < places.size(); ++step) {
      const std::uint64_t x = (key >> 42) + std::uint64_t(step / 9) - 1,
                          y = (key >> 21 & axis_mask) + std::uint64_t(step / 3 % 3) - 1,
                          z = (key & axis_mask) + std::uint64_t(step % 3) - 1;
      if (x > axis_mask || y > axis_mask || z > axis_mask) continue;
      const std::uint64_t other = key_of(x, y, z);
      std::uint32_t& place = places[step];
      while (voxels[place].key < other) ++place;
      if (voxels[place].key == other) root[find(i)] = find(place);
    }
  }
  parts.assign(voxels.size(), {});
  for (std::uint32_t i = 0; i < voxels.size(); ++i) root[i] = find(i), parts[root[i]].add(voxels[i]);
}

/// The voxel of each point, by its key.
std::vector<Part> voxels_of(std::span<const dvec3> points, const dvec3& from, double edge) {
  std::vector<Part> voxels;
  voxels.reserve(points.size());
  for (const dvec3& p : points) {
    const dvec3 at = glm::clamp(glm::floor((p - from) / edge) + most, dvec3(0), dvec3(2 * most - 1));
    const vec4 aslant = along_diagonals(p - from);
    voxels.push_back(
        {key_of(std::uint64_t(at.x), std::uint64_t(at.y), std::uint64_t(at.z)), 1, p, p, aslant, aslant});
  }
  return voxels;
}

/// Of the points in a box those of the largest part that voxels of this edge join.
std::vector<bool> members_of(std::span<const dvec3> points, const Bounds& box, const dvec3& from,
                             double edge) {
  const std::vector<Part> voxel = voxels_of(points, from, edge);
  std::vector<Part> voxels;
  for (const Part& each : voxel)
    if (glm::all(glm::greaterThanEqual(each.low, box.min)) && glm::all(glm::lessThanEqual(each.low, box.max)))
      voxels.push_back(each);
  std::vector<bool> members(points.size(), voxels.empty());
  if (voxels.empty()) return members;
  std::vector<Part> parts;
  merge(voxels, parts);
  std::vector<std::uint32_t> root;
  components(voxels, root, parts);
  const auto largest = std::max_element(parts.begin(), parts.end(),
                                        [](const Part& a, const Part& b) { return a.points < b.points; });
  std::vector<std::uint64_t> keys;
  for (std::size_t i = 0; i < voxels.size(); ++i)
    if (root[i] == largest - parts.begin()) keys.push_back(voxels[i].key);
  for (std::size_t i = 0; i < points.size(); ++i)
    members[i] = std::binary_search(keys.begin(), keys.end(), voxel[i].key);
  return members;
}

}  // namespace

Connected connected(std::span<const dvec3> points, const Bounds& usual, double gain, Progress& progress) {
  constexpr double finest = 1024;  // of the usual size: a pixel or two
  const double edge = usual.diagonal() / finest;
  if (!(edge > 0)) return {usual, std::vector<bool>(points.size(), true)};
  std::vector<Part> voxels = voxels_of(points, usual.min, edge), parts;
  std::vector<std::uint32_t> root;
  Connected best{usual, {}};
  double joined = edge;  // the width of what joins the best
  double highest = -std::numeric_limits<double>::infinity();
  for (double width = edge;; width *= 2) {
    progress.check();
    merge(voxels, parts);
    progress.check();
    components(voxels, root, parts);
    for (const Part& part : parts) {
      progress.check();
      const double size = part.size();
      if (size < edge) continue;  // what a pixel of the usual picture holds is a place in it
      const double score = std::log(part.points) - gain * std::log(size);
      if (score > highest) highest = score, best = {{part.low, part.high}, {}}, joined = width;
    }
    if (std::count(root.begin(), root.end(), root[0]) == std::ptrdiff_t(root.size())) break;
    for (Part& voxel : voxels)
      voxel.key = key_of(voxel.key >> 43, voxel.key >> 22 & axis_mask >> 1, (voxel.key & axis_mask) >> 1);
  }
  best.members = members_of(points, best.box, usual.min, joined);
  return best;
}

}  // namespace sfumato
