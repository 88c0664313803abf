#include "analysis/upright.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

namespace sfumato::analysis {
namespace {

constexpr std::size_t sample_size = 65'536;
/// A cloud less than this share as thick as wide is ground seen from the air, a street, a tile.
constexpr double flat = 0.4;
/// So is one whose middle 90 % of heights are this share of its width, whatever pylons and trees stand on it.
constexpr double mostly_flat = 0.3;
/// By how much another axis must stand firmer than the format's own. Measured on upright statues, rooms and
/// scenes: the right axis leads by 0.15 or more in nine cases of ten.
constexpr double lead = 0.15;
constexpr int cells = 24, layers = 25, fine = 64;
/// Fewer points than so many a column would leave most of a base without one in the lowest layer.
constexpr double points_of_column = 25;
constexpr int fewest_cells = 8;
/// What is thin, but closed all around, is no land: a figure, where the custom says that its length is its
/// height. Columns of which half or more hold two sheets with nothing between, 0 of land; a figure fills no
/// rectangle, and is higher than wide.
constexpr double closed_least = 0.5, filled_most = 0.75, figure = 1.5;
/// Ground is a plane that holds this share of the points, however it is tilted up to here, with nearly all
/// else on one side of it, and reaches farther than what stands on it: of its columns these shares are bare
/// and built upon. A table has the bare ones, but legs are less than that; a chest has nothing bare.
constexpr double ground_least = 0.2, tilt_most = 0.77 /* cos 40 degrees */, above_least = 0.9,
                 bare_least = 0.35, built_least = 0.05;
/// A base is what lies within this share of the height from below. Of a ball that is 8 % of its outline, of
/// feet a third, of a plinth, a floor or the rim of a bottom that was not scanned nearly all.
constexpr double base_height = 0.02;
/// A room, scanned from within, is closed below and above: of the columns along its height this share end in
/// both. So do those along walls that are in line with the axes; then it is lower than wide by this much, and
/// its floor hides behind furniture as no ceiling does, and more than either wall behind the other.
constexpr double closed_columns = 0.6, open_columns = 0.4, lower = 0.8, bare_ceiling = 0.1, bare_wall = 0.05;
/// Of a tunnel, its length over its width and height.
constexpr double long_tube = 2;
/// A side on which this much stands already is not turned upside down.
constexpr double firm_enough = 0.2;

UpAxis axis_of(int axis, bool positive) { return UpAxis(2 * axis + (positive ? 0 : 1)); }

struct Sample {
  std::vector<dvec3> points;  ///< world
  dvec3 mean_normal{0};       ///< length 1 where all normals of the file agree, 0 where it has none
  dvec3 low{0}, high{0};      ///< of all but half a percent at each end
  double most_heights = 0;    ///< along z, of all but 5 % at each end

  explicit Sample(const PointCloud& cloud) {
    const std::size_t stride = std::max<std::size_t>(1, (cloud.size() + sample_size - 1) / sample_size);
    for (std::size_t i = 0; i < cloud.size(); i += stride) {
      points.push_back(cloud.world(i));
      if (!cloud.normals.empty()) mean_normal += dvec3(cloud.normals[i]);
    }
    if (!points.empty()) mean_normal /= double(points.size());
    std::vector<double> values(points.size());
    for (int k = 0; k < 3 && !points.empty(); ++k) {
      for (std::size_t i = 0; i < points.size(); ++i) values[i] = points[i][k];
      std::sort(values.begin(), values.end());
      low[k] = values[values.size() / 200], high[k] = values[values.size() - 1 - values.size() / 200];
      if (k == 2) most_heights = values[values.size() - 1 - values.size() / 20] - values[values.size() / 20];
    }
  }
  dvec3 size() const { return high - low; }

  double share(auto&& holds) const {
    return double(std::count_if(points.begin(), points.end(), holds)) / double(points.size());
  }

