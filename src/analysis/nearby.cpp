#include "analysis/nearby.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "analysis/neighbors.h"
#include "core/order.h"

namespace sfumato::analysis {
namespace {

template <class Body>
void for_each_point(std::size_t count, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 16'384), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) body(i);
  });
}

/// Eq. 21 over its radius is the mean of (2 - |n . n_j|)^2: 1 on a plane, 4 at most, 7/3 where directions are
/// independent and equally likely (|n . n_j| is then uniform in [0,1]): `random_normals` of the way.
constexpr float unbent = 1, most_bent = 4;

}  // namespace

Nearby::Nearby(std::span<const vec3> positions, Progress& progress)
    : each_(positions.size() > most ? most : std::max<std::size_t>(positions.size(), 1) - 1),
      ids_(positions.size() * each_) {
  if (each_ == 0) return;
  for_each_neighborhood(
      NeighborTree(positions), int(each_),
      [&](std::uint32_t i, std::span<const std::uint32_t> ids, auto) {
        std::copy(ids.begin(), ids.end(), ids_.begin() + std::ptrdiff_t(i * each_));
      },
      "points around each other", progress);
}

std::vector<float> Nearby::expected_radii(std::span<const vec3> positions,
                                          std::span<const float> radii) const {
  std::vector<float> result(radii.begin(), radii.end());
  if (each_ < most) return result;  // too few points to say what is usual
  constexpr std::size_t middle = most / 2, sixth = 5;
  for_each_point(radii.size(), [&](std::size_t i) {
    std::array<float, most> size, distance2;
    for (std::size_t k = 0; k < most; ++k) {
      const std::uint32_t j = of(i)[k];
      const vec3 away = positions[j] - positions[i];
      size[k] = radii[j];
      distance2[k] = glm::dot(away, away);
    }
    const float usual = nth_value(size, middle);
    const float own = 2 * std::sqrt(nth_value(distance2, sixth) / float(sixth + 1));
    if (usual > 0) result[i] = usual;
    // Six points vary: that they lie in a quarter of their usual radius is what three in a million do at
    // random. 0: coincident points, which say nothing.
    if (own > 0) result[i] = std::min(result[i], 2 * own);
  });
  return result;
}

std::vector<float> Nearby::smoothed(std::vector<float> values, int times) const {
  std::vector<float> next(values.size());
  for (int pass = 0; pass < times; ++pass) {
    for_each_point(values.size(), [&](std::size_t i) {
      float sum = values[i];
      for (std::uint32_t j : of(i)) sum += values[j];
      next[i] = sum / float(each_ + 1);
    });
    values.swap(next);
  }
  return values;
}

void limit_isolated(std::span<const vec3> positions, const Nearby& nearby, std::vector<float>& radii) {
  const std::vector<float> expected = nearby.expected_radii(positions, radii);
  for (std::size_t i = 0; i < radii.size(); ++i)
    if (expected[i] > 0) radii[i] = std::min(radii[i], isolated * expected[i]);
}

std::vector<float> scale_free_uncertainty(const PreparedCloud& prepared, const Nearby& nearby) {
  // As uncertainty was measured: by the radii that points in clutter would have on a surface.
  std::vector<float> radii = prepared.cloud.radii;
  for (std::size_t i = 0; i < prepared.shrunk.size(); ++i) radii[i] /= prepared.shrunk[i];
  const std::vector<float>& uncertainty = prepared.cloud.scalar("uncertainty")->values;
  const std::vector<float> around = nearby.expected_radii(prepared.cloud.positions, radii);
  std::vector<float> values(radii.size());
  // r_i of Eq. 21 counts in radii of the surroundings, not in metres: a wall far from the scanner is as
  // certain as one near it. From where it exceeds what the rim of a surface has, which sees half of its
  // neighbours, and no further than `isolated`: a point that stands alone does not make those it stands near
  // uncertain.
  constexpr float rim = std::numbers::sqrt2_v<float>;
  for_each_point(values.size(), [&](std::size_t i) {
    const float size = around[i] > 0 ? std::clamp(radii[i] / (rim * around[i]), 1.0f, isolated / rim) : 1;
    values[i] = radii[i] > 0 ? size * uncertainty[i] / radii[i] : unbent;
  });
  constexpr int times = 4;  // over about seven spacings
  values = nearby.smoothed(std::move(values), times);
  for_each_point(values.size(), [&](std::size_t i) {
    const bool alone = around[i] > 0 && radii[i] > isolated * around[i];
    values[i] = alone ? 1 : std::clamp((values[i] - unbent) / (most_bent - unbent), 0.0f, 1.0f);
  });
  return values;
}

}  // namespace sfumato::analysis
