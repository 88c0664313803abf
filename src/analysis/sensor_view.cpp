#include "analysis/sensor_view.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <queue>
#include <utility>
#include <vector>

#include "analysis/cloud_facts.h"
#include "core/order.h"

namespace sfumato::analysis {
namespace {

/// As many columns as rows of cells over all but 2 % of two coordinates at each end; what is beyond is in the
/// outer ones.
struct Cells {
  int side;
  glm::dvec2 low, high;
  Cells(const std::vector<double>& x, const std::vector<double>& y, int cells)
      : side(cells),
        low(value_at_share(std::vector(x), 0.02), value_at_share(std::vector(y), 0.02)),
        high(value_at_share(std::vector(x), 0.98), value_at_share(std::vector(y), 0.98)) {}
  std::size_t count() const { return std::size_t(side * side); }
  std::size_t place(double x, double y) const {
    const glm::dvec2 at = (glm::dvec2(x, y) - low) / glm::max(high - low, glm::dvec2(1e-300));
    const glm::ivec2 cell(glm::clamp(at * double(side), 0.0, side - 1.0));
    return std::size_t(cell.y * side + cell.x);
  }
  double open_share(const std::vector<double>& x, const std::vector<double>& y) const {
    std::vector<bool> held(count());
    for (std::size_t i = 0; i < x.size(); ++i) held[place(x[i], y[i])] = true;
    return double(std::count(held.begin(), held.end(), false)) / double(count());
  }
};

/// Of a picture of depths, 1e300 where there is none, in cells of slopes.
double faces_up(const std::vector<double>& depths, const Cells& cells) {
  constexpr double level = 0.7, jump = 1.3;  // cos 45 degrees; of depths side by side, on one surface
  const int side = cells.side;
  const auto at = [&](int x, int y) {
    const glm::dvec2 slope = cells.low + (cells.high - cells.low) * (glm::dvec2(x, y) + 0.5) / double(side);
    return depths[std::size_t(y * side + x)] * dvec3(slope, 1);
  };
  double up = 0;
  int all = 0;
  for (int y = 1; y + 1 < side; ++y)
    for (int x = 1; x + 1 < side; ++x) {
      const dvec3 left = at(x - 1, y), right = at(x + 1, y), below = at(x, y - 1), above = at(x, y + 1);
      const auto [least, most] = std::minmax({left.z, right.z, below.z, above.z});
      if (!(most < least * jump)) continue;
      const dvec3 normal = glm::normalize(glm::cross(above - below, right - left));
      ++all;
      if (std::abs(normal.y) > level) up += normal.y > 0 ? 1 : -1;
    }
  return all > 0 ? up / all : 0;
}

/// In how many places values come where these are few: half of the gaps between neighbours are none, and all
/// the way is in the others. As of the slopes of an image's points, but not where all lie on one level grid.
/// 0 where they are everywhere.
std::size_t steps_of(std::vector<double> values, double low, double high) {
  constexpr double none = 0.01, all = 0.985;  // of the mean gap; of the way
  std::erase_if(values, [&](double value) { return value < low || value > high; });
  if (values.size() < 2) return 0;
  std::sort(values.begin(), values.end());
  const double mean = (values.back() - values.front()) / double(values.size() - 1);
  std::size_t closed = 0;
  double open = 0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double gap = values[i] - values[i - 1];
    closed += gap <= none * mean;
    open += gap > mean ? gap : 0;
  }
  const bool are_few = 2 * closed > values.size() && open > all * mean * double(values.size() - 1);
  return mean > 0 && are_few ? values.size() - closed : 0;
}

/// Whether slopes of so many steps are those of pixels: points of a lattice have fewer places than slopes.
bool are_of_pixels(std::size_t slopes, const std::vector<double>& places) {
  const std::size_t steps =
      steps_of(places, value_at_share(std::vector(places), 0.02), value_at_share(std::vector(places), 0.98));
  return steps == 0 || slopes <= steps;
}

/// Points by columns along x, for the few whose nearest are asked for: a tree would cost more.
class AlongX {
 public:
  explicit AlongX(std::span<const vec3> points)
      : points_(points), first_(columns + 1), places_(points.size()) {
    const auto [low, high] = std::minmax_element(points.begin(), points.end(),
                                                 [](const vec3& a, const vec3& b) { return a.x < b.x; });
    low_ = low->x, width_ = (double(high->x) - low_) / columns;
    for (const vec3& p : points) ++first_[column_of(p) + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t i = 0; i < points.size(); ++i) places_[next[column_of(points[i])]++] = i;
  }

