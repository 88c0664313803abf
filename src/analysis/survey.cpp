#include "analysis/survey.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "analysis/attributes.h"
#include "analysis/quantiles.h"
#include "analysis/support.h"
#include "core/order.h"
#include "core/symmetric3.h"

namespace sfumato::analysis {
namespace {

constexpr std::size_t places = 2048;  // shares are known to 1 %
constexpr int neighbors = 24;
/// Whether a point lies on a line its six nearest say: of more, other lines have their share, as rings of a
/// scanner with 64 of them and rims of a mesh. Across over along, in variances: below that for 1 % of the
/// points of a random surface.
constexpr std::size_t along_line = 6;
constexpr float line = 0.02f;
/// How far the next line is looked for, in distances of the farthest of the 24: beyond, a line stands alone.
constexpr float far_off = 16;

/// Seen from far enough a forest is flat, and so is noise. Noise of 2 spacings still shows its surface (ADR
/// 50); of a layer thicker than this, in standard deviations over the spacing, discs as wide as the spacing
/// show nothing.
constexpr float thickest = 2.5f;

/// The nearest places: points in one place are one, or a scan whose points come twice would be flat
/// everywhere.
class Nearest {
 public:
  static constexpr bool merges_coincident = true;
  explicit Nearest(std::span<const vec3> positions) : positions_(positions) {}
  float limit() const {
    return count_ < neighbors ? std::numeric_limits<float>::infinity() : distance2_[neighbors - 1];
  }
  void add(std::uint32_t id, float distance2) {
    for (int i = count_; i-- > 0 && distance2_[i] >= distance2;)
      if (distance2_[i] == distance2 && positions_[id_[i]] == positions_[id]) return;
    if (count_ < neighbors) ++count_;
    int at = count_ - 1;
    for (; at > 0 && distance2_[at - 1] > distance2; --at)
      distance2_[at] = distance2_[at - 1], id_[at] = id_[at - 1];
    distance2_[at] = distance2, id_[at] = id;
  }
  std::span<const std::uint32_t> ids() const { return {id_, std::size_t(count_)}; }
  float reach() const { return count_ > 0 ? std::sqrt(distance2_[count_ - 1]) : 0; }

 private:
  std::span<const vec3> positions_;
  int count_ = 0;
  float distance2_[neighbors];
  std::uint32_t id_[neighbors];
};

/// Distance to the nearest point that lies rather across a line through `at` than along it.
class NextLine {
 public:
  static constexpr bool merges_coincident = true;
  NextLine(std::span<const vec3> positions, const vec3& at, const vec3& along, float deviation, float limit)
      : positions_(positions),
        at_(at),
        along_(along),
        least2_(9 * deviation * deviation),
        limit_(limit * limit) {}
  float limit() const { return limit_; }
  void add(std::uint32_t id, float distance2) {
    const vec3 way = positions_[id] - at_;
    const float along = glm::dot(way, along_), across2 = distance2 - along * along;
    if (across2 > along * along && across2 > least2_) limit_ = std::min(limit_, distance2);
  }

 private:
  std::span<const vec3> positions_;
  vec3 at_, along_;
  float least2_, limit_;
};

struct Seen {
  float flat = 1;
  bool line = false;
  float gap = 0;        ///< of a point on a line, to the next one
  bool closes = false;  ///< whether that is among its neighbours
  float thickness = 0;  ///< standard deviation from the plane
  float spacing = 0;    ///< of a surface with as many points within reach
};

/// Among them is the point itself, at distance 0, which is as good as any other.
Seen seen_from(const NeighborTree& tree, std::span<const vec3> positions, std::uint32_t at) {
  Nearest nearest(positions);
  tree.search(positions[at], nearest);
  const auto frame = local_frame(positions, at, nearest.ids());
  if (!frame || !(frame->variance.z > 0)) return {};
  const auto near =
      local_frame(positions, at, nearest.ids().first(std::min(along_line + 1, nearest.ids().size())));
  Seen seen{.flat = flatness_of(positions, at, nearest.ids(), *frame, nearest.reach()),
            .line = near && near->variance.y < line * near->variance.z,
            .thickness = std::sqrt(frame->variance.x),
            .spacing = nearest.reach() * float(std::sqrt(M_PI / neighbors))};
  if (seen.line) {
    const vec3 way = positions[nearest.ids()[std::min(along_line, nearest.ids().size() - 1)]] - positions[at];
    NextLine next(positions, positions[at], glm::normalize(way), std::sqrt(near->variance.y),
                  far_off * nearest.reach());
    tree.search(positions[at], next);
    seen.gap = std::sqrt(next.limit()), seen.closes = seen.gap <= nearest.reach();
  }
  return seen;
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

Survey survey(const NeighborTree& tree) {
  const std::span<const vec3> positions = tree.positions();
  const std::size_t n = positions.size(), count = std::min(n, places);
  if (n <= neighbors) return {};
  std::vector<vec3> wide;
  for (std::size_t i = 32; i < n; i += 64) wide.push_back(positions[i]);
  const NeighborTree wide_tree(wide);
  std::vector<Seen> seen(count);
  tbb::parallel_for(std::size_t(0), count, [&](std::size_t k) {
    const std::size_t at = k * n / count;
    seen[k] = seen_from(tree, positions, std::uint32_t(at));
    if (seen[k].flat == 1 || !tells_clutter(wide.size(), neighbors)) return;
    // One point in 64 stands 8 times as far apart.
    const Seen far = seen_from(wide_tree, wide, std::uint32_t(std::min(at / 64, wide.size() - 1)));
    if (far.thickness < thickest * far.spacing / 8) seen[k].flat = std::max(seen[k].flat, far.flat);
  });
  double flat = 0, closed = 0;
  std::vector<float> gaps;
  for (const Seen& s : seen) {
    flat += s.flat;
    if (s.line) closed += s.closes, gaps.push_back(s.gap);
  }
  Survey survey{float(flat / double(count)), float(double(gaps.size()) / double(count))};
  if (gaps.empty()) return survey;
  survey.closed_lines = float(closed / double(gaps.size()));
  survey.gap_spread = value_at_share(gaps, 0.9) / value_at_share(gaps, 0.1);
  return survey;
}

const Survey& survey_of(const PreparedCloud& prepared, const NeighborTree* tree) {
  if (prepared.survey) return *prepared.survey;
  const Attributes all = Attribute::normal | Attribute::radius;
  const Attributes of_file = attributes_of(prepared.cloud).without(prepared.computed);
  if (all.without(of_file).empty()) return prepared.survey.emplace();
  std::optional<NeighborTree> own;
  if (!tree) tree = &own.emplace(prepared.cloud.positions);
  return prepared.survey.emplace(survey(*tree));
}

float plane_residual(std::span<const vec3> positions) {
  constexpr std::size_t samples = 500, around = 64;
  if (positions.size() < 4) return 0;
  const NeighborTree tree(positions);
  std::vector<float> residuals;
  const std::size_t step = std::max<std::size_t>(1, positions.size() / samples);
  for (std::size_t i = 0; i < positions.size(); i += step) {
    KNearest nearest(around);
    tree.search(positions[i], nearest);
    residuals.push_back(float(residual_around(positions, nearest)));
  }
  return quantile(residuals, 0.5);
}

}  // namespace sfumato::analysis
