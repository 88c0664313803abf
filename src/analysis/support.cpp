#include "analysis/support.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "analysis/neighbors.h"
#include "core/order.h"

namespace sfumato::analysis {
namespace {

/// A neighbourhood's least variance over its greatest, "scatter". Measured for 24 neighbours: planes 0, with
/// noise of 0.3 spacings 0.03 (95 %: 0.06); statues 0.01 to 0.05; edges of a box 0.12; forest 0.17 (5 %:
/// 0.05), a filled ball 0.44 (5 %: 0.23).
constexpr float flat_scatter = 0.05f, rough_scatter = 0.18f;
/// The share of neighbours within a tenth of the neighbourhood's radius from the plane through the point:
/// 0.75 for one of two sheets two spacings apart, 0.3 in a ball.
constexpr float sheet_layer = 0.1f, sheet_low = 0.5f, sheet_high = 0.7f;
/// How far the middle of the neighbours is from the point, over the farthest one's distance: 0.42 at the
/// border of a surface, 0.6 at a corner of it; nearly 1 for a stray point, whose neighbours all lie on
/// something else.
constexpr float aside_low = 0.65f, aside_high = 0.85f;
/// The share of flat neighbourhoods in a region: 0.7 around an edge, 0.2 in a forest. Where it is high
/// everything is a surface; where it is low nothing is, for one in five neighbourhoods of leaves is flat by
/// chance, and their discs would make the crown; between, each point speaks for itself.
constexpr float chance_low = 0.22f, chance_high = 0.42f, region_low = 0.3f, region_high = 0.55f;

/// Flat neighbourhoods of a surface agree on its direction, those of leaves do by chance only: the cosine
/// between two, and the share of a region that is flat and agrees, 0.9 on planes, 0.3 at edges, 0.03 among
/// leaves.
constexpr float agree_low = 0.7f, agree_high = 0.85f, sole_low = 0.12f, sole_high = 0.24f;

/// How far from a place's plane a point still is of what lies there: in deviations of the place's own points,
/// as its median tells them, and in shares of its reach, for surfaces bend. A tree on a lawn is many
/// deviations off the lawn.
constexpr float layer_deviations = 4, layer_bend = 0.12f;

/// Every so many-th point along the curve.
struct Scale {
  std::size_t every;
  std::vector<vec3> positions;
  std::vector<float>
      surface;  ///< how far there is one: because they are flat among themselves, or by their region
  std::vector<float> trust;  ///< how far a point that is flat itself is to be believed; empty: not asked
  struct Layer {             ///< the points of a place lie about this plane
    vec3 normal{0};
    float offset = 0, thickness = std::numeric_limits<float>::infinity();
  };
  std::vector<Layer> layers;
};

/// `thickness` is where a point is half believed to belong.
Scale::Layer layer_of(std::span<const vec3> positions, std::uint32_t center,
                      std::span<const std::uint32_t> ids, const vec3& normal, float reach) {
  std::array<float, 64> heights;
  const std::size_t count = std::min(ids.size(), heights.size());
  if (count == 0) return {};
  for (std::size_t k = 0; k < count; ++k)
    heights[k] = glm::dot(positions[ids[k]] - positions[center], normal);
  const std::span there(heights.data(), count);
  const float level = median(there);
  for (float& height : there) height = std::abs(height - level);
  // 1.48 medians are a deviation of what is spread normally.
  return {normal, level + glm::dot(positions[center], normal),
          std::max(layer_deviations * 1.48f * median(there), layer_bend * reach)};
}

float belongs(const vec3& position, const Scale::Layer& layer) {
  const float off = std::abs(glm::dot(position, layer.normal) - layer.offset);
  return 1 - glm::smoothstep(0.7f, 1.3f, off / layer.thickness);
}

/// Of the points that each of `count` places stands for.
std::vector<float> means_along(const std::vector<float>& values, std::size_t every, std::size_t count) {
  std::vector<float> means(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t first = i * every, last = std::min(first + every, values.size());
    for (std::size_t j = first; j < last; ++j) means[i] += values[j] / float(last - first);
  }
  return means;
}

/// `by_region`: a place is on a surface where those around it are.
Scale widen(const std::vector<vec3>& positions, std::size_t every, const std::vector<float>& flatness,
            int neighbors, bool by_region, Progress& progress) {
  Scale scale{every, {}, {}, {}, {}};
  for (std::size_t i = every / 2; i < positions.size(); i += every) scale.positions.push_back(positions[i]);
  const std::size_t count = scale.positions.size();
  std::vector<float> own;
  if (by_region) own = means_along(flatness, every, count);
  scale.surface.resize(count);
  scale.layers.resize(count);
  const NeighborTree tree(scale.positions);
  const std::size_t each = std::min(std::size_t(neighbors), count - 1);
  std::vector<std::uint32_t> kept(count * each);
  for_each_neighborhood(
      tree, neighbors,
      [&](std::uint32_t i, std::span<const std::uint32_t> ids, std::span<const float> distances2) {
        std::copy(ids.begin(), ids.end(), kept.begin() + std::ptrdiff_t(i * each));
        const auto frame = local_frame(scale.positions, i, ids);
        const float reach = std::sqrt(distances2.back());
        scale.surface[i] = frame ? flatness_of(scale.positions, i, ids, *frame, reach) : 1;
        if (frame) scale.layers[i] = layer_of(scale.positions, i, ids, frame->normal, reach);
      },
      "surfaces", progress);
  own.resize(count);
  for (std::size_t i = 0; i < count; ++i) own[i] = std::max(own[i], scale.surface[i]);
  // Over the neighbours of each place.
  const auto mean = [&](std::vector<float>& out, auto&& value) {
    out.resize(count);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 16'384), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        float sum = 0;
        for (std::size_t k = i * each; k < (i + 1) * each; ++k) sum += value(i, kept[k]);
        out[i] = sum / float(each);
      }
    });
  };
  std::vector<float> agreed, region, within;
  mean(agreed, [&](std::size_t i, std::uint32_t j) {
    const float turn = std::abs(glm::dot(scale.layers[i].normal, scale.layers[j].normal));
    return own[j] * glm::smoothstep(agree_low, agree_high, turn);
  });
  for (std::size_t i = 0; i < count; ++i) own[i] *= glm::smoothstep(sole_low, sole_high, agreed[i]);
  mean(region, [&](std::size_t, std::uint32_t j) { return own[j]; });
  mean(within,
       [&](std::size_t i, std::uint32_t j) { return own[j] * belongs(scale.positions[i], scale.layers[j]); });
  scale.trust.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    scale.trust[i] = glm::smoothstep(chance_low, chance_high, region[i]);
    const float member = glm::smoothstep(sole_low, sole_high, within[i]);
    scale.surface[i] *= scale.trust[i] * member;
    const float lifted = glm::smoothstep(region_low, region_high, region[i]) * member;
    if (by_region) scale.surface[i] = std::max(scale.surface[i], lifted);
  }
  return scale;
}

