#include "analysis/distances.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <limits>
#include <optional>

#include "analysis/morton.h"
#include "analysis/neighbors.h"
#include "analysis/normals.h"

namespace sfumato::analysis {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr std::uint32_t no_point = std::numeric_limits<std::uint32_t>::max();

/// Positions relative to `origin` along a Morton curve, where searches are fast.
std::vector<vec3> sorted_places(const PointCloud& cloud, const dvec3& origin, Progress& progress) {
  const std::vector<std::uint32_t> order = morton_order(cloud, progress);
  std::vector<vec3> places(cloud.size());
  for (std::size_t i = 0; i < order.size(); ++i) places[i] = vec3(cloud.world(order[i]) - origin);
  return places;
}

/// Calls `work(i)` for all points, in parallel.
template <class Work>
void for_each_point(std::size_t count, const char* step, Progress& progress, const Work& work) {
  constexpr std::size_t portion = 1 << 20;
  for (std::size_t first = 0; first < count; first += portion) {
    progress.check();
    progress.update(double(first) / double(count), step);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(first, std::min(count, first + portion), 1024),
                      [&](const auto& range) { work(range.begin(), range.end()); });
  }
}

/// Mean of the places along `axis` from `center`, of the points within `radius` of the line and `reach` of
/// the center; nothing when there are none. In pieces, so that the boxes that are searched stay slim.
std::optional<double> mean_along(const NeighborTree& tree, const vec3& center, const vec3& axis, float radius,
                                 float reach) {
  double sum = 0;
  std::size_t count = 0;
  const int pieces = std::max(1, int(std::min(std::ceil(reach / radius), 10'000.0f)));
  for (int piece = 0; piece < pieces; ++piece) {
    const float from = reach * (2 * float(piece) / float(pieces) - 1),
                to = piece + 1 == pieces ? std::nextafter(reach, 2 * reach)
                                         : reach * (2 * float(piece + 1) / float(pieces) - 1);
    const vec3 a = center + from * axis, b = center + to * axis;
    tree.leaves_near(glm::min(a, b), glm::max(a, b), radius, [&](std::uint32_t first, std::uint32_t last) {
      for (std::uint32_t j = first; j < last; ++j) {
        const vec3 d = tree.positions()[j] - center;
        const float along = glm::dot(d, axis);
        if (!(along >= from && along < to) || !(glm::dot(d, d) - along * along <= radius * radius)) continue;
        sum += double(along), ++count;
      }
      return true;
    });
  }
  return count > 0 ? std::optional(sum / double(count)) : std::nullopt;
}

std::optional<vec3> normal_in_ball(const NeighborTree& tree, const vec3& center, float radius) {
  double sum[3] = {}, squares[3] = {}, crossed[3] = {};
  std::size_t count = 0;
  tree.leaves_near(center, center, radius, [&](std::uint32_t first, std::uint32_t last) {
    for (std::uint32_t j = first; j < last; ++j) {
      const vec3 d = tree.positions()[j] - center;
      if (glm::dot(d, d) > radius * radius) continue;
      ++count;
      for (int k = 0; k < 3; ++k) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        sum[k] += double(d[k]), squares[k] += double(d[k]) * double(d[k]);
        crossed[k] += double(d[l]) * double(d[m]);
      }
    }
    return true;
  });
  if (count < 3) return std::nullopt;
  vec3 variance, covariance;  // xx yy zz, and yz zx xy
  for (int k = 0; k < 3; ++k) {
    const int l = (k + 1) % 3, m = (k + 2) % 3;
    variance[k] = float(squares[k] - sum[k] * sum[k] / double(count));
    covariance[k] = float(crossed[k] - sum[l] * sum[m] / double(count));
  }
  const auto frame = local_frame(variance, covariance);
  return frame ? std::optional(frame->normal) : std::nullopt;
}

/// Distance to the nearest point, by `nearest` of one.
float distance_to(const NeighborTree& tree, const vec3& place, KNearest& nearest) {
  nearest.start(no_point);
  tree.search(place, nearest);
  return std::sqrt(nearest.limit());
}

}  // namespace

std::vector<float> nearest_distances(const PointCloud& cloud, const PointCloud& reference,
                                     Progress& progress) {
  const std::vector<vec3> others = sorted_places(reference, cloud.origin, progress);
  const NeighborTree tree(others);
  std::vector<float> distances(cloud.size(), nan);
  if (others.empty()) return distances;
  for_each_point(cloud.size(), "distances", progress, [&](std::size_t begin, std::size_t end) {
    KNearest nearest(1);
    for (std::size_t i = begin; i < end; ++i) distances[i] = distance_to(tree, cloud.positions[i], nearest);
  });
  return distances;
}

std::vector<float> signed_distances(const PointCloud& cloud, const PointCloud& reference, double scale,
                                    Progress& progress) {
  const std::vector<vec3> others = sorted_places(reference, cloud.origin, progress),
                          own = sorted_places(cloud, cloud.origin, progress);
  const NeighborTree other_tree(others), own_tree(own);
  const Orientation orientation(cloud);
  std::vector<float> distances(cloud.size(), nan);
  if (others.empty()) return distances;
  const float radius = float(scale / 2);
  for_each_point(cloud.size(), "distances", progress, [&](std::size_t begin, std::size_t end) {
    KNearest nearest(1);
    for (std::size_t i = begin; i < end; ++i) {
      const vec3 place = cloud.positions[i];
      const auto direction = normal_in_ball(own_tree, place, radius);
      if (!direction) continue;
      const vec3 normal = orientation.facing(std::uint32_t(i), *direction);
      const float reach = distance_to(other_tree, place, nearest) + float(scale);
      const auto theirs = mean_along(other_tree, place, normal, radius, reach);
      const auto ours = mean_along(own_tree, place, normal, radius, float(scale));
      if (theirs && ours) distances[i] = float(*ours - *theirs);
    }
  });
  return distances;
}

}  // namespace sfumato::analysis
