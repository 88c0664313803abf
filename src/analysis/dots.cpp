#include "analysis/dots.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "analysis/neighbors.h"
#include "analysis/normals.h"
#include "analysis/support.h"
#include "analysis/vouched.h"

namespace sfumato::analysis {
namespace {

constexpr int around_dot = int(around_dot_place) - 1;
/// The disc through the 8th neighbour holds 8 points' worth of area (analysis/spacing.h).
constexpr std::size_t eighth = 7;
/// Cosine of 30 degrees: discs that are tilted by more against each other do not meet.
constexpr float of_one_plane = 0.866f;
/// The share of neighbourhoods that are flat, closed and of one plane: the median of nine trees and forests
/// is 0 to 0.14, of their points three quarters are below 0.13 in seven; ground has 0.95, rough roofs and
/// gardens 0.4, edges half of what lies beside them.
constexpr float crown_share = 0.1f, ground_share = 0.4f;

struct Places {
  std::vector<vec3> positions;
  std::vector<vec3> normals;
  std::vector<float> surface, log2_spacing;
};

/// `neighbors`: from near to far.
void measure_place(std::span<const vec3> positions, std::uint32_t at,
                   std::span<const std::uint32_t> neighbors, float median_spacing, Places& places,
                   std::size_t k) {
  const auto frame = local_frame(positions, at, neighbors);
  if (!frame) return;
  const auto distance2 = [&](std::size_t nth) {
    const vec3 d = positions[neighbors[nth]] - positions[at];
    return d.x * d.x + d.y * d.y + d.z * d.z;
  };
  const std::size_t last = std::min(eighth, neighbors.size() - 1);
  if (const float farthest2 = distance2(last); farthest2 > 0)
    places.log2_spacing[k] =
        0.5f * std::log2(farthest2 * std::numbers::pi_v<float> / float(last + 1)) - std::log2(median_spacing);
  const VoronoiCell cell = cell_of(positions, at, neighbors, *frame, frame->normal);
  places.normals[k] = frame->normal;
  places.surface[k] = surrounded(cell) * flatness_of(positions, at, neighbors, *frame,
                                                     std::sqrt(distance2(neighbors.size() - 1)));
}

Places measure_places(const std::vector<vec3>& positions, std::size_t each, float median_spacing,
                      Progress& progress) {
  const std::size_t n = positions.size(), count = (n + each - 1) / each;
  Places places{std::vector<vec3>(count), std::vector<vec3>(count, vec3(0)), std::vector<float>(count),
                std::vector<float>(count, 0.0f)};
  const NeighborTree tree(positions);
  tbb::parallel_for(std::size_t(0), count, [&](std::size_t k) {
    if (k % 1024 == 0) progress.check();
    const std::size_t at = (k * each + std::min(n, (k + 1) * each)) / 2;
    places.positions[k] = positions[at];
    KNearest nearest(around_dot);
    nearest.start(std::uint32_t(at));
    tree.search(positions[at], nearest);
    std::array<std::uint64_t, around_dot> keys;
    const std::size_t found = nearest.heap().size();
    std::copy(nearest.heap().begin(), nearest.heap().end(), keys.begin());
    std::sort(keys.begin(), keys.begin() + std::ptrdiff_t(found));
    std::array<std::uint32_t, around_dot> ids;
    std::transform(keys.begin(), keys.begin() + std::ptrdiff_t(found), ids.begin(), id_of);
    measure_place(positions, std::uint32_t(at), std::span<const std::uint32_t>(ids.data(), found),
                  median_spacing, places, k);
  });
  return places;
}

std::vector<vec2> means_of(const Places& places, Progress& progress) {
  const std::size_t count = places.positions.size();
  std::vector<vec2> means(count);
  const NeighborTree tree(places.positions);
  for_each_neighborhood(
      tree, around_dot,
      [&](std::uint32_t k, std::span<const std::uint32_t> ids, std::span<const float>) {
        vec2 sum(places.log2_spacing[k], places.surface[k]);
        for (const std::uint32_t j : ids) {
          const bool agree = std::abs(glm::dot(places.normals[k], places.normals[j])) > of_one_plane;
          sum += vec2(places.log2_spacing[j], agree ? places.surface[j] : 0);
        }
        sum /= float(ids.size() + 1);
        means[k] = vec2(std::exp2(sum.x), glm::smoothstep(crown_share, ground_share, sum.y));
      },
      "dots", progress);
  return means;
}

std::vector<vec2> dots_of_part(const PointCloud& part, const WholeCloud& whole) {
  std::vector<vec2> dots(part.size(), vec2(1));
  if (whole.places.empty()) return dots;
  const NeighborTree tree(whole.places);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, part.size()), [&](const auto& range) {
    KNearest nearest(1);
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      nearest.start(std::numeric_limits<std::uint32_t>::max());
      tree.search(part.positions[i], nearest);
      dots[i] = whole.dots[id_of(nearest.heap().front())];
    }
  });
  return dots;
}

}  // namespace

std::vector<vec2> dots_at(const Neighborhoods& around, const dvec3& origin, std::uint64_t points,
                          float median_spacing, Progress& progress) {
  const std::size_t count = around.places.size();
  if (!tells_clutter(points, around_dot)) return std::vector<vec2>(count, vec2(1));
  Places places{std::vector<vec3>(count), std::vector<vec3>(count, vec3(0)), std::vector<float>(count),
                std::vector<float>(count, 0.0f)};
  tbb::parallel_for(std::size_t(0), count, [&](std::size_t k) {
    places.positions[k] = vec3(around.places[k] - origin);
    std::vector<vec3> near;
    for (const dvec3& at : around.nearest[k]) near.emplace_back(at - around.places[k]);
    std::vector<std::uint32_t> others(near.size() - 1);
    std::iota(others.begin(), others.end(), 1u);
    if (!others.empty()) measure_place(near, 0, others, median_spacing, places, k);
  });
  return means_of(places, progress);
}

std::vector<vec2> dots_of(const PreparedCloud& prepared, Progress& progress) {
  const std::vector<vec3>& positions = prepared.cloud.positions;
  const std::size_t n = positions.size();
  if (prepared.whole) return dots_of_part(prepared.cloud, *prepared.whole);
  std::vector<vec2> dots(n, vec2(1));
  if (!tells_clutter(n, around_dot)) return dots;
  const std::size_t each = (n + most_dot_places - 1) / most_dot_places;
  const Places places = measure_places(positions, each, prepared.median_spacing, progress);
  const std::size_t count = places.positions.size();
  const std::vector<vec2> means = means_of(places, progress);
  tbb::parallel_for(std::size_t(0), count, [&](std::size_t k) {
    std::fill(dots.begin() + std::ptrdiff_t(k * each),
              dots.begin() + std::ptrdiff_t(std::min(n, (k + 1) * each)), means[k]);
  });
  // Which of coincident points comes first is chance.
  for (std::size_t i = 1; i < n; ++i)
    if (positions[i] == positions[i - 1]) dots[i] = dots[i - 1];
  return dots;
}

}  // namespace sfumato::analysis