/// The nearest to point `i` of the three places that surround it on the curve, which may jump.
std::size_t place_near(const Scale& scale, const vec3& position, std::size_t i) {
  const std::size_t last = scale.positions.size() - 1, own = std::min(i / scale.every, last);
  std::size_t nearest = own;
  float least = std::numeric_limits<float>::infinity();
  for (std::size_t j = own - std::min<std::size_t>(own, 1); j <= std::min(own + 1, last); ++j) {
    const vec3 way = scale.positions[j] - position;
    const float distance2 = glm::dot(way, way);
    if (distance2 < least) least = distance2, nearest = j;
  }
  return nearest;
}

/// The largest `value(j)` of the three places j that surround point `i` on the curve. All of them, since at
/// an edge the nearest may be of the other side.
template <class Value>
float most_around(const Scale& scale, std::size_t i, Value&& value) {
  float most = 0;
  const std::size_t own = std::min(i / scale.every, scale.positions.size() - 1);
  for (std::size_t j = own - std::min<std::size_t>(own, 1); j < std::min(own + 2, scale.positions.size());
       ++j)
    most = std::max(most, value(j));
  return most;
}

/// How far a point lies on what the places next to it have of a surface.
float on_surface_of(const Scale& scale, const vec3& position, std::size_t i) {
  return most_around(scale, i,
                     [&](std::size_t j) { return scale.surface[j] * belongs(position, scale.layers[j]); });
}

