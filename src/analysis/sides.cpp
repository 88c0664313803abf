#include "analysis/sides.h"

#include <Eigen/Eigenvalues>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "analysis/normals.h"

namespace sfumato::analysis {
namespace {

constexpr std::size_t every = 64;
/// Of random samples of two planes these reach 3.9 spacings, and so see sheets as thick as that.
constexpr std::size_t points_looked_at = 96;

/// Distance of the layers over the deviation within them. A slab that is filled evenly, cut in half, has
/// sqrt(12) = 3.5, a normal distribution 2.6; of 97 points by chance up to 4.3; what bends one way, without
/// noise, cut between its crest and its flanks, up to 5.3 (600 places each).
constexpr float apart = 5.5f;
/// Nor are crest and flanks spread alike: of the variances of both along any direction in the layers, one is
/// 4.2 times the other and more; those of two layers by chance up to 2.5, of a gap of three spacings, where
/// less of the other is seen, 3.7.
constexpr double most_unalike = 4;
/// Cosine between the layers, 15 degrees: the flanks of a groove hide nothing of each other.
constexpr double parallel_layers = 0.966;
/// Where normals or scanners tell the layers, their means need only differ by more than chance: five
/// standard errors.
constexpr float apart_errors = 5;
/// Of the points, the fewer of both layers.
constexpr float least_share = 0.125f;
/// The layers lie above one another: the way between their middles along them, in deviations of the points
/// there (1.5 at a step or a ridge, .6 by chance); and are flat: deviation across over that along their
/// narrow way (.2 and more in a wedge, whose flanks may be those of a groove; 1 in two lines of a scanner).
constexpr float aside = 0.6f, flat_layer = 0.15f;
/// Of that narrow way. Layers nearer than .05 of it (.14 spacings) may be steps of a file's numbers where
/// nothing else tells them apart, and a deviation below .001 is what is lost in the sums of floats.
constexpr double nearest_layers = 0.05, least_deviation = 1e-3;
/// How many times as dense one layer may be as the other: a few strays above a surface do not hide it.
constexpr double as_dense = 3;
/// The share of points with a known side that lie on it.
constexpr float agreed = 0.9f;

/// Layers half a spacing apart are .09 of what 96 points are wide, two spacings .36: all are flatter where
/// there are none, or layers so near that it makes no difference; and only thicker ones may lie across
/// another axis.
constexpr double thinnest = 0.06, thick = 0.25;

struct Covariance {
  glm::dvec3 squares{0}, crossed{0};
  void add(const glm::dvec3& d) {
    squares += d * d;
    crossed += glm::dvec3(d.y * d.z, d.z * d.x, d.x * d.y);
  }
};

/// The points about their mean, in two groups.
class Groups {
 public:
  Groups(std::span<const vec3> positions, std::span<const std::uint32_t> points) {
    dvec3 sum(0);
    for (const std::uint32_t j : points) sum += dvec3(positions[j] - positions[points[0]]);
    mean_ = sum / double(points.size());
    for (const std::uint32_t j : points)
      offsets_.push_back(dvec3(positions[j] - positions[points[0]]) - mean_);
    upper_.resize(points.size());
  }

  /// Principal axes, the thinnest first; `thin`: the deviation along it over that across. The layers of a
  /// sheet may lie farther apart than its part is wide.
  std::array<dvec3, 3> axes(double& thin) const {
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    for (const dvec3& d : offsets_) {
      const Eigen::Vector3d v(d.x, d.y, d.z);
      squares += v * v.transpose();
    }
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(squares);
    const Eigen::Vector3d variance = solver.eigenvalues().cwiseMax(0.0);
    thin = std::sqrt(variance.x() / std::max(variance.y() + variance.z(), 1e-300));
    std::array<dvec3, 3> axes;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d v = solver.eigenvectors().col(k);
      axes[std::size_t(k)] = {v.x(), v.y(), v.z()};
    }
    return axes;
  }

  /// Two peaks of shares p and q lie at m + s (g +- sqrt(g^2 + 4)) / 2, for a mean m, deviation s and
  /// skewness g: half way between them is m + s g / 2. Returns whether that changed anything.
  bool split_along(const dvec3& axis) {
    heights_.resize(offsets_.size());
    double squares = 0, cubes = 0;
    for (std::size_t k = 0; k < offsets_.size(); ++k) {
      const double h = heights_[k] = glm::dot(offsets_[k], axis);
      squares += h * h, cubes += h * h * h;
    }
    const double middle = squares > 0 ? cubes / (2 * squares) : 0;
    bool changed = false;
    for (std::size_t k = 0; k < offsets_.size(); ++k) {
      const bool is_upper = heights_[k] > middle;
      changed = changed || is_upper != bool(upper_[k]);
      upper_[k] = is_upper;
    }
    return changed;
  }
  /// Split along an axis: the gap in deviations along it, as good as that of `shape` where nothing is bent.
  double first_gap(const dvec3& axis) {
    split_along(axis);
    double count[2] = {}, sum[2] = {}, squares = 0;
    for (std::size_t k = 0; k < heights_.size(); ++k)
      ++count[upper_[k]], sum[upper_[k]] += heights_[k], squares += heights_[k] * heights_[k];
    if (count[0] == 0 || count[1] == 0) return 0;
    const double means[2] = {sum[0] / count[0], sum[1] / count[1]};
    const double within = squares - sum[0] * means[0] - sum[1] * means[1];
    return (means[1] - means[0]) * std::sqrt(double(heights_.size()) / std::max(within, 1e-300));
  }
  void set_upper(std::size_t k, bool is_upper) { upper_[k] = is_upper; }