  /// Whether all lies in the view of a camera at the origin that looks along `axis`: within 45 degrees of it,
  /// spread over 30 at least and wide itself, which a far object that happens to lie there is not, nor a tile
  /// in map coordinates.
  bool seen_along(int axis, bool positive) const {
    const double sign = positive ? 1 : -1;
    const auto slope = [&](const dvec3& p) {
      const double depth = sign * p[axis];
      return depth > 0 ? std::max(std::abs(p[(axis + 1) % 3]), std::abs(p[(axis + 2) % 3])) / depth : 1e9;
    };
    const auto width = [&](int aside) {
      std::vector<double> slopes;
      for (const dvec3& p : points) slopes.push_back(p[aside] / std::abs(p[axis]));
      std::sort(slopes.begin(), slopes.end());
      return slopes[slopes.size() - 1 - slopes.size() / 50] - slopes[slopes.size() / 50];
    };
    return share([&](const dvec3& p) { return slope(p) < 1; }) > 0.98 &&
           share([&](const dvec3& p) { return slope(p) > 0.27; }) > 0.05 &&
           std::max(width((axis + 1) % 3), width((axis + 2) % 3)) > 0.27;
  }

  /// Of the columns of the box along an axis, the shares that hold anything, that reach its ends, and that
  /// reach both.
  struct Ends {
    double held = 0, low = 0, high = 0, both = 0;
  };
  Ends ends_along(int axis) const {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const dvec3 extent = glm::max(size(), dvec3(1e-300));
    const int across =
        std::clamp(int(std::sqrt(double(points.size()) / points_of_column)), fewest_cells, cells);
    constexpr unsigned held = 1, reaches_low = 2, reaches_high = 4;
    std::vector<unsigned> columns(std::size_t(across * across));
    for (const dvec3& p : points) {
      const dvec3 at = (p - low) / extent;
      if (at[u] < 0 || at[u] > 1 || at[v] < 0 || at[v] > 1) continue;
      unsigned& column = columns[std::size_t(std::min(int(at[u] * across), across - 1) * across +
                                             std::min(int(at[v] * across), across - 1))];
      column |= held | (at[axis] * layers < 1 ? reaches_low : 0u) |
                (at[axis] * layers > layers - 1 ? reaches_high : 0u);
    }
    const auto share = [&](unsigned what) {
      return double(std::count_if(columns.begin(), columns.end(),
                                  [&](unsigned column) { return (column & what) == what; })) /
             double(columns.size());
    };
    return {share(held), share(reaches_low), share(reaches_high), share(reaches_low | reaches_high)};
  }

  /// How well the cloud stands on its end: the share of its box that the columns along `axis` which reach the
  /// lowest layer fill, weighted by how broad that side is. Statues have a base, rooms and streets a floor;
  /// the legs and the top of a table are in line from its side, but fill little of it.
  double stands_on(int axis, bool positive) const {
    const dvec3 extent = glm::max(size(), dvec3(1e-300));
    const double broad = extent[(axis + 1) % 3] * extent[(axis + 2) % 3] /
                         std::max({extent.x * extent.y, extent.y * extent.z, extent.z * extent.x});
    const Ends ends = ends_along(axis);
    return (positive ? ends.low : ends.high) * std::sqrt(broad);
  }

  /// Up in a room with floor and ceiling; nothing elsewhere, and where floor and walls are alike.
  std::optional<UpAxis> up_in_room() const {
    std::array<Ends, 3> ends;
    for (int axis = 0; axis < 3; ++axis) {
      const Ends all = ends_along(axis);
      ends[std::size_t(axis)] = {1, all.low / all.held, all.high / all.held, all.both / all.held};
    }
    const auto hides = [&](int axis) {
      return std::abs(ends[std::size_t(axis)].high - ends[std::size_t(axis)].low);
    };
    for (int axis : {1, 2}) {
      if (!(ends[std::size_t(axis)].both > closed_columns)) continue;
      bool is_height = true;
      for (int other = 0; other < 3; ++other) {
        if (other == axis || ends[std::size_t(other)].both < open_columns) continue;
        is_height = is_height && size()[axis] < lower * size()[other] && hides(axis) > bare_ceiling &&
                    hides(axis) > hides(other) + bare_wall;
      }
      const bool turned = ends[std::size_t(axis)].low > ends[std::size_t(axis)].high + bare_ceiling;
      if (is_height && !(axis == 2 && turned)) return axis_of(axis, !turned);
    }
    return std::nullopt;
  }

  /// Such a one stands as well on each of its sides.
  bool is_closed_box() const {
    for (int axis = 0; axis < 3; ++axis)
      if (const Ends ends = ends_along(axis); !(ends.both > closed_columns * ends.held)) return false;
    return true;
  }

