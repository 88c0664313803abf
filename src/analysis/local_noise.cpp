#include "analysis/local_noise.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>

#include "analysis/along_curve.h"
#include "analysis/dots.h"
#include "analysis/neighbors.h"
#include "analysis/normals.h"
#include "analysis/quantiles.h"

namespace sfumato::analysis {
namespace {

constexpr std::size_t fewest = 8;
/// Of a plane: (n + 3) / 2 of n points are kept, as many as may be while the others are the most.
constexpr std::size_t of_plane = 3;
/// The deviation of normal noise over that of the half that is kept, of 25 points of a plane with noise of .1
/// to .5 spacings: the half is the one that fits best.
constexpr float kept_share = 2.7f;
constexpr int most_steps = 8;
/// The disc through the 8th neighbour holds 8 points' worth of area (analysis/spacing.h).
constexpr std::size_t in_disc = 8;

}  // namespace

float trimmed_deviation(std::span<const vec3> positions) {
  const std::size_t count = positions.size();
  if (count < fewest) return 0;
  std::vector<std::uint32_t> ids(count);
  std::iota(ids.begin(), ids.end(), 0u);
  auto frame = local_frame(positions, 0, std::span(ids).subspan(1));
  if (!frame) return 0;
  // Two surfaces one behind the other are thinnest along their common normal: through the first point those
  // of its own are nearest, from which on each step fits better (Rousseeuw and Van Driessen 1999).
  const auto kept = std::ptrdiff_t((count + of_plane) / 2);
  vec3 middle(0);
  std::vector<float> off(count);
  float deviation = INFINITY;
  for (int step = 0; step < most_steps; ++step) {
    for (std::size_t k = 0; k < count; ++k)
      off[k] = std::abs(glm::dot(positions[k] - positions[0] - middle, frame->normal));
    const auto is_nearer = [&](std::uint32_t a, std::uint32_t b) {
      return off[a] < off[b] || (off[a] == off[b] && a < b);
    };
    std::nth_element(ids.begin(), ids.begin() + kept - 1, ids.end(), is_nearer);
    const std::span<const std::uint32_t> own(ids.data(), std::size_t(kept));
    frame = local_frame(positions, own[0], own.subspan(1));
    if (!frame) return 0;
    middle = vec3(0);
    for (const std::uint32_t k : own) middle += (positions[k] - positions[0]) / float(kept);
    const float now = std::sqrt(frame->variance.x);
    if (!(now < deviation)) break;
    deviation = now;
  }
  return kept_share * deviation * std::sqrt(float(kept) / float(kept - std::ptrdiff_t(of_plane)));
}

PlacedNoise noise_at_places(const Neighborhoods& around, const dvec3& origin, Progress& progress) {
  const std::size_t count = around.places.size();
  std::vector<vec3> places;
  for (const dvec3& place : around.places) places.emplace_back(place - origin);
  PlacedNoise out;
  std::vector<float> own(count), in_spacings(count);
  const std::vector<std::uint32_t> order = order_along_curve(places);
  for (const std::uint32_t k : order) out.places.push_back(places[k]);
  tbb::parallel_for(std::size_t(0), count, [&](std::size_t i) {
    if (i % 1024 == 0) progress.check();
    const std::size_t k = order[i];
    std::vector<vec3> near;
    for (const dvec3& at : around.nearest[k]) near.emplace_back(at - around.places[k]);
    own[i] = trimmed_deviation(near);
    if (near.size() > in_disc)
      in_spacings[i] =
          own[i] /
          std::max(glm::length(near[in_disc]) * std::sqrt(std::numbers::pi_v<float> / in_disc), 1e-30f);
  });
  if (count == 0) return out;
  out.of_spacing = quantile(in_spacings, 0.5);
  out.deviations = own;
  constexpr int others = int(around_dot_place) - 1;
  if (count <= std::size_t(others)) return out;
  const NeighborTree tree(out.places);
  for_each_neighborhood(
      tree, others,
      [&](std::uint32_t k, std::span<const std::uint32_t> ids, std::span<const float>) {
        float sum = own[k];
        for (const std::uint32_t j : ids) sum += own[j];
        out.deviations[k] = sum / float(ids.size() + 1);
      },
      "noise", progress);
  return out;
}

PlacedNoise placed_noise_of(const PreparedCloud& prepared, Progress& progress) {
  if (prepared.whole) return prepared.whole->placed_noise;
  return noise_at_places(around_own_places(prepared), prepared.cloud.origin, progress);
}

std::vector<float> noise_near(std::span<const vec3> positions, const PlacedNoise& noise, Progress& progress) {
  std::vector<float> out(positions.size(), 0);
  if (noise.places.empty()) return out;
  const std::vector<std::uint32_t> nearest = nearest_along_curve(positions, noise.places, progress);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = noise.deviations[nearest[i]];
  return out;
}

}  // namespace sfumato::analysis