  /// The squared distance and the place of the nearest that lies elsewhere, the first of those; infinitely
  /// far where there is none.
  std::pair<float, std::uint32_t> nearest_other(const vec3& from) const {
    std::pair<float, std::uint32_t> nearest{std::numeric_limits<float>::infinity(), 0};
    const auto ask = [&](int column) {
      if (column < 0 || column >= columns) return;
      for (std::uint32_t k = first_[std::size_t(column)]; k < first_[std::size_t(column) + 1]; ++k) {
        const vec3 d = points_[places_[k]] - from;
        if (const float distance2 = glm::dot(d, d); distance2 > 0)
          nearest = std::min(nearest, {distance2, places_[k]});
      }
    };
    const int here = int(column_of(from));
    ask(here);
    for (int away = 1; away < columns; ++away) {
      const double gap = (away - 2) * width_;  // less by a column than it is: roundings
      if (gap > 0 && gap * gap > double(nearest.first)) break;
      ask(here - away), ask(here + away);
    }
    return nearest;
  }

 private:
  static constexpr int columns = 4096;
  std::size_t column_of(const vec3& p) const {
    return width_ > 0 ? std::size_t(std::min((p.x - low_) / width_, columns - 1.0)) : 0;
  }
  std::span<const vec3> points_;
  double low_ = 0, width_ = 0;
  std::vector<std::uint32_t> first_, places_;
};

}  // namespace

SensorView sensor_view_of(std::span<const dvec3> points, const dvec3& eye, const dvec3& along,
                          const dvec3& up) {
  constexpr double cone = 1.73, within = 0.98;  // tan 60 degrees
  constexpr double near = 0.33;                 // of the median depth; what stands there has less than .1
  const dvec3 right = glm::normalize(glm::cross(along, up)), above = glm::cross(right, along);
  std::vector<double> x, y, depths;
  std::size_t measured = 0;
  for (const dvec3& p : points) {
    if (p == eye) continue;  // what sensors write where they see nothing
    ++measured;
    const double depth = glm::dot(p - eye, along);
    const double u = glm::dot(p - eye, right) / depth, v = glm::dot(p - eye, above) / depth;
    if (depth > 0 && std::max(std::abs(u), std::abs(v)) < cone)
      x.push_back(u), y.push_back(v), depths.push_back(depth);
  }
  if (!(double(depths.size()) > within * double(measured))) return {};
  const int side = std::clamp(int(std::sqrt(double(depths.size()) / 8)), 4, 64);  // eight points a cell
  const Cells cells(x, y, side);
  const glm::dvec2 &low = cells.low, &high = cells.high;
  const double width = std::max(high.x - low.x, high.y - low.y);
  std::vector<double> nearest(cells.count(), 1e300);
  std::vector<std::size_t> place(depths.size());
  for (std::size_t i = 0; i < depths.size(); ++i) {
    place[i] = cells.place(x[i], y[i]);
    nearest[place[i]] = std::min(nearest[place[i]], depths[i]);
  }
  // A surface at 70 degrees from the line of sight spans three widths of a cell in depth.
  const double behind = 1 + 3 * width / side;
  std::size_t seen = 0;
  for (std::size_t i = 0; i < depths.size(); ++i) seen += depths[i] < nearest[place[i]] * behind;
  SensorView view;
  view.first = double(seen) / double(depths.size());
  view.faces_up = faces_up(nearest, cells);
  view.width = width;
  // In cells of 8 points chance leaves some open, and those of 32 points hide the shape of a crown or of
  // land.
  const int coarse = std::max(side / 2, 4);
  const double open = cells.open_share(x, y), open_coarse = Cells(x, y, coarse).open_share(x, y);
  const std::size_t columns = steps_of(x, low.x, high.x),
                    rows = columns == 0 ? 0 : steps_of(y, low.y, high.y);
  for (std::size_t i = 0; i < depths.size(); ++i) x[i] *= depths[i], y[i] *= depths[i];
  view.of_pixels = rows > 0 && are_of_pixels(columns, x) && are_of_pixels(rows, y);
  const auto closed_share = [&](double open_before, int cells_across) {
    constexpr double chance = 0.02;  // of the cells, which random points leave open
    const double open_across = Cells(x, y, cells_across).open_share(x, y);
    return std::max(0.0, open_across - open_before) / (open_across + chance);
  };
  view.framed = std::min(closed_share(open, side), closed_share(open_coarse, coarse));
  const double nearest_depth = value_at_share(depths, 0.02);  // moves them
  view.is_beside = glm::any(glm::greaterThanEqual(low, glm::dvec2(0))) ||
                   glm::any(glm::lessThanEqual(high, glm::dvec2(0)));
  view.ahead = !view.is_beside && nearest_depth > near * value_at_share(depths, 0.5);
  view.afar = nearest_depth > value_at_share(depths, 0.98) - nearest_depth;
  return view;
}