  /// How the groups lie to each other: along the direction in which both are thinnest.
  struct Shape {
    dvec3 axis{0}, middle{0};
    double gap = 0, deviation = 0, along = 0, narrow = 0, aside = 0, share = 0;
    dvec3 middles[2] = {dvec3(0), dvec3(0)};  ///< of the groups, from the mean of all
  };
  std::optional<Shape> shape() const {
    dvec3 sum[2] = {dvec3(0), dvec3(0)};
    double count[2] = {};
    for (std::size_t k = 0; k < offsets_.size(); ++k) sum[upper_[k]] += offsets_[k], ++count[upper_[k]];
    if (count[0] == 0 || count[1] == 0) return std::nullopt;
    sum[0] /= count[0], sum[1] /= count[1];
    Covariance within;
    for (std::size_t k = 0; k < offsets_.size(); ++k) within.add(offsets_[k] - sum[upper_[k]]);
    const auto frame = local_frame(vec3(within.squares), vec3(within.crossed));
    if (!frame) return std::nullopt;
    const double each = 1 / double(offsets_.size());
    Shape s;
    s.axis = dvec3(frame->normal);
    const dvec3 way = sum[1] - sum[0];
    if (glm::dot(way, s.axis) < 0) s.axis = -s.axis;
    s.gap = glm::dot(way, s.axis);
    s.aside = glm::length(way - s.gap * s.axis);
    s.deviation = std::sqrt(double(frame->variance.x) * each);
    s.along = std::sqrt(double(frame->variance.y + frame->variance.z) * each);
    s.narrow = std::sqrt(2 * double(frame->variance.y) * each);
    s.share = std::min(count[0], count[1]) * each;
    s.middle = mean_ + 0.5 * (sum[0] + sum[1]);
    s.middles[0] = sum[0], s.middles[1] = sum[1];
    return s;
  }

  /// Whether both are spread alike, and parallel.
  bool is_alike(const Shape& s) const {
    const Tangents in_layer = tangents_of(vec3(s.axis));
    Eigen::Matrix2d spread[2] = {Eigen::Matrix2d::Zero(), Eigen::Matrix2d::Zero()};
    Covariance of[2];
    double count[2] = {};
    for (std::size_t k = 0; k < offsets_.size(); ++k) {
      const std::size_t group = upper_[k];
      const dvec3 d = offsets_[k] - s.middles[group];
      const Eigen::Vector2d at(glm::dot(d, dvec3(in_layer.along)), glm::dot(d, dvec3(in_layer.across)));
      spread[group] += at * at.transpose();
      of[group].add(d), ++count[group];
    }
    const auto one = local_frame(vec3(of[0].squares), vec3(of[0].crossed)),
               other = local_frame(vec3(of[1].squares), vec3(of[1].crossed));
    if (!one || !other || !(std::abs(glm::dot(one->normal, other->normal)) > parallel_layers)) return false;
    spread[0] /= count[0], spread[1] /= count[1];
    if (!(spread[0].determinant() > 0)) return false;
    // The ratios of both along any direction lie between the generalised eigenvalues.
    const Eigen::Matrix2d ratio = spread[0].inverse() * spread[1];
    const double half = 0.5 * ratio.trace(),
                 root = std::sqrt(std::max(half * half - ratio.determinant(), 0.0));
    return half + root < most_unalike && half - root > 1 / most_unalike;
  }

