#include "analysis/survey.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "analysis/attributes.h"
#include "analysis/quantiles.h"
#include "analysis/vouched.h"
#include "core/order.h"
#include "core/symmetric3.h"

namespace sfumato::analysis {
namespace {

constexpr std::size_t places = 2048;  // shares are known to 1 %
constexpr int neighbors = 24;
/// So many-th of them are asked for their own plane.
constexpr std::size_t asked = 3;
/// Pictures close gaps up to a radius of 11 px of 720, or 2.75 usual spacings (techniques/screen_spacing.h);
/// those of a random sample of a surface have 1.7 spacings at most (vouched.h).
constexpr float closed_of_diagonal = 11.0f / 720, closed_spacings = 2.75f, widest_gap_spacings = 1.7f;
/// Cosine of 30 degrees: discs that are tilted by more against each other do not meet.
constexpr float parallel = 0.866f;

/// The nearest places: points in one place are one, or a scan whose points come twice would be flat
/// everywhere.
class Nearest {
 public:
  static constexpr bool merges_coincident = true;
  explicit Nearest(std::span<const vec3> positions) : positions_(positions) {
    distance2_.fill(std::numeric_limits<float>::infinity());
  }
  float limit() const { return distance2_[neighbors - 1]; }
  void add(std::uint32_t id, float distance2) {
    int at = 0;
    for (const float other : distance2_) at += other <= distance2;
    for (int i = at; i-- > 0 && distance2_[i] == distance2;)
      if (positions_[id_[i]] == positions_[id]) return;
    count_ = std::min(count_ + 1, neighbors);
    std::copy_backward(distance2_.begin() + at, distance2_.end() - 1, distance2_.end());
    std::copy_backward(id_.begin() + at, id_.end() - 1, id_.end());
    distance2_[at] = distance2, id_[at] = id;
  }
  std::span<const std::uint32_t> ids() const { return {id_.data(), std::size_t(count_)}; }
  float reach2() const { return count_ > 0 ? distance2_[count_ - 1] : 0; }
  /// (Levina and Bickel 2004, Eq. 8, inverted); the first is the point itself.
  float inverse_dimension() const {
    constexpr float nearest2 = 1e-4f;  // of its square: a point that comes twice, rounded, is no line
    float sum = 0;
    for (int k = 1; k < count_; ++k) sum -= 0.5f * std::log(std::max(distance2_[k] / reach2(), nearest2));
    return count_ > 2 ? sum / float(count_ - 2) : 0;
  }

 private:
  std::span<const vec3> positions_;
  int count_ = 0;
  std::array<float, neighbors> distance2_;  ///< infinite where there is none yet
  std::array<std::uint32_t, neighbors> id_;
};

struct Seen {
  float area = 0;     ///< a square of the spacing of its neighbours
  float surface = 0;  ///< share of it that is one, as far as they tell
  float inverse_dimension = 0.5f;
};

/// Among the neighbours is the point itself, at distance 0, which is as good as any other.
Seen seen_from(const NeighborTree& tree, std::uint32_t at) {
  const std::span<const vec3> positions = tree.positions();
  Nearest nearest(positions);
  tree.search(positions[at], nearest);
  const auto frame = local_frame(positions, at, nearest.ids());
  if (!frame || !(frame->variance.z > 0)) return {0, 0, nearest.inverse_dimension()};
  int agree = 0, all = 0;
  for (std::size_t k = 1; k < nearest.ids().size(); k += asked, ++all) {
    const std::uint32_t id = nearest.ids()[k];
    Nearest of_neighbor(positions);
    tree.search(positions[id], of_neighbor);
    const auto its = local_frame(positions, id, of_neighbor.ids());
    agree += its && std::abs(glm::dot(its->normal, frame->normal)) > parallel;
  }
  const VoronoiCell cell = cell_of(positions, at, nearest.ids(), *frame, frame->normal);
  return {nearest.reach2() * float(M_PI / neighbors),
          surrounded(cell) * float(agree) / float(std::max(all, 1)), nearest.inverse_dimension()};
}

double residual_around(std::span<const vec3> positions, const KNearest& nearest) {
  const double share = 1 / double(nearest.heap().size());
  dvec3 mean(0);
  for (const std::uint64_t key : nearest.heap()) mean += dvec3(positions[id_of(key)]) * share;
  Symmetric3 m;
  for (const std::uint64_t key : nearest.heap()) {
    const dvec3 d = dvec3(positions[id_of(key)]) - mean;
    m.xx += d.x * d.x, m.xy += d.x * d.y, m.xz += d.x * d.z;
    m.yy += d.y * d.y, m.yz += d.y * d.z, m.zz += d.z * d.z;
  }
  return std::sqrt(std::max(0.0, eigenvalues(m).z) * share);
}

}  // namespace

SurfaceShare surface_share(const NeighborTree& tree) {
  const std::size_t n = tree.positions().size(), count = std::min(n, places);
  if (n <= neighbors) return {};
  std::vector<Seen> seen(count);
  tbb::parallel_for(std::size_t(0), count,
                    [&](std::size_t k) { seen[k] = seen_from(tree, std::uint32_t(k * n / count)); });
  std::vector<float> areas;
  vec3 size;
  for (const Seen& each : seen) areas.push_back(each.area);
  const float usual = median(areas), most = largest_disc * largest_disc * usual;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<float> along;
    for (std::size_t k = 0; k < count; ++k) along.push_back(tree.positions()[k * n / count][axis]);
    size[axis] = value_at_share(along, 0.98) - value_at_share(along, 0.02);
  }
  const float widest = std::max(closed_of_diagonal * glm::length(size), closed_spacings * std::sqrt(usual));
  double surface = 0, all = 0, inverse = 0;
  for (const Seen& each : seen) {
    // Outliers stand for nothing.
    const double area = std::min(each.area, most),
                 shown = widest * widest / (widest_gap_spacings * widest_gap_spacings);
    surface += std::min(area, shown) * each.surface, all += area;
    inverse += each.inverse_dimension / double(count);
  }
  return {all > 0 ? float(surface / all) : 0, inverse > 0 ? float(1 / inverse) : 2};
}

SurfaceShare surface_share_of(const PreparedCloud& prepared, const NeighborTree* tree) {
  return prepared.surface_share.get([&]() -> SurfaceShare {
    const Attributes all = Attribute::normal | Attribute::radius;
    const Attributes of_file = attributes_of(prepared.cloud).without(prepared.computed);
    if (all.without(of_file).empty()) return {};
    SurfaceShare share = tree ? surface_share(*tree) : surface_share(NeighborTree(prepared.cloud.positions));
    if (prepared.pictures) share.surface = prepared.pictures->surface_share;
    return share;
  });
}

float plane_residual(std::span<const vec3> positions) {
  constexpr std::size_t samples = 500;
  if (positions.size() < 4) return 0;
  const NeighborTree tree(positions);
  std::vector<float> residuals;
  const std::size_t step = std::max<std::size_t>(1, positions.size() / samples);
  for (std::size_t i = 0; i < positions.size(); i += step) {
    KNearest nearest(around_residual);
    tree.search(positions[i], nearest);
    residuals.push_back(float(residual_around(positions, nearest)));
  }
  return quantile(residuals, 0.5);
}

}  // namespace sfumato::analysis
