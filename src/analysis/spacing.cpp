#include "analysis/spacing.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "analysis/morton.h"
#include "core/order.h"

namespace sfumato::analysis {
namespace {

constexpr std::size_t wanted_queries = 8'192, most_queries = 20'000, least_per_batch = 16;
constexpr std::size_t near_on_curve = 12;

/// The eight places nearest to a point other than its own.
class NearestPlaces {
 public:
  static constexpr bool merges_coincident = true;
  NearestPlaces(std::span<const vec3> positions, const vec3& own) : positions_(positions), own_(own) {}

  float limit() const { return count_ < 8 ? std::numeric_limits<float>::infinity() : distance2_[7]; }

  void offer(std::size_t id) {
    const vec3 d = positions_[id] - own_;
    const float distance2 = d.x * d.x + d.y * d.y + d.z * d.z;
    if (distance2 < limit()) add(std::uint32_t(id), distance2);
  }

  void add(std::uint32_t id, float distance2) {
    const vec3& p = positions_[id];
    if (p == own_) return;
    int at = 0;
    for (; at < count_ && distance2_[at] <= distance2; ++at)
      if (distance2_[at] == distance2 && place_[at] == p) return;
    if (count_ < 8) ++count_;
    for (int i = count_ - 1; i > at; --i) distance2_[i] = distance2_[i - 1], place_[i] = place_[i - 1];
    distance2_[at] = distance2, place_[at] = p;
  }

  /// The disc through the m-th place holds m points' worth of area: pi R_m^2 = m s^2.
  float spacing() const {
    if (count_ == 0) return 0;
    return float(std::sqrt(double(distance2_[count_ - 1]) * std::numbers::pi / count_));
  }

 private:
  std::span<const vec3> positions_;
  vec3 own_;
  int count_ = 0;
  float distance2_[8];
  vec3 place_[8];
};

float spacing_at(const NeighborTree& tree, std::size_t i) {
  const std::span<const vec3> positions = tree.positions();
  NearestPlaces nearest(positions, positions[i]);
  // Those before and after it on the curve are mostly near: the search then skips what is farther at once.
  const std::size_t last = std::min(positions.size(), i + near_on_curve);
  for (std::size_t j = i - std::min(i, near_on_curve); j < last; ++j) nearest.offer(j);
  tree.search(positions[i], nearest);
  return nearest.spacing();
}

/// Partly sorts `spacings`; 0 when no query found another place.
float median_of_positive(std::vector<float>& spacings) {
  std::erase_if(spacings, [](float s) { return !(s > 0) || !std::isfinite(s); });
  if (spacings.empty()) return 0;
  return median(spacings);
}

/// A plane through the logarithms of spacings over the places they were measured at, weighted so that a lone
/// point far from all others does not tilt it (Huber). Places are scaled by the longest side of the batch's
/// box and slopes are held back by half a sample, which only matters along sides that are short.
void fit_spacing(Batch& batch, std::span<const vec3> places, std::span<const float> spacings) {
  const vec3 center = 0.5f * (batch.box_min + batch.box_max), half = 0.5f * (batch.box_max - batch.box_min);
  const float reach = std::max({half.x, half.y, half.z});
  if (!(reach > 0) || !std::isfinite(reach)) return;

  // One standard deviation of log2 R_8 among random points of a plane: pi R_8^2 is gamma distributed with
  // shape 8, so that of ln R_8^2 is sqrt(psi'(8)) = 0.365.
  constexpr double deviation = 0.365 / 2 / std::numbers::ln2, held_back = 0.5;
  glm::dvec4 plane(0, 0, 0, std::log2(double(batch.spacing)));  // over (place - center) / reach, and 1
  for (int round = 0; round < 4; ++round) {
    glm::dmat4 normal(0);
    glm::dvec4 right(0);
    double samples = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (!(spacings[i] > 0) || !std::isfinite(spacings[i])) continue;
      const glm::dvec4 x(glm::dvec3((places[i] - center) / reach), 1);
      const double value = std::log2(double(spacings[i])), away = std::abs(value - glm::dot(plane, x));
      const double weight = std::min(1.0, deviation / std::max(away, 1e-9));
      normal += weight * glm::outerProduct(x, x);
      right += weight * value * x;
      ++samples;
    }
    if (samples < 8) return;  // four numbers want twice as many samples
    for (int k = 0; k < 3; ++k) normal[k][k] += held_back;
    plane = glm::inverse(normal) * right;
  }
  const vec3 slope = vec3(plane) / reach;
  if (!std::isfinite(glm::dot(slope, slope)) || !std::isfinite(float(plane.w))) return;
  batch.log2_spacing = vec4(slope, float(plane.w - double(glm::dot(slope, center))));
  // Nowhere beyond what the plane has at the samples: corners of the box may be far from any point.
  float least = INFINITY, most = -INFINITY;
  for (const vec3& place : places) {
    const float value = glm::dot(slope, place) + batch.log2_spacing.w;
    least = std::min(least, value), most = std::max(most, value);
  }
  batch.least_log2_spacing = least, batch.most_log2_spacing = most;
}

std::size_t stretch_of(const PlacedSpacing& spacing, std::uint64_t key) {
  const auto after = std::upper_bound(spacing.begins.begin() + 1, spacing.begins.end(), key);
  return std::size_t(after - spacing.begins.begin()) - 1;
}

}  // namespace

