#include "analysis/find_room.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/order.h"

namespace sfumato::analysis {
namespace {

constexpr std::size_t most_sampled = 200'000;
constexpr int most_cells = 48, height_layers = 40;
/// The share of all columns with points that have a floor and a ceiling with open space between, and of those
/// pairs of them a quarter of the room apart that agree on the heights of both: of a body, its top bends
/// away.
constexpr double roofed_least = 0.3, level_least = 0.6;
/// The share of ceilings that are at most three layers thick, with three empty ones below: crowns of a
/// planted forest are level too, but thick.
constexpr double thin_least = 0.5;
/// Columns away from walls in which something stands, as a share of all that are roofed, and of those away
/// from walls: nothing is furniture that stands everywhere, as the middle one of three sheets or a storey
/// between two others.
constexpr double furnished_least = 0.02, furnished_most = 0.9;
/// Ceilings over this share of the plan are cut, a gallery's too; what covers less is a lamp or a beam, 2 %
/// of a furnished room.
constexpr double low_ceilings = 0.1;
/// Walls are sought among what is neither furniture nor lintel.
constexpr double wall_low = 0.35, wall_high = 0.75;
constexpr int wall_bins = 100;
/// An outer wall holds this share of the wall points at least, within this share of the room's width from its
/// end: behind one farther in the scan goes on, as a corridor behind a corner, and all of that would be left
/// out.
constexpr double wall_share = 0.03, wall_reach = 0.15;

struct Column {
  int low = height_layers, high = -1,
      between = 0;  ///< layers of lowest and highest points; occupied ones between them
  bool is_roofed = false, is_thin = false;
};

class Plan {
 public:
  explicit Plan(const PointCloud& cloud) : up_(int(cloud.up) / 2), u_((up_ + 1) % 3), v_((up_ + 2) % 3) {
    const bool down = int(cloud.up) % 2 == 1;
    box_ = robust_bounds(cloud, 0.005, 0.995);
    const std::size_t stride = std::max<std::size_t>(1, (cloud.size() + most_sampled - 1) / most_sampled);
    // Enough points in each column to see floor, ceiling and what is between.
    cells_ = std::clamp(int(std::sqrt(double(std::min(cloud.size(), most_sampled))) / 8), 12, most_cells);
    const double wide = std::max({box_.size()[u_], box_.size()[v_], 1e-300}),
                 high = std::max(box_.size()[up_], 1e-300);
    std::vector<std::array<unsigned char, height_layers>> counts(std::size_t(cells_ * cells_));
    for (std::size_t i = 0; i < cloud.size(); i += stride) {
      const dvec3 p = cloud.world(i);
      points_.push_back(p);
      const double x = (p[u_] - box_.min[u_]) / wide * cells_, y = (p[v_] - box_.min[v_]) / wide * cells_;
      const double z = (down ? box_.max[up_] - p[up_] : p[up_] - box_.min[up_]) / high;
      heights_.push_back(z);
      if (!(x >= 0 && y >= 0 && x < cells_ && y < cells_)) continue;
      unsigned char& count = counts[std::size_t(int(x) * cells_ + int(y))]
                                   [std::size_t(std::clamp(int(z * height_layers), 0, height_layers - 1))];
      count = static_cast<unsigned char>(std::min(255, count + 1));
    }
    columns_.resize(counts.size());
    for (std::size_t c = 0; c < counts.size(); ++c) {
      Column& column = columns_[c];
      for (int layer = 0; layer < height_layers; ++layer)
        if (counts[c][std::size_t(layer)] > 1) column.low = std::min(column.low, layer), column.high = layer;
      for (int layer = column.low + 2; layer <= column.high - 2; ++layer)
        column.between += counts[c][std::size_t(layer)] > 0;
      const int open = column.high - column.low - 3;
      column.is_roofed = open > 0.25 * height_layers && column.between < 0.5 * open;
      column.is_thin = column.is_roofed && counts[c][std::size_t(column.high - 3)] <= 1 &&
                       counts[c][std::size_t(column.high - 4)] <= 1 &&
                       counts[c][std::size_t(column.high - 5)] <= 1;
    }
  }

  bool is_room() const {
    int occupied = 0, roofed = 0, amid = 0, thin = 0, furnished = 0, pairs = 0, level = 0;
    const int apart = cells_ / 4;
    for (int x = 0; x < cells_; ++x)
      for (int y = 0; y < cells_; ++y) {
        const Column& column = at(x, y);
        occupied += column.high >= 0;
        if (!column.is_roofed) continue;
        ++roofed, thin += column.is_thin;
        if (is_amid(x, y)) ++amid, furnished += column.between > 0;
        for (const auto& [dx, dy] : {std::pair(apart, 0), {0, apart}}) {
          if (x + dx >= cells_ || y + dy >= cells_ || !at(x + dx, y + dy).is_roofed) continue;
          const Column& other = at(x + dx, y + dy);
          ++pairs;
          level += std::abs(column.high - other.high) <= 1 && std::abs(column.low - other.low) <= 1;
        }
      }
    return roofed >= roofed_least * occupied && 36 * roofed >= cells_ * cells_ &&
           furnished >= furnished_least * roofed && furnished <= furnished_most * amid &&
           thin >= thin_least * roofed && level >= level_least * pairs;
  }

