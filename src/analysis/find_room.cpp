#include "analysis/find_room.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/order.h"

namespace sfumato::analysis {
namespace {

constexpr std::size_t fewest_points = 5000, most_sampled = 200'000;
/// Columns over the plan hold enough points on average to tell a ceiling, open space and a floor. Where they
/// do they are an eighth as wide as rooms are high: in wider ones stand walls, and across four narrower ones
/// noise of a hundredth of that height is no longer level.
constexpr int fewest_across = 12, most_columns_across = 240;
constexpr double points_each = 12, cells_high = 8;
/// Ceilings are level to 6 degrees, and not thicker than a tenth of the open space below: what drift and
/// beams leave, and no crowns.
constexpr double level_slope = 0.105, thin = 0.1;
constexpr double tilted = 0.707;  // cos 45 degrees: what is steeper is no ceiling
/// The share of columns with points that lie below ceilings; of roofed ones that do, and of those below
/// ceilings that have a floor as level; of the ways along the axes of the plan from there that end at walls,
/// as below no table, bridge or crown; and of columns amid them in which something stands: empty rooms are
/// closed boxes. Public scans: docs/measurements/first_view.md.
constexpr double ceilings_least = 1.0 / 6, level_least = 0.7, walled_least = 0.5, furnished_least = 0.02;
/// Of the shares of floors and of walls one may be this part of its least where the other makes up for it.
constexpr double nearly = 0.85;
/// What is cut away below a ceiling, of the height of the open space: lamps, not furniture.
constexpr double margin = 0.1;
/// An outer wall holds this share of the wall points at least, within this share of the room's width from its
/// end: behind one farther in the scan goes on, as a corridor behind a corner, and all of that would be left
/// out.
constexpr int wall_bins = 100;
constexpr double wall_share = 0.03, wall_reach = 0.15;
/// Of all points, what may lie behind an outer wall besides walls, as what was seen through a window: the
/// next room is no less worth seeing.
constexpr double behind_most = 0.01;

constexpr double nothing = std::numeric_limits<double>::infinity();

struct Column {
  std::vector<double> heights;  ///< in order
  std::size_t above = 0;        ///< the place of the lowest one above the widest gap
  double level = 0;             ///< of its ceiling, the lower side
  bool is_roofed = false, has_ceiling = false, has_floor = false, is_wall = false, is_furnished = false;

  /// A point or two at an end may be noise.
  std::size_t strays() const { return heights.size() < 20 ? 1 : 2; }

  double gap() const { return above == 0 ? 0 : heights[above] - heights[above - 1]; }
  double extent() const { return heights.empty() ? 0 : heights.back() - heights.front(); }
  double widest() const {
    double most = 0;
    for (std::size_t i = 1; i < heights.size(); ++i) most = std::max(most, heights[i] - heights[i - 1]);
    return most;
  }
};

/// The lower end of the window of this size that holds most of the values, and the share of them.
std::pair<double, double> densest(std::vector<double>& values, double window) {
  std::sort(values.begin(), values.end());
  std::size_t most = 0, start = 0;
  for (std::size_t first = 0, last = 0; last < values.size(); ++last) {
    while (values[last] - values[first] > window) ++first;
    if (last + 1 - first > most) most = last + 1 - first, start = first;
  }
  return {values[start], double(most) / double(values.size())};
}

class Plan {
 public:
  explicit Plan(const PointCloud& cloud)
      : up_(up_vector(cloud.up)), u_((int(cloud.up) / 2 + 1) % 3), v_((int(cloud.up) / 2 + 2) % 3) {
    const Bounds box = robust_bounds(cloud, 0.005, 0.995);
    // With the walls at its border.
    const double border = 0.02 * std::max({box.size()[u_], box.size()[v_], 1e-300});
    low_ = glm::dvec2(box.min[u_], box.min[v_]) - border;
    wide_ = std::max(box.size()[u_], box.size()[v_]) + 2 * border;
    const std::size_t stride = std::max<std::size_t>(1, (cloud.size() + most_sampled - 1) / most_sampled);
    for (std::size_t i = 0; i < cloud.size(); i += stride) points_.push_back(cloud.world(i));
    fill_at_most(Ceiling::most_across);
    find_roofs();
    if (height_ > 0) {
      fill_at_most(
          int(std::clamp(cells_high * wide_ / height_, double(fewest_across), double(most_columns_across))));
      find_roofs();
    }
    find_ceilings();
  }

