#include "analysis/wide_normals.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "analysis/neighbors.h"
#include "analysis/normals.h"
#include "analysis/quantiles.h"

namespace sfumato::analysis {
namespace {

/// So many points that follow each other on the curve, or so many such groups, are seen as one.
constexpr std::size_t group_size = 8;
/// Points that scatter less have normals off by less than 2 degrees: nobody sees it.
constexpr float calm_scatter = 0.015f;
/// And where so few points scatter more, the surfaces are as good as free of noise.
constexpr float few_rough = 0.01f;
/// Of a plane's noise, as far as a point belongs to it.
constexpr float most_deviations = 3;
/// Points that tell how thick the noise is.
constexpr std::size_t most_measured = 250'000;

/// Of the noise of a plane, what a few points about their own plane have of it: three parameters are fitted
/// to them, and a ball reaches less far where it is off the plane, by 2 h^2 / R^2 in the mean, R^2 / 4 = the
/// variance across.
float unbiased(float thickness2, float scatter, float points) {
  return thickness2 * (points / (points - 3)) * (1 + 0.5f * scatter);
}

/// Two estimates of one noise, of 200 points and of the 9 balls among them, differ by that in four of five
/// cases.
constexpr float by_chance = 1.3f;

/// A surface of curvature c bends away from a disc of radius R by c^2 R^4 / 48 (variance), 1/12 of (c R)^2,
/// the square of its turn from the middle to the rim, times R^2 / 4, the variance across. Those that ask are
/// up to a third of R from the middle: 4/3 of the ratio. Edges turn more abruptly; 4 keeps those of statues
/// (docs/analysis.md).
constexpr float bend_factor = 4;

struct Group {
  vec3 middle{0};
  float points = 0;
  std::array<vec3, 2> covariance{};  ///< xx yy zz, yz zx xy
  float thickness2 = 0;              ///< mean of what was told from nearer by
  float scatter = 0;                 ///< the largest of its points
};

/// Sums over groups, relative to `origin`.
class Sum {
 public:
  explicit Sum(const vec3& origin) : origin_(origin) {}
  void add(const Group& group) {
    const vec3 d = group.middle - origin_;
    const vec3 crossed(d.y * d.z, d.z * d.x, d.x * d.y);
    points_ += group.points, way_ += group.points * d;
    squares_ += group.points * (d * d + group.covariance[0]);
    crossed_ += group.points * (crossed + group.covariance[1]);
    thickness2_ += group.points * group.thickness2;
    scatter_ = std::max(scatter_, group.scatter);
  }
  Group group() const {
    const float inverse = 1 / points_;
    const vec3 mean = way_ * inverse;
    const vec3 crossed(mean.y * mean.z, mean.z * mean.x, mean.x * mean.y);
    return {origin_ + mean,
            points_,
            {squares_ * inverse - mean * mean, crossed_ * inverse - crossed},
            thickness2_ * inverse,
            scatter_};
  }

 private:
  vec3 origin_, way_{0}, squares_{0}, crossed_{0};
  float points_ = 0, thickness2_ = 0, scatter_ = 0;
};

template <class At>
std::vector<Group> grouped(std::size_t count, const At& at) {
  std::vector<Group> groups((count + group_size - 1) / group_size);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, groups.size(), 1024), [&](const auto& range) {
    for (std::size_t g = range.begin(); g < range.end(); ++g) {
      const std::size_t first = g * group_size;
      Sum sum(at(first).middle);
      for (std::size_t i = first; i < std::min(first + group_size, count); ++i) sum.add(at(i));
      groups[g] = sum.group();
    }
  });
  return groups;
}

/// The plane through a group and its neighbours.
struct WidePlane {
  vec3 middle{0}, normal{0};
  float thickness2 = 0;
  float error2 = std::numeric_limits<float>::infinity();
};

WidePlane plane_of(const Group& around) {
  const std::optional<LocalFrame> frame = local_frame(around.covariance[0], around.covariance[1]);
  WidePlane plane{around.middle};
  if (!frame) return plane;
  const float across = std::sqrt(frame->variance.y * frame->variance.z);
  if (!(across > 0)) return plane;
  plane.normal = frame->normal;
  plane.thickness2 = frame->variance.x;
  plane.error2 = error2_of_noise(plane.thickness2 / across, around.points) +
                 bend_factor * std::max(plane.thickness2 - by_chance * around.thickness2, 0.0f) / across;
  return plane;
}

/// The planes of all groups that need one, and which are nearest to each.
struct WidePlanes {
  static constexpr std::size_t nearest = 4;
  std::vector<WidePlane> planes;
  std::vector<std::array<std::uint32_t, nearest + 1>> near;  ///< itself first
};

