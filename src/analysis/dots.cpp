#include "analysis/dots.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "analysis/neighbors.h"
#include "analysis/normals.h"
#include "analysis/support.h"
#include "analysis/vouched.h"

namespace sfumato::analysis {
namespace {

constexpr std::size_t most_places = 8'192;
constexpr int around_dot = 24;
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
    const std::span<const std::uint32_t> neighbors(ids.data(), found);
    const auto frame = local_frame(positions, std::uint32_t(at), neighbors);
    if (!frame) return;
    const std::size_t last = std::min(eighth, found - 1);
    if (const float farthest2 = distance2_of(keys[last]); farthest2 > 0)
      places.log2_spacing[k] = 0.5f * std::log2(farthest2 * std::numbers::pi_v<float> / float(last + 1)) -
                               std::log2(median_spacing);
    const VoronoiCell cell = cell_of(positions, std::uint32_t(at), neighbors, *frame, frame->normal);
    places.normals[k] = frame->normal;
    places.surface[k] = surrounded(cell) * flatness_of(positions, std::uint32_t(at), neighbors, *frame,
                                                       std::sqrt(distance2_of(keys[found - 1])));
  });
  return places;
}

}  // namespace

std::vector<vec2> dots_of(const PreparedCloud& prepared, Progress& progress) {
  const std::vector<vec3>& positions = prepared.cloud.positions;
  const std::size_t n = positions.size();
  std::vector<vec2> dots(n, vec2(1));
  if (!tells_clutter(n, around_dot)) return dots;
  const std::size_t each = (n + most_places - 1) / most_places;
  const Places places = measure_places(positions, each, prepared.median_spacing, progress);
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