  /// Whether most of what is seen from its end is as long as the whole, and that is long.
  bool is_tube_along(int axis) const {
    return size()[axis] > long_tube * std::max(size()[(axis + 1) % 3], size()[(axis + 2) % 3]) &&
           ends_along(axis).both > closed_columns * ends_along(axis).held;
  }

  /// Static stability (Fu, Cohen-Or, Dror and Sheffer 2008, "Upright orientation of man-made objects", 4.1):
  /// the area of the support polygon, which is the convex hull of the base, over that of the outline seen
  /// from above; 0 where the centre of mass is not above it. Of the points, whose bodies are not known.
  double support(int axis, bool positive) const;

  /// Whether it is a closed body: of the columns along `axis`, most hold two sheets and nothing between, and
  /// they do not fill their rectangle.
  bool is_closed_along(int axis) const {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const dvec3 extent = glm::max(size(), dvec3(1e-300));
    std::vector<std::uint32_t> filled(std::size_t(fine * fine));  // a bit for each layer
    for (const dvec3& p : points) {
      const dvec3 at = glm::clamp((p - low) / extent, dvec3(0), dvec3(0.9999));
      filled[std::size_t(int(at[u] * fine) * fine + int(at[v] * fine))] |= 1u << int(at[axis] * layers);
    }
    int columns = 0, closed = 0;
    for (const std::uint32_t column : filled) {
      columns += column != 0;
      // The longest run of empty layers between two that are not.
      int gap = 0, run = 0;
      for (std::uint32_t rest = column >> std::countr_zero(column | 1u << layers); rest != 0; rest >>= 1) {
        run = (rest & 1) ? 0 : run + 1;
        gap = std::max(gap, run);
      }
      closed += gap >= 3;
    }
    return closed >= closed_least * columns && columns < filled_most * fine * fine;
  }