 private:
  dvec3 mean_;
  std::vector<dvec3> offsets_;
  std::vector<double> heights_;
  std::vector<std::uint8_t> upper_;
};

bool is_sheet(const Groups::Shape& s) {
  return s.share >= least_share && s.aside < aside * s.along && s.deviation < flat_layer * s.narrow;
}

/// `sort_key`s of the points around one, the nearest `points_looked_at` and itself first. Those before and
/// after it on the curve tell how far to look.
void nearest_of(const NeighborTree& tree, std::size_t point, std::vector<std::uint64_t>& keys) {
  const std::span<const vec3> positions = tree.positions();
  const vec3 p = positions[point];
  const auto key_of = [&](std::size_t j) {
    const vec3 d = positions[j] - p;
    return sort_key(glm::dot(d, d), std::uint32_t(j));
  };
  keys.clear();
  const std::size_t from = point > points_looked_at ? point - points_looked_at : 0,
                    to = std::min(positions.size(), from + 2 * points_looked_at + 1);
  for (std::size_t j = from; j < to; ++j) keys.push_back(key_of(j));
  const auto last = std::ptrdiff_t(points_looked_at);
  std::nth_element(keys.begin(), keys.begin() + last, keys.end());
  const float limit = distance2_of(keys[points_looked_at]);
  keys.clear();
  tree.leaves_near(p, p, 1.00001f * std::sqrt(limit), [&](std::uint32_t first, std::uint32_t end) {
    for (std::uint32_t j = first; j < end; ++j)
      if (const std::uint64_t key = key_of(j); distance2_of(key) <= limit) keys.push_back(key);
    return true;
  });
  std::nth_element(keys.begin(), keys.begin() + last, keys.end());
}

}  // namespace

Sheet sheet_of(std::span<const vec3> positions, std::uint32_t center, std::span<const std::uint32_t> points,
               const KnownSide& known) {
  Groups groups(positions, points);
  std::optional<Groups::Shape> best;
  double most = apart;
  double thin = 0;
  bool is_doubtful = false;
  const auto axes = groups.axes(thin);
  for (const dvec3& axis : axes) {
    for (std::size_t k = 0; k < points.size(); ++k) groups.set_upper(k, known(points[k], vec3(axis)) > 0);
    auto shape = groups.shape();
    if (!shape || !is_sheet(*shape)) continue;
    const double errors = glm::dot(shape->axis, axis) * shape->gap *
                          std::sqrt(shape->share * (1 - shape->share) * double(points.size())) /
                          std::max(shape->deviation, least_deviation * shape->narrow);
    if (errors < -apart_errors) continue;  // those of a gap between two things
    if (glm::dot(shape->axis, axis) < 0) shape->axis = -shape->axis;
    best = shape, is_doubtful = errors < apart_errors;
    break;
  }
  const bool is_told = best.has_value();
  if (!is_told && thin < thinnest && !(groups.first_gap(axes[0]) > apart)) return {};
  for (const dvec3& axis : axes) {
    if (is_told || (&axis != &axes[0] && thin < thick)) break;
    std::optional<Groups::Shape> shape;
    groups.split_along(axis);
    for (int round = 0; round < 4; ++round) {
      shape = groups.shape();
      if (!shape || !groups.split_along(shape->axis)) break;
    }
    if (!shape || !is_sheet(*shape) || !(shape->gap > most * shape->deviation) ||
        !(shape->gap > nearest_layers * shape->narrow) || !groups.is_alike(*shape))
      continue;
    most = shape->gap / std::max(shape->deviation, 1e-30), best = shape;
  }
  if (!best) return {};
  float reach2 = 0;
  for (const std::uint32_t j : points) {
    const vec3 d = positions[j] - positions[center];
    reach2 = std::max(reach2, glm::dot(d, d));
  }
  const Sheet sheet{positions[points[0]] + vec3(best->middle), vec3(best->axis), float(best->gap),
                    std::sqrt(reach2), is_doubtful};
  int told = 0, right = 0, own = 0;
  const auto height = [&](std::uint32_t j) { return glm::dot(positions[j] - sheet.place, sheet.normal); };
  for (const std::uint32_t j : points) {
    const int side = known(j, sheet.normal);
    told += side != 0;
    right += float(side) * height(j) > 0;
    own += (height(j) > 0) == (height(center) > 0);
  }
  // A ball around a point of one layer cuts a smaller disc out of the other.
  const double seen = 1 - best->gap * best->gap / double(reach2),
               denser = (double(points.size()) - own) / std::max(seen * own, 1e-9);
  if (!(denser < as_dense && denser > 1 / as_dense)) return {};
  return is_told || float(right) >= agreed * float(told) ? sheet : Sheet{};
}