  Room room(const dvec3& up) const {
    std::vector<int> ceilings;
    for (const Column& column : columns_)
      if (column.is_roofed) ceilings.push_back(column.high);
    const double ceiling =
        (double(nth_value(ceilings, std::size_t(low_ceilings * double(ceilings.size())))) - 0.5) /
        height_layers;
    Room room;
    const bool down = glm::dot(up, dvec3(1)) < 0;
    const double height =
        down ? -(box_.max[up_] - ceiling * box_.size()[up_]) : box_.min[up_] + ceiling * box_.size()[up_];
    room.outside.push_back({up, -height});
    add_walls(room, ceiling);
    return room;
  }

 private:
  const Column& at(int x, int y) const { return columns_[std::size_t(x * cells_ + y)]; }

  /// Not at a wall, whose points are no furniture.
  bool is_amid(int x, int y) const {
    const int away = std::max(1, cells_ / 16);
    if (x < away || y < away || x >= cells_ - away || y >= cells_ - away) return false;
    return at(x - away, y).is_roofed && at(x + away, y).is_roofed && at(x, y - away).is_roofed &&
           at(x, y + away).is_roofed;
  }

  dvec3 direction(double angle) const {
    dvec3 d(0);
    d[u_] = std::cos(angle), d[v_] = std::sin(angle);
    return d;
  }

  static std::vector<double> histogram(const std::vector<dvec3>& points, const dvec3& way, double low,
                                       double high, int bins) {
    std::vector<double> counts(std::size_t(bins), 0.0);
    for (const dvec3& p : points) {
      const int bin = int((glm::dot(p, way) - low) / (high - low) * bins);
      if (bin >= 0 && bin < bins) ++counts[std::size_t(bin)];
    }
    return counts;
  }

  void add_walls(Room& room, double ceiling) const {
    std::vector<dvec3> walls;
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (heights_[i] > wall_low * ceiling && heights_[i] < wall_high * ceiling) walls.push_back(points_[i]);
    if (walls.size() < 1000) return;
    const double reach = 0.75 * glm::length(box_.size());
    const dvec3 middle = box_.center();
    double best = 0, most = -1;
    for (int step = 0; step < 45; ++step) {
      const double angle = glm::radians(2.0 * step);
      double peaks = 0;
      for (const dvec3& way : {direction(angle), direction(angle + glm::half_pi<double>())})
        for (double count :
             histogram(walls, way, glm::dot(middle, way) - reach, glm::dot(middle, way) + reach, 256))
          peaks += count * count;
      if (peaks > most) most = peaks, best = angle;
    }
    for (int side = 0; side < 4; ++side) {
      const dvec3 out = direction(best + side * glm::half_pi<double>());
      std::vector<double> along;
      for (const dvec3& p : walls) along.push_back(glm::dot(p, out));
      const double low = value_at_share(along, 0.005), high = value_at_share(along, 0.998),
                   bin = (high - low) / wall_bins;
      if (!(bin > 0)) continue;
      const std::vector<double> counts = histogram(walls, out, low, high, wall_bins);
      for (int k = wall_bins - 1; k >= int((1 - wall_reach) * wall_bins); --k) {
        // A wall may lie across the border of two bins.
        const auto here = [&](int place) {
          return counts[std::size_t(place)] + counts[std::size_t(place - 1)];
        };
        if (here(k) < wall_share * double(walls.size())) continue;
        // Through all of the wall, which noise makes thick.
        int peak = k;
        for (int inner = k; inner > std::max(1, k - 6); --inner)
          if (here(inner) > here(peak)) peak = inner;
        int end = peak;
        while (end > std::max(1, peak - 6) && here(end) > 0.3 * here(peak)) --end;
        room.outside.push_back({out, -(low + end * bin)});
        break;
      }
    }
  }

  int up_, u_, v_, cells_ = most_cells;
  Bounds box_;
  std::vector<dvec3> points_;
  std::vector<double> heights_;  ///< 0 to 1 of the box
  std::vector<Column> columns_;
};

}  // namespace

std::optional<Room> find_room(const PointCloud& cloud) {
  if (cloud.size() < 5000) return std::nullopt;
  const Plan plan(cloud);
  if (!plan.is_room()) return std::nullopt;
  return plan.room(up_vector(cloud.up));
}

}  // namespace sfumato::analysis