  /// Towards what stands on the ground, perpendicular to it; nothing where there is no ground.
  std::optional<dvec3> ground_normal() const;
};

/// The convex hull, anticlockwise (Andrew 1979).
std::vector<glm::dvec2> hull_of(std::vector<glm::dvec2> points) {
  const auto right_turn = [](const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) <= 0;
  };
  std::sort(points.begin(), points.end(),
            [](const glm::dvec2& a, const glm::dvec2& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  std::vector<glm::dvec2> hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t first = hull.size();
    for (const glm::dvec2& p : points) {
      while (hull.size() >= first + 2 && right_turn(hull[hull.size() - 2], hull.back(), p)) hull.pop_back();
      hull.push_back(p);
    }
    if (!hull.empty()) hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

double area_of(const std::vector<glm::dvec2>& hull) {
  double twice = 0;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const glm::dvec2 &a = hull[i], &b = hull[(i + 1) % hull.size()];
    twice += a.x * b.y - a.y * b.x;
  }
  return 0.5 * twice;
}

double Sample::support(int axis, bool positive) const {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const double height = size()[axis];
  std::vector<glm::dvec2> base, outline;
  glm::dvec2 center(0);
  for (const dvec3& p : points) {
    if (glm::any(glm::lessThan(p, low)) || glm::any(glm::greaterThan(p, high))) continue;  // strays
    const glm::dvec2 at = glm::dvec2(p[u], p[v]) - glm::dvec2(low[u], low[v]);
    outline.push_back(at);
    center += at;
    if ((positive ? p[axis] - low[axis] : high[axis] - p[axis]) <= base_height * height) base.push_back(at);
  }
  if (base.size() < 3) return 0;
  center /= double(outline.size());
  const std::vector<glm::dvec2> polygon = hull_of(base);
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 edge = polygon[(i + 1) % polygon.size()] - polygon[i], way = center - polygon[i];
    if (!(edge.x * way.y - edge.y * way.x > 0)) return 0;
  }
  const double all = area_of(hull_of(outline));
  return all > 0 ? area_of(polygon) / all : 0;
}

std::optional<dvec3> Sample::ground_normal() const {
  const std::size_t n = points.size();
  const double reach = glm::length(high - low), near = 0.01 * reach;
  if (n < 100 || !(reach > 0)) return std::nullopt;
  // The plane of three points that most others are near, of as many tries as find one of a fifth of all
  // points with 1 - (1 - 0.2^3)^600 = 99 %; of every so many-th point, for a first count.
  std::mt19937 random(5);  // the same picture every time
  const std::size_t stride = std::max<std::size_t>(1, n / 2000);
  dvec3 normal(0);
  double offset = 0;
  std::size_t most = 0;
  for (int tries = 0; tries < 600; ++tries) {
    const dvec3 &a = points[random() % n], &b = points[random() % n], &c = points[random() % n];
    const dvec3 way = glm::cross(b - a, c - a);
    const double length = glm::length(way);
    if (!(length > 1e-4 * reach * reach)) continue;
    const dvec3 across = way / length;
    std::size_t count = 0;
    for (std::size_t i = 0; i < n; i += stride) count += std::abs(glm::dot(points[i] - a, across)) < near;
    if (count > most) most = count, normal = across, offset = glm::dot(a, across);
  }
  if (most == 0 || double(most) < ground_least * double((n + stride - 1) / stride)) return std::nullopt;
  const double above = share([&](const dvec3&p) { return glm::dot(p, normal) > offset + 2 * near; }),
               below = share([&](const dvec3&p) { return glm::dot(p, normal) < offset - 2 * near; });
  if (below > above) normal = -normal, offset = -offset;
  if (std::max(above, below) < above_least * (above + below)) return std::nullopt;
  // Columns perpendicular to the plane.
  const dvec3 u = glm::normalize(
                  glm::cross(normal, std::abs(normal.x) < 0.6 ? dvec3(1, 0, 0) : dvec3(0, 1, 0))),
              v = glm::cross(normal, u);
  std::array<bool, std::size_t(cells * cells)> bare{}, built{};
  const dvec3 middle = 0.5 * (low + high);
  for (const dvec3& p : points) {
    const double x = glm::dot(p - middle, u) / reach + 0.5, y = glm::dot(p - middle, v) / reach + 0.5,
                 height = glm::dot(p, normal) - offset;
    if (!(x >= 0 && y >= 0 && x < 1 && y < 1)) continue;
    const std::size_t cell = std::size_t(int(x * cells) * cells + int(y * cells));
    if (std::abs(height) < 2 * near) bare[cell] = true;
    if (height > 5 * near) built[cell] = true;
  }
  int ground = 0, free = 0, all = 0, with = 0;
  for (std::size_t i = 0; i < bare.size(); ++i) {
    ground += bare[i], free += bare[i] && !built[i];
    all += bare[i] || built[i], with += built[i];
  }
  if (ground < 0.5 * all || free < bare_least * all || with < built_least * all) return std::nullopt;
  return normal;
}

/// Of one picture, from about where it was taken: farther round, all that it hid would gape.
Upright camera_view(UpAxis up, const char* reason) {
  // Azimuth 0 looks from +z where up is -Y, i.e. from behind, and from -y where it is Z: robots look along x.
  const double from = up == UpAxis::neg_y ? 180 : up == UpAxis::pos_z ? -90 : 0;
  return {up, reason, from - 15, 10, true};
}

/// What nothing but a custom speaks for: Y and Z are what programs mean by up.
Upright unsure(Upright upright, const char* reason) {
  upright.reason = reason;
  if (upright.up == UpAxis::pos_y) upright.other = UpAxis::pos_z;
  if (upright.up == UpAxis::pos_z) upright.other = UpAxis::pos_y;
  return upright;
}

}  // namespace

Upright guess_upright(const PointCloud& cloud) {
  const Upright custom{cloud.up, "the convention of its format", -45, 30};
  if (cloud.size() < 100) return custom;
  const Sample sample(cloud);
  const dvec3 size = sample.size();

  // Depth cameras look along z with y down, renderers along -z with y up.
  if (sample.seen_along(2, true))
    return camera_view(UpAxis::neg_y, "a camera's view: all lies before the origin, along z");
  if (sample.seen_along(2, false))
    return camera_view(UpAxis::pos_y, "a camera's view: all lies before the origin, along -z");
  if (cloud.up == UpAxis::pos_z && sample.seen_along(0, true))
    return camera_view(UpAxis::pos_z, "a scanner's view: all lies before the origin, along x");
  // Nothing that one walks on faces down: these normals face a camera that looked along z.
  if (sample.mean_normal.z < -0.5)
    return camera_view(UpAxis::neg_y, "its normals face a camera that looked along z");

  const std::array<int, 3> by_size = [&] {
    std::array<int, 3> order{0, 1, 2};
    std::sort(order.begin(), order.end(), [&](int a, int b) { return size[a] < size[b]; });
    return order;
  }();
  const int thin = by_size[0], own = int(cloud.up) / 2;
  if (by_size[2] == own && size[own] > figure * size[by_size[1]] && sample.is_closed_along(thin))
    return custom;
  const bool is_survey = cloud.las || !cloud.crs.empty();
  if (const std::optional<UpAxis> up = sample.up_in_room(); up && (!is_survey || int(*up) / 2 == own))
    return {*up, std::string("a room: floor and ceiling across ") + "xyz"[int(*up) / 2], -45, 30};
  const bool is_flat = size[thin] < flat * size[by_size[1]];
  // A survey has a vertical: what is flat in it and does not lie is a facade, or a profile cut out of the
  // whole.
  if (is_flat && thin != own && is_survey) return custom;
  // Land and walls are flat alike. Programs of surveyors have Z for up in every format: what is thin along it
  // lies. Whose formats have it by custom hardly ever mean Y, and what is thin along y is a wall.
  if (is_flat && thin == 1 && own == 2)
    return unsure(custom, "its format's convention; thin along y, as a wall");
  if (is_flat && thin == 1) return unsure({UpAxis::pos_y, "", -45, 30}, "flat: thin along y");
  if (is_flat && thin == 2) return {UpAxis::pos_z, "flat: thin along z", -45, 30};

  if (thin == 2 && sample.most_heights < mostly_flat * size[by_size[1]])
    return {UpAxis::pos_z, "mostly flat: nearly all is thin along z", -45, 30};

  Upright best = custom;
  const double own_floor = sample.stands_on(own, int(cloud.up) % 2 == 0);
  double most = own_floor + lead, most_of_others = 0;
  for (int axis : {1, 2}) {
    const double firm = sample.stands_on(axis, true);
    if (axis == own) continue;
    most_of_others = std::max(most_of_others, firm);
    if (!(firm > most)) continue;  // NaN where there is no extent
    // Tunnels and the like: seen from their end, or lying either way, where a survey's vertical is the better
    // guess.
    const int third = 3 - axis - own;
    if (sample.is_tube_along(axis) || sample.is_closed_box()) continue;
    if (is_survey && size[third] > long_tube * std::max(size[axis], size[own])) continue;
    most = firm;
    best = {axis_of(axis, true), std::string("stands on its lowest layer along ") + "xyz"[axis], -45, 30};
  }
  if (best.up != custom.up) return best;
  // A base that closes below the centre of mass, where the custom would lay it on its face.
  const double own_base = sample.support(own, int(cloud.up) % 2 == 0);
  const double rival = std::max(own_base, sample.support(1, false));  // a reconstruction with y down
  double base_of_others = 0;
  for (int axis : {1, 2}) {
    if (axis == own) continue;
    const double base = sample.support(axis, true);
    if (base > rival + lead)
      return {axis_of(axis, true), std::string("stands on a base across ") + "xyz"[axis], -45, 30};
    base_of_others = std::max(base_of_others, base);
  }
  const bool is_told = own_floor > most_of_others + lead || own_base > base_of_others + lead;
  if (!is_told && !is_survey) best = unsure(custom, "the convention of its format; its shape says nothing");
  if (own_floor > firm_enough) return best;
  // Tilted ground has no lowest layer, and reconstructions from photographs have theirs on top: -Y is up.
  const std::optional<dvec3> ground = sample.ground_normal();
  if (!ground) return best;
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs((*ground)[k]) > std::abs((*ground)[axis])) axis = k;
  const bool positive = (*ground)[axis] > 0;
  // Nobody has X for up, or Z for down.
  if (std::abs((*ground)[axis]) < tilt_most || axis == 0 || (axis == 2 && !positive)) return best;
  if (axis_of(axis, positive) == custom.up) return custom;
  return {axis_of(axis, positive), std::string("stands on ground across ") + "xyz"[axis], -45, 30};
}

}  // namespace sfumato::analysis