Sides::Sides(const NeighborTree& tree, const KnownSide& known, Progress& progress)
    : positions_(tree.positions()), known_(known) {
  if (positions_.size() <= points_looked_at) return;
  sheets_.resize((positions_.size() + every - 1) / every);
  std::vector<std::vector<std::uint32_t>> touched(sheets_.size());  // where a sheet's points lie
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, sheets_.size(), 256), [&](const auto& range) {
    progress.check();
    std::vector<std::uint64_t> keys;
    std::vector<std::uint32_t> ids;
    for (std::size_t b = range.begin(); b < range.end(); ++b) {
      const std::size_t first = b * every, middle = (first + std::min(first + every, positions_.size())) / 2;
      nearest_of(tree, middle, keys);
      ids.clear();
      for (std::size_t k = 0; k <= points_looked_at; ++k) ids.push_back(id_of(keys[k]));
      sheets_[b] = sheet_of(positions_, std::uint32_t(middle), ids, known_);
      if (!(sheets_[b].reach > 0)) continue;
      for (std::uint32_t& id : ids) id /= std::uint32_t(every);
      std::sort(ids.begin(), ids.end());
      ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
      touched[b] = ids;
    }
  });
  // Where most of the file's normals that tell face outward, so do the others.
  std::size_t told = 0, doubtful = 0;
  for (const Sheet& sheet : sheets_)
    if (sheet.reach > 0) ++(sheet.is_doubtful ? doubtful : told);
  if (told <= doubtful)
    for (Sheet& sheet : sheets_)
      if (sheet.is_doubtful) sheet = {};
  if (told == 0) {
    sheets_.clear();
    return;
  }
  // Where the curve jumps, what tells lies beside it: the nearest that was seen from there.
  std::vector<Sheet> beside(sheets_.size());
  for (std::size_t b = 0; b < sheets_.size(); ++b) {
    if (!(sheets_[b].reach > 0)) continue;
    for (const std::uint32_t other : touched[b]) {
      const vec3 middle = positions_[std::min(other * every + every / 2, positions_.size() - 1)];
      const auto distance = [&](const Sheet& s) { return glm::distance(s.place, middle); };
      if (!(beside[other].reach > 0) || distance(sheets_[b]) < distance(beside[other]))
        beside[other] = sheets_[b];
    }
  }
  for (std::size_t b = 0; b < sheets_.size(); ++b)
    if (!(sheets_[b].reach > 0)) sheets_[b] = beside[b];
}

bool Sides::is_near(std::uint32_t point) const {
  const std::size_t own = point / every, last = std::min(own + 2, sheets_.size());
  for (std::size_t b = own > 0 ? own - 1 : 0; b < last; ++b)
    if (sheets_[b].reach > 0) return true;
  return false;
}

const Sheet* Sides::sheet_near(std::uint32_t point) const {
  const std::size_t own = point / every, last = std::min(own + 2, sheets_.size());
  const Sheet* nearest = nullptr;
  float least = std::numeric_limits<float>::infinity();
  for (std::size_t b = own > 0 ? own - 1 : 0; b < last; ++b) {
    if (!(sheets_[b].reach > 0)) continue;
    const vec3 d = positions_[point] - sheets_[b].place;
    const float distance2 = glm::dot(d, d);
    if (distance2 < least && distance2 < 4 * sheets_[b].reach * sheets_[b].reach)
      least = distance2, nearest = &sheets_[b];
  }
  return nearest;
}

bool Sides::find(std::uint32_t point, std::span<const std::uint32_t> ids, std::span<const float> distances2,
                 std::size_t count, Own& own) const {
  const Sheet* sheet = sheet_near(point);
  std::vector<std::uint64_t>& keys = own.keys;
  const auto take = [&] {  // the nearest `count`, the farthest of them last
    std::nth_element(keys.begin(), keys.begin() + std::ptrdiff_t(count - 1), keys.end());
    own.ids.resize(count), own.distances2.resize(count);
    for (std::size_t k = 0; k < count; ++k)
      own.ids[k] = id_of(keys[k]), own.distances2[k] = distance2_of(keys[k]);
  };
  const auto take_all = [&] {
    keys.clear();
    for (std::size_t k = 0; k < ids.size(); ++k) keys.push_back(sort_key(distances2[k], ids[k]));
  };
  keys.clear();
  if (sheet) {
    const int side = known_(point, sheet->normal);
    int above = 0, below = 0;
    for (std::size_t k = 0; k < ids.size(); ++k) {
      const float height = glm::dot(positions_[ids[k]] - positions_[point], sheet->normal);
      const int other = side != 0 ? known_(ids[k], sheet->normal) : 0;
      if (other != 0 ? side == other : std::abs(height) < 0.5f * sheet->gap)
        keys.push_back(sort_key(distances2[k], ids[k]));
      else
        ++(height > 0 ? above : below);
    }
    const bool is_on_side = float(std::min<std::size_t>(keys.size(), std::size_t(above + below))) >=
                            least_share * float(ids.size());
    if (is_on_side) {
      float outward = side != 0 ? float(side) : float(below - above);
      if (outward == 0) outward = glm::dot(positions_[point] - sheet->place, sheet->normal);
      own.outward = outward < 0 ? -sheet->normal : sheet->normal;
      if (keys.size() < count) take_all();
      take();
      return true;
    }
  }
  take_all();
  take();
  return false;
}

}  // namespace sfumato::analysis