float measure_spacing(std::span<Batch> batches, const NeighborTree& tree, Progress& progress) {
  const std::size_t points = tree.positions().size();
  const std::size_t wanted = std::min(points, wanted_queries);
  const std::size_t each =
      batches.empty() ? 0 : std::max(least_per_batch, (wanted + batches.size() - 1) / batches.size());
  std::vector<std::vector<float>> found(batches.size());
  tbb::parallel_for(std::size_t(0), batches.size(), [&](std::size_t b) {
    progress.check();
    Batch& batch = batches[b];
    const std::size_t queries = std::min(each, std::size_t(batch.count));
    found[b].resize(queries);
    std::vector<vec3> places(queries);
    for (std::size_t q = 0; q < queries; ++q) {
      const std::size_t run = q * batch.count / queries, end = (q + 1) * batch.count / queries;
      const std::uint32_t hash = std::uint32_t(b * each + q) * 2654435769u >> 8;
      const std::size_t at = batch.first + run + hash % (end - run);
      places[q] = tree.positions()[at];
      found[b][q] = spacing_at(tree, at);
    }
    std::vector<float> own = found[b];
    batch.spacing = median_of_positive(own);
    if (!(batch.spacing > 0)) return;
    batch.set_even_spacing(batch.spacing);
    fit_spacing(batch, places, found[b]);
  });

  // Of very many batches only every so many-th query counts.
  std::vector<float> sample;
  const std::size_t step = (batches.size() * each + most_queries - 1) / most_queries;
  for (std::size_t b = 0, next = 0; b < found.size(); next -= found[b++].size())
    for (; next < found[b].size(); next += step) sample.push_back(found[b][next]);
  const float median = median_of_positive(sample);
  const float spacing = median > 0 ? median : 1;
  for (Batch& batch : batches)
    if (!(batch.spacing > 0)) batch.set_even_spacing(spacing);
  return spacing;
}

PlacedSpacing spacing_along_curve(const Neighborhoods& around, const WholeCloud& whole,
                                  std::size_t stretches) {
  constexpr std::size_t eighth = 8;
  PlacedSpacing out;
  // However far a stray point lies, the curve tells apart what is near the usual ones.
  const double reach = 100 * whole.usual_box.diagonal();
  const bool has_size = reach > 0;
  out.box_min =
      vec3((has_size ? glm::max(whole.box.min, whole.usual_box.min - reach) : whole.box.min) - whole.origin);
  out.box_max =
      vec3((has_size ? glm::min(whole.box.max, whole.usual_box.max + reach) : whole.box.max) - whole.origin);
  std::vector<vec3> places, sample;
  for (const dvec3& place : around.places) places.emplace_back(place - whole.origin);
  for (std::size_t i = 0; i < whole.sample.size(); ++i)
    sample.emplace_back(whole.sample.world(i) - whole.origin);
  const std::vector<std::uint64_t> keys = curve_keys(places, out.box_min, out.box_max);
  std::vector<std::uint64_t> ends = curve_keys(sample, out.box_min, out.box_max);
  std::sort(ends.begin(), ends.end());
  stretches =
      std::clamp<std::size_t>(stretches, 1, std::max<std::size_t>(1, places.size() / least_per_batch));
  for (std::size_t k = 0; k < stretches; ++k)
    out.begins.push_back(k == 0 || ends.empty() ? 0 : ends[k * ends.size() / stretches]);
  std::vector<std::vector<vec3>> own(stretches);
  std::vector<std::vector<float>> found(stretches);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::size_t last = std::min(eighth, around.nearest[i].size() - 1);
    if (last == 0) continue;
    const std::size_t k = stretch_of(out, keys[i]);
    own[k].push_back(places[i]);
    found[k].push_back(float(glm::distance(around.nearest[i][last], around.places[i]) *
                             std::sqrt(std::numbers::pi / double(last))));
  }
  out.stretches.resize(stretches);
  for (std::size_t k = 0; k < stretches; ++k) {
    Batch& stretch = out.stretches[k];
    stretch.set_even_spacing(whole.median_spacing);
    std::vector<float> spacings = found[k];
    const float median = median_of_positive(spacings);
    if (!(median > 0)) continue;
    stretch.set_even_spacing(median);
    stretch.box_min = stretch.box_max = own[k].front();
    for (const vec3& place : own[k])
      stretch.box_min = glm::min(stretch.box_min, place), stretch.box_max = glm::max(stretch.box_max, place);
    fit_spacing(stretch, own[k], found[k]);
  }
  return out;
}

std::vector<float> spacings_at(std::span<const vec3> positions, const PlacedSpacing& spacing,
                               Progress& progress) {
  std::vector<float> spacings(positions.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, positions.size(), 4096), [&](const auto& range) {
    progress.check();
    const auto keys =
        curve_keys(positions.subspan(range.begin(), range.size()), spacing.box_min, spacing.box_max);
    for (std::size_t i = range.begin(); i < range.end(); ++i)
      spacings[i] = spacing.stretches[stretch_of(spacing, keys[i - range.begin()])].spacing_at(positions[i]);
  });
  return spacings;
}

}  // namespace sfumato::analysis