/// The mean of `values` over each place of a scale and its neighbours.
std::vector<float> means_around(const Scale& scale, const std::vector<float>& values, int neighbors,
                                Progress& progress) {
  const std::vector<float> means = means_along(values, scale.every, scale.positions.size());
  std::vector<float> around = means;
  const NeighborTree tree(scale.positions);
  for_each_neighborhood(
      tree, neighbors,
      [&](std::uint32_t i, std::span<const std::uint32_t> ids, std::span<const float>) {
        for (std::uint32_t j : ids) around[i] += means[j];
        around[i] /= float(ids.size() + 1);
      },
      "surfaces", progress);
  return around;
}

}  // namespace

float scatter_of(const LocalFrame& frame) {
  const float wide = std::sqrt(frame.variance.y * frame.variance.z);
  return wide > 0 ? frame.variance.x / wide : 0;
}

bool is_flat(float scatter) { return scatter < flat_scatter; }

float flatness_of(std::span<const vec3> positions, std::uint32_t point,
                  std::span<const std::uint32_t> neighbors, const LocalFrame& frame, float reach) {
  if (!(frame.variance.z > 0)) return 1;
  vec3 middle(0);
  for (std::uint32_t j : neighbors) middle += positions[j] - positions[point];
  const float aside = glm::length(middle) / (float(neighbors.size()) * reach);
  if (aside >= aside_high) return 0;
  const float among = 1 - glm::smoothstep(aside_low, aside_high, aside);
  const float flat = 1 - glm::smoothstep(flat_scatter, rough_scatter, scatter_of(frame));
  if (flat >= 1) return among;
  std::size_t inside = 0;
  for (std::uint32_t j : neighbors)
    inside += std::abs(glm::dot(positions[j] - positions[point], frame.normal)) < sheet_layer * reach;
  return among *
         std::max(flat, glm::smoothstep(sheet_low, sheet_high, float(inside) / float(neighbors.size())));
}

SurfaceShares surface_shares(const std::vector<vec3>& positions, std::vector<float> flatness, int neighbors,
                             Progress& progress) {
  std::vector<Scale> scales;
  for (std::size_t every : {8, 64}) {
    if (positions.size() / every <= std::size_t(neighbors)) break;
    // The region is that of 192 points: of more, a lone tree on a lawn would be lawn.
    scales.push_back(widen(positions, every, flatness, neighbors, scales.empty(), progress));
  }
  const std::vector<float> whole(positions.size(), 1.0f);
  SurfaceShares shares{std::move(flatness), whole, whole};
  // Too few points to know what surrounds them: nothing is clutter.
  if (scales.empty()) {
    std::fill(shares.own.begin(), shares.own.end(), 1.0f);
    return shares;
  }
  const auto for_all = [&](auto&& visit) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, positions.size(), 65'536), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) visit(i);
    });
  };
  for_all([&](std::size_t i) {
    float& own = shares.own[i];
    float around = 0;
    for (const Scale& scale : scales) {
      if (&scale == &scales.front()) own *= scale.trust[place_near(scale, positions[i], i)];
      if (own >= 1) continue;
      around = std::max(around, on_surface_of(scale, positions[i], i));
    }
    own = std::max(own, around);
  });
  if (scales.size() < 2) return shares;
  const Scale& wide = scales.back();
  const std::vector<float> regions = means_around(wide, shares.own, neighbors, progress);
  for_all([&](std::size_t i) {
    shares.in_layer[i] =
        std::max(on_surface_of(scales.front(), positions[i], i),
                 most_around(wide, i, [&](std::size_t j) { return belongs(positions[i], wide.layers[j]); }));
    shares.around[i] =
        std::max(regions[place_near(wide, positions[i], i)], on_surface_of(wide, positions[i], i));
  });
  return shares;
}

}  // namespace sfumato::analysis