double is_one_picture(const SensorView& view) {
  return std::clamp((view.first - 0.75) / (0.9 - 0.75), 0.0, 1.0);
}

double is_image(const SensorView& view) {
  // Of depth cameras that fill their picture `framed` is 0.32 to 0.92, of other clouds before the origin 0 to
  // 0.15, of photographs 0 to 0.2 (docs/measurements/first_view.md).
  return view.of_pixels ? 1 : std::clamp((view.framed - 0.2) / (0.5 - 0.2), 0.0, 1.0);
}

dvec3 mean_direction(std::span<const dvec3> points, const dvec3& eye) {
  dvec3 along(0);
  for (const dvec3& p : points)
    if (p != eye) along += glm::normalize(p - eye);
  return glm::length(along) > 0 ? glm::normalize(along) : dvec3(0);
}

double turned_share(std::span<const vec3> points, const vec3& eye, const vec3& up) {
  constexpr std::size_t asked = 128, most = 1 << 20;  // 128 lines of 4096 steps, twice
  constexpr double level = 0.1, usual = 1.5;          // rise over way; times the median, as lines have gaps
  if (points.empty() || points.size() > most) return 0;
  struct Step {
    double way = 0, rise = 0;  // radians
  };
  // Those of the least hashes, whatever the order of the file.
  std::priority_queue<std::pair<std::uint64_t, std::uint32_t>> least;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const std::pair mine(hash_of(dvec3(points[i])), i);
    if (least.size() == asked && least.top() <= mine) continue;
    if (least.size() == asked) least.pop();
    least.push(mine);
  }
  std::vector<std::uint32_t> order;
  for (; !least.empty(); least.pop()) order.push_back(least.top().second);
  const std::size_t first = order.size();
  const AlongX along_x(points);
  std::vector<Step> steps(first);
  tbb::parallel_for(std::size_t(0), first, [&](std::size_t k) {
    const vec3& from = points[order[k]];
    const auto nearest = along_x.nearest_other(from);
    const vec3 to = std::isfinite(nearest.first) ? points[nearest.second] : eye;
    if (from == eye || to == eye) return;
    const dvec3 before = glm::normalize(dvec3(from - eye)), after = glm::normalize(dvec3(to - eye));
    const auto elevation = [&](const dvec3& along) {
      return std::asin(std::clamp(glm::dot(along, dvec3(up)), -1.0, 1.0));
    };
    steps[k] = {glm::distance(before, after), std::abs(elevation(after) - elevation(before))};
  });
  std::vector<double> ways;
  for (const Step& step : steps) ways.push_back(step.way);
  const double step_of_most = value_at_share(ways, 0.5);
  const auto beside = std::count_if(steps.begin(), steps.end(), [&](const Step& step) {
    return step.rise < level * step.way && step.way < usual * step_of_most && step_of_most < usual * step.way;
  });
  return double(beside) / double(first);
}

bool are_one_picture(std::span<const dvec3> points, const dvec3& eye) {
  const dvec3 along = mean_direction(points, eye);
  if (along == dvec3(0)) return false;
  const dvec3 up = std::abs(along.z) < 0.7 ? dvec3(0, 0, 1) : dvec3(0, 1, 0);
  const SensorView view = sensor_view_of(points, eye, along, up);
  return !view.is_narrow() && is_one_picture(view) >= 0.5;
}

}  // namespace sfumato::analysis