WidePlanes planes_of(const std::vector<Group>& groups, int neighbors, Progress& progress) {
  WidePlanes wide{std::vector<WidePlane>(groups.size()), {}};
  wide.near.resize(groups.size());
  std::vector<vec3> middles(groups.size());
  std::transform(groups.begin(), groups.end(), middles.begin(), [](const Group& g) { return g.middle; });
  for_each_neighborhood(
      NeighborTree(middles), neighbors,
      [&](std::uint32_t i, std::span<const std::uint32_t> ids, std::span<const float> distances2) {
        wide.near[i].fill(i);
        Sum sum(middles[i]);
        sum.add(groups[i]);
        for (std::uint32_t j : ids) sum.add(groups[j]);
        const Group around = sum.group();
        wide.planes[i].thickness2 = groups[i].thickness2;
        if (around.scatter < calm_scatter) return;
        wide.planes[i] = plane_of(around);
        std::array<std::uint64_t, 64> keys;
        const std::size_t count = std::min(ids.size(), keys.size()),
                          few = std::min(count, WidePlanes::nearest);
        for (std::size_t k = 0; k < count; ++k) keys[k] = sort_key(distances2[k], ids[k]);
        std::partial_sort(keys.begin(), keys.begin() + std::ptrdiff_t(few),
                          keys.begin() + std::ptrdiff_t(count));
        std::transform(keys.begin(), keys.begin() + std::ptrdiff_t(few), wide.near[i].begin() + 1, id_of);
      },
      "normals", progress);
  return wide;
}

/// Estimates of a normal, each by its weight.
struct Estimate {
  vec3 normal{0};
  float thickness2 = 0, certainty = 0;
  void add(const vec3& n, float thickness, float weight) {
    normal += glm::dot(n, normal) < 0 ? -weight * n : weight * n;
    thickness2 += weight * thickness, certainty += weight;
  }
  void add(const Estimate& other) {
    normal += glm::dot(other.normal, normal) < 0 ? -other.normal : other.normal;
    thickness2 += other.thickness2, certainty += other.certainty;
  }
};

/// Of the planes near a point, the nearer the more, as far as it lies in them.
Estimate estimate_at(const vec3& position, const WidePlanes& wide, std::size_t group) {
  Estimate sum;
  float total = 0;
  const vec3 to_next = position - wide.planes[wide.near[group][1]].middle;
  const float soft = 0.1f * glm::dot(to_next, to_next) + std::numeric_limits<float>::min();
  for (std::uint32_t j : wide.near[group]) {
    const WidePlane& plane = wide.planes[j];
    const vec3 way = position - plane.middle;
    const float share = 1 / (glm::dot(way, way) + soft);
    total += share;
    if (!(plane.error2 < 1)) continue;
    const float height = glm::dot(way, plane.normal);
    if (height * height > most_deviations * most_deviations * plane.thickness2) continue;
    sum.add(plane.normal, plane.thickness2, share / plane.error2);
  }
  return {sum.normal / total, sum.thickness2 / total, sum.certainty / total};
}

}  // namespace

// The least variance of a few points is less than that of many, the more so the closer it is to the others.
float error2_of_noise(float scatter, float points) {
  const float apart = std::max(1 - 2 * scatter, 0.1f);
  return 2 * std::max(scatter, 1e-6f) / (points * apart * apart);
}

bool need_widening(std::span<const float> scatter) {
  const auto rough = std::count_if(scatter.begin(), scatter.end(), [](float s) { return s > calm_scatter; });
  return rough > 0 && !(float(rough) < few_rough * float(scatter.size()));
}

float widen_normals(const std::vector<vec3>& positions, int neighbors, const std::vector<float>& scatter,
                    const std::vector<float>& thickness2, std::vector<vec3>& normals, Progress& progress) {
  std::vector<WidePlanes> scales;
  std::vector<Group> groups = grouped(positions.size(), [&](std::size_t i) {
    return Group{positions[i], 1, {}, unbiased(thickness2[i], scatter[i], float(neighbors + 1)), scatter[i]};
  });
  while (scales.size() < 2 && groups.size() > std::size_t(neighbors)) {
    const WidePlanes& wide = scales.emplace_back(planes_of(groups, neighbors, progress));
    for (std::size_t g = 0; g < groups.size(); ++g) groups[g].thickness2 = wide.planes[g].thickness2;
    groups = grouped(groups.size(), [&](std::size_t g) { return groups[g]; });
  }
  const std::size_t every = std::max<std::size_t>(1, positions.size() / most_measured);
  std::vector<float> noise((positions.size() + every - 1) / every);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, positions.size(), 4096), [&](const auto& range) {
    progress.check();
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      if (scatter[i] < calm_scatter || normals[i] == vec3(0)) continue;
      const float own = 1 / error2_of_noise(scatter[i], float(neighbors + 1));
      Estimate sum;
      sum.add(normals[i], thickness2[i], own);
      std::size_t group = i;
      for (const WidePlanes& wide : scales) sum.add(estimate_at(positions[i], wide, group /= group_size));
      const float length = glm::length(sum.normal);
      if (!(length > 0)) continue;
      normals[i] = sum.normal / length;
      if (i % every == 0 && sum.certainty > 2 * own)
        noise[i / every] = std::sqrt(sum.thickness2 / sum.certainty);
    }
  });
  return float(quantile(noise, 0.5));
}

}  // namespace sfumato::analysis