  bool is_room() const {
    std::size_t roofed = 0, ceilings = 0, floors = 0, amid = 0, furnished = 0, walls = 0;
    for (int x = 0; x < cells_; ++x)
      for (int y = 0; y < cells_; ++y) {
        const Column& column = at(x, y);
        roofed += column.is_roofed;
        if (!column.has_ceiling) continue;
        ++ceilings, floors += column.has_floor;
        const auto all = [&](const auto& of) {
          return of(x - 1, y) && of(x + 1, y) && of(x, y - 1) && of(x, y + 1) && of(x - 1, y - 1) &&
                 of(x + 1, y - 1) && of(x - 1, y + 1) && of(x + 1, y + 1);
        };
        if (all([&](int a, int b) { return is_in(a, b) && at(a, b).is_roofed; }))
          ++amid, furnished += column.is_furnished;
        for (const auto& [dx, dy] : {std::pair(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
          int a = x + dx, b = y + dy;
          while (is_in(a, b) && !at(a, b).is_wall) a += dx, b += dy;
          walls += is_in(a, b);
        }
      }
    const double floor_share = double(floors) / (level_least * double(ceilings)),
                 walled_share = double(walls) / (walled_least * 4 * double(ceilings));
    return double(ceilings) >= ceilings_least * double(occupied()) &&
           double(ceilings) >= level_least * double(roofed) && floor_share * walled_share >= 1 &&
           std::min(floor_share, walled_share) >= nearly && furnished > 0 &&
           double(furnished) >= furnished_least * double(amid);
  }

  /// Ceilings go on where nothing else was measured below and above them, two columns off at most, and level:
  /// down a ramp they would take the ground with them.
  void spread_ceilings() {
    struct Place {
      int x, y;
      double level;  // of the ceiling that goes on
    };
    std::vector<Place> edge;
    for (int x = 0; x < cells_; ++x)
      for (int y = 0; y < cells_; ++y)
        if (at(x, y).has_ceiling) edge.push_back({x, y, at(x, y).level});
    const double apart = 2 * window();
    for (std::size_t next = 0; next < edge.size(); ++next) {
      const auto [x, y, level] = edge[next];
      for (int a = std::max(0, x - 2); a < std::min(cells_, x + 3); ++a)
        for (int b = std::max(0, y - 2); b < std::min(cells_, y + 3); ++b) {
          Column& column = columns_[std::size_t(a * cells_ + b)];
          if (column.has_ceiling || column.heights.empty() || column.heights.front() < level - apart ||
              column.heights.back() > level + apart)
            continue;
          column.has_ceiling = true, column.level = column.heights.front();
          edge.push_back({a, b, level});
        }
    }
  }

  Room room() const {
    Room room;
    Ceiling& ceiling = room.ceiling.emplace();
    const int across = std::min(cells_, Ceiling::most_across);
    ceiling.up = up_, ceiling.across = across;
    for (int k = 0; k < 2; ++k) {
      glm::dvec4& along = k == 0 ? ceiling.u : ceiling.v;
      along[k == 0 ? u_ : v_] = across / wide_;
      along.w = -low_[k] * across / wide_;
    }
    ceiling.heights.assign(std::size_t(across * across), nothing);
    const auto coarse = [&](int cell) { return (2 * cell + 1) * across / (2 * cells_); };
    for (int x = 0; x < cells_; ++x)
      for (int y = 0; y < cells_; ++y) {
        double& height = ceiling.heights[std::size_t(coarse(y) * across + coarse(x))];
        if (at(x, y).has_ceiling) height = std::min(height, at(x, y).level - margin * height_);
      }
    // Ceilings reach over the walls and cupboards beside them.
    const std::vector<double> own = ceiling.heights;
    for (int x = 0; x < cells_; ++x)
      for (int y = 0; y < cells_; ++y) {
        const auto cell = std::size_t(coarse(y) * across + coarse(x));
        if (own[cell] < nothing) continue;
        for (int a = x - 1; a <= x + 1; ++a)
          for (int b = y - 1; b <= y + 1; ++b)
            if (is_in(a, b) && at(a, b).has_ceiling)
              ceiling.heights[cell] = std::min(ceiling.heights[cell], at(a, b).level - margin * height_);
      }
    add_walls(room);
    return room;
  }

 private:
  const Column& at(int x, int y) const { return columns_[std::size_t(x * cells_ + y)]; }
  bool is_in(int x, int y) const { return x >= 0 && y >= 0 && x < cells_ && y < cells_; }
  /// How far the points of a ceiling may be apart in height, over five columns.
  double window() const { return std::min(thin * height_, 4 * level_slope * wide_ / cells_); }

  bool is_at_wall(int x, int y) const {
    for (int a = x - 1; a <= x + 1; ++a)
      for (int b = y - 1; b <= y + 1; ++b)
        if (is_in(a, b) && at(a, b).is_wall) return true;
    return false;
  }

  std::ptrdiff_t occupied() const {
    return std::count_if(columns_.begin(), columns_.end(),
                         [](const Column& column) { return !column.heights.empty(); });
  }

  int cell_of(const dvec3& p) const {
    const double x = (p[u_] - low_.x) / wide_ * cells_, y = (p[v_] - low_.y) / wide_ * cells_;
    return x >= 0 && y >= 0 && x < cells_ && y < cells_ ? int(x) * cells_ + int(y) : -1;
  }

  void fill(int cells) {
    cells_ = cells;
    columns_.assign(std::size_t(cells * cells), {});
    for (const dvec3& p : points_)
      if (const int cell = cell_of(p); cell >= 0)
        columns_[std::size_t(cell)].heights.push_back(glm::dot(p, up_));
  }

  /// Fewer where they would hold too few points.
  void fill_at_most(int cells) {
    for (fill(cells); cells > fewest_across && double(points_.size()) < points_each * double(occupied());
         fill(cells))
      cells = std::max(fewest_across, int(0.85 * cells));
  }

  /// Columns most of which is open, about as high as usual.
  void find_roofs() {
    std::vector<double> gaps;
    for (Column& column : columns_) {
      std::vector<double>& z = column.heights;
      std::sort(z.begin(), z.end());
      const std::size_t strays = column.strays();
      for (std::size_t i = strays; i + strays <= z.size() && z.size() > 3; ++i)
        if (z[i] - z[i - 1] > column.gap()) column.above = i;
      if (column.gap() > 0.5 * column.extent()) gaps.push_back(column.gap());
    }
    height_ = gaps.size() < 8 ? 0 : value_at_share(gaps, 0.75);
    for (Column& column : columns_)
      column.is_roofed = column.gap() > 0.5 * std::max(column.extent(), height_) && height_ > 0;
  }

  /// Where most of what roofs a place, five columns wide, is on one level, or most of what ends it below; and
  /// what stands there.
  void find_ceilings() {
    const auto roofed = std::count_if(columns_.begin(), columns_.end(),
                                      [](const Column& column) { return column.is_roofed; });
    if (double(roofed) < ceilings_least * double(occupied())) return;
    const double window = this->window();
    for (int x = 0; x < cells_; ++x)
      for (int y = 0; y < cells_; ++y) {
        Column& column = columns_[std::size_t(x * cells_ + y)];
        column.is_wall =
            column.extent() > 0.7 * height_ && column.widest() < 0.4 * height_ && column.heights.size() > 3;
        if (!column.is_roofed) continue;
        std::vector<double> above, below, lowest;
        for (int a = std::max(0, x - 2); a < std::min(cells_, x + 3); ++a)
          for (int b = std::max(0, y - 2); b < std::min(cells_, y + 3); ++b) {
            const Column& other = at(a, b);
            if (!other.is_roofed) continue;
            const auto roof = other.heights.begin() + std::ptrdiff_t(other.above);
            above.insert(above.end(), roof, other.heights.end());
            below.insert(below.end(), other.heights.begin(), roof);
            lowest.push_back(other.heights[other.strays()]);
          }
        const auto [level, share] = densest(above, window);
        const double own = column.heights[(column.above + column.heights.size()) / 2];
        column.level = level;
        column.has_ceiling = share > 0.5 && own >= level - window && own <= level + 2 * window;
        column.has_floor = densest(lowest, window).second > 0.5;
        column.is_furnished =
            column.heights[column.above - 1] - value_at_share(below, 0.1) > 1.2 * margin * height_;
      }
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

  void add_walls(Room& room) const {
    std::vector<dvec3> walls, others;
    Bounds box{points_.front(), points_.front()};
    for (const dvec3& p : points_) {
      const int cell = cell_of(p);
      if (cell < 0) continue;
      box = {glm::min(box.min, p), glm::max(box.max, p)};
      if (columns_[std::size_t(cell)].is_wall)
        walls.push_back(p);
      else if (!is_at_wall(cell / cells_, cell % cells_))
        others.push_back(p);
    }
    if (walls.size() < 1000) return;
    const double reach = 0.75 * glm::length(box.size());
    const dvec3 middle = box.center();
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
        const double place = low + end * bin;
        if (double(std::count_if(others.begin(), others.end(), [&](const dvec3& p) {
              return glm::dot(p, out) > place;
            })) < behind_most * double(points_.size()))
          room.outside.push_back({out, -place});
        break;
      }
    }
  }

  dvec3 up_;
  int u_, v_, cells_ = 0;
  glm::dvec2 low_{0};
  double wide_ = 0, height_ = 0;  ///< of the plan; usual, of the open space below a roof
  std::vector<dvec3> points_;
  std::vector<Column> columns_;
};

/// Whether most of a ceiling shows its upper side, by the file's normals: then it is the top of a body.
bool faces_up(const Ceiling& ceiling, const PointCloud& cloud) {
  std::size_t up = 0, all = 0;
  for (std::size_t i = 0; i < cloud.normals.size(); ++i) {
    if (!ceiling.is_below(cloud.world(i))) continue;
    ++all, up += glm::dot(dvec3(cloud.normals[i]), ceiling.up) > tilted;
  }
  return 2 * up > all;
}

}  // namespace

std::optional<Room> find_room(const PointCloud& cloud) {
  if (cloud.size() < fewest_points) return std::nullopt;
  Plan plan(cloud);
  if (!plan.is_room()) return std::nullopt;
  plan.spread_ceilings();
  Room room = plan.room();
  return faces_up(*room.ceiling, cloud) ? std::nullopt : std::optional(std::move(room));
}

}  // namespace sfumato::analysis
