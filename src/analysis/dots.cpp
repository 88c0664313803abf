#include "analysis/dots.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>
#include <utility>

#include "analysis/along_curve.h"
#include "analysis/neighbors.h"
#include "analysis/normals.h"
#include "analysis/support.h"
#include "analysis/vouched.h"

namespace sfumato::analysis {
namespace {

constexpr int around_dot = int(around_dot_place) - 1;
/// The disc through the 8th neighbour holds 8 points' worth of area (analysis/spacing.h), the stretch of a
/// line as many of length.
constexpr std::size_t eighth = 7;
/// Sparse ends of a scan are not drawn as balls of so many median spacings and more.
constexpr float largest_medians = 4;
/// Cosine of 30 degrees: discs that are tilted by more against each other do not meet.
constexpr float of_one_plane = 0.866f;
/// The share of neighbourhoods that are flat, closed and of one plane: the median of nine trees and forests
/// is 0 to 0.14, of their points three quarters are below 0.13 in seven; ground has 0.95, rough roofs and
/// gardens 0.4, edges half of what lies beside them.
constexpr float crown_share = 0.1f, ground_share = 0.4f;

struct Places {
  std::vector<vec3> positions;
  std::vector<vec3> normals;
  std::vector<float> surface;
  std::vector<float> log2_reach;         ///< of the 8th neighbour
  std::vector<float> inverse_dimension;  ///< 1 on a line, 1/2 on a surface
};

/// Of what is there, from a line (1) to a surface (2).
float dimension_of(float inverse_dimension) {
  // Of a surface the mean of 25 places scatters by .02, were they apart.
  constexpr float unsure = 0.05f;
  return 1 / std::clamp(inverse_dimension - unsure, 0.5f, 1.0f);
}

/// So far apart are points of which 8 are within a reach: on lines they need to meet the next on the line,
/// not the next line.
float spacing_at(float log2_reach, float dimension) {
  const float ball = std::pow(std::numbers::pi_v<float>, dimension / 2) / std::tgamma(dimension / 2 + 1);
  return std::exp2(log2_reach) * std::pow(ball / float(eighth + 1), 1 / dimension);
}

/// Of the first of `positions`. `neighbors`: the others, from near to far.
void measure_place(std::span<const vec3> positions, std::span<const std::uint32_t> neighbors, Places& places,
                   std::size_t k) {
  constexpr std::uint32_t at = 0;
  const auto frame = local_frame(positions, at, neighbors);
  if (!frame) return;
  const auto distance2 = [&](std::size_t nth) {
    const vec3 d = positions[neighbors[nth]] - positions[at];
    return d.x * d.x + d.y * d.y + d.z * d.z;
  };
  // (Levina and Bickel 2004, Eq. 8); the mean of its inverse is that of the likelihood.
  const std::size_t count = neighbors.size();
  if (const float farthest2 = distance2(std::min(eighth, count - 1)); farthest2 > 0 && count > eighth) {
    places.log2_reach[k] = 0.5f * std::log2(farthest2);
    float sum = 0;
    for (std::size_t nth = 0; nth + 1 < count; ++nth)
      if (distance2(nth) > 0) sum += 0.5f * std::log(distance2(count - 1) / distance2(nth));
    places.inverse_dimension[k] = sum / float(count - 1);
  }
  const VoronoiCell cell = cell_of(positions, at, neighbors, *frame, frame->normal);
  places.normals[k] = frame->normal;
  places.surface[k] = surrounded(cell) * flatness_of(positions, at, neighbors, *frame,
                                                     std::sqrt(distance2(neighbors.size() - 1)));
}

std::vector<vec2> means_of(const Places& places, float largest, Progress& progress) {
  const std::size_t count = places.positions.size();
  std::vector<vec2> means(count);
  const NeighborTree tree(places.positions);
  for_each_neighborhood(
      tree, around_dot,
      [&](std::uint32_t k, std::span<const std::uint32_t> ids, std::span<const float>) {
        vec2 sum(places.log2_reach[k], places.surface[k]);
        float dimensions = places.inverse_dimension[k];
        for (const std::uint32_t j : ids) {
          const bool agree = std::abs(glm::dot(places.normals[k], places.normals[j])) > of_one_plane;
          sum += vec2(places.log2_reach[j], agree ? places.surface[j] : 0);
          dimensions += places.inverse_dimension[j];
        }
        const float all = float(ids.size() + 1), dimension = dimension_of(dimensions / all);
        means[k] = vec2(std::min(spacing_at(sum.x / all, dimension), largest),
                        glm::smoothstep(crown_share, ground_share, sum.y / all) * (dimension - 1));
      },
      "dots", progress);
  return means;
}

}  // namespace

PlacedDots dots_at(const Neighborhoods& around, const dvec3& origin, std::uint64_t points,
                   float median_spacing, Progress& progress) {
  const std::size_t count = around.places.size();
  PlacedDots out;
  for (const dvec3& place : around.places) out.places.emplace_back(place - origin);
  const float measured = spacing_of(around), usual = measured > 0 ? measured : median_spacing;
  if (!tells_clutter(points, around_dot)) {
    out.dots.assign(count, vec2(usual, 1));
    return out;
  }
  // Neighbours are found fast along the curve.
  const std::vector<std::uint32_t> order = order_along_curve(out.places);
  Places places{std::vector<vec3>(count), std::vector<vec3>(count, vec3(0)), std::vector<float>(count),
                std::vector<float>(count, std::log2(usual / spacing_at(0, 2))),
                std::vector<float>(count, 0.5f)};
  tbb::parallel_for(std::size_t(0), count, [&](std::size_t i) {
    if (i % 1024 == 0) progress.check();
    const std::size_t k = order[i];
    places.positions[i] = out.places[k];
    std::vector<vec3> near;
    for (const dvec3& at : around.nearest[k]) near.emplace_back(at - around.places[k]);
    std::vector<std::uint32_t> others(near.size() - 1);
    std::iota(others.begin(), others.end(), 1u);
    if (!others.empty()) measure_place(near, others, places, i);
  });
  out.dots = means_of(places, largest_medians * usual, progress);
  out.places = std::move(places.positions);
  return out;
}

Neighborhoods around_own_places(const PreparedCloud& prepared) {
  return neighborhoods_of(NeighborTree(prepared.cloud.positions), prepared.cloud.origin,
                          first_places(places_in(prepared.cloud), CloudFacts::most_places), around_dot_place);
}

std::vector<vec2> dots_of(const PreparedCloud& prepared, Progress& progress) {
  const std::vector<vec3>& positions = prepared.cloud.positions;
  PlacedDots own;
  if (!prepared.whole)
    own = dots_at(around_own_places(prepared), prepared.cloud.origin, positions.size(),
                  prepared.median_spacing, progress);
  const PlacedDots& placed = prepared.whole ? prepared.whole->dots : own;
  const std::size_t count = placed.places.size();
  const float unit = prepared.spacing_unit();
  std::vector<vec2> dots(positions.size(), vec2(prepared.median_spacing / unit, 1));
  if (count == 0) return dots;
  const std::vector<std::uint32_t> nearest = nearest_along_curve(positions, placed.places, progress);
  for (std::size_t i = 0; i < dots.size(); ++i) dots[i] = placed.dots[nearest[i]] / vec2(unit, 1);
  return dots;
}

}  // namespace sfumato::analysis
