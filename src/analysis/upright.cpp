#include "analysis/upright.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "analysis/facets.h"
#include "analysis/sensor_view.h"
#include "core/coloring.h"
#include "core/order.h"

namespace sfumato::analysis {
namespace {

constexpr std::size_t sample_size = 65'536;
/// A guess less probable than this is called one: of the others 95 % are right
/// (docs/measurements/first_view.md has the curve).
constexpr double sure = 0.92;
/// Columns to a side of a face of the box, layers along them.
constexpr int cells = 24, layers = 25, fine = 64;
/// Fewer points than so many a column would leave most of a base without one in the lowest layer.
constexpr double points_of_column = 25;
constexpr int fewest_cells = 8;
/// A base is what lies within this share of the height from below. Of a ball that is 8 % of its outline, of
/// feet a third, of a plinth, a floor or the rim of a bottom that was not scanned nearly all.
constexpr double base_height = 0.02;
/// What lies within this share is its foot, of which the middle counts and no outline.
constexpr double foot_height = 0.05;
/// Of columns that hold anything, those that end in both layers of a room, with floor and ceiling.
constexpr double closed_columns = 0.6;
/// What is on a plane is as near to it, of the diagonal.
constexpr double on_plane = 0.01;

/// The weights of the evidence, in the order of UpEvidence: a conditional logit (McFadden 1974). The first
/// fit was to 119 labelled public scans that say no axis and, each with a weight of .3, 34 that do and 205
/// made ones, with a Gaussian prior of deviation 4; no public scan had a `room`: the prior of that weight
/// is 3.3. These are of a second one, to 210 scans and, for `lidar` and `ground`, sweeps turned over: the
/// prior is 0, of deviation 4, for those two, `normals` and `z_in_obj`, which are new or have another meaning
/// now, the first fit, of .3, for the others, and `y_for_z`, `down`, `rare` and `camera` are as they were.
/// That of `aside` alone is of a third, to the same scans. Where those of one source are left out of the fit,
/// 194 of the 210 are right, and the mean log loss is .33. That of `placed` is by counts of 241.
constexpr double weights[] = {-1.2, -0.5, -1.8, -3.4, -4.4, 3.5, 4.7, 3.6, -2.9, 2.0,
                              3.3,  5.3,  -7.0, 5.4,  6.3,  2.7, 3.2, 3.6, 5.2,  3.0};
static_assert(std::size(weights) == std::size_t(UpEvidence::count));
constexpr const char* words[] = {"",
                                 "",
                                 "",
                                 "",
                                 "",
                                 "a camera's view: all lies before the origin",
                                 "its normals point there",
                                 "stands on a base",
                                 "its foot is below its middle",
                                 "flat",
                                 "all stands on ground",
                                 "a room: floor and ceiling",
                                 "unlike above and below",
                                 "its surfaces are level",
                                 "its surfaces are level and plumb",
                                 "its level surfaces face there",
                                 "something reaches through all its height",
                                 "a lidar turned about it",
                                 "the ground lies below the lidar",
                                 "its lowest place is at 0"};

/// 0 up to `none`, 1 from `all` on.
double ramp(double value, double none, double all) {
  return std::clamp((value - none) / (all - none), 0.0, 1.0);
}

/// At 0 0 0 sensors put what they do not see.
bool is_measured(const PointCloud& cloud, std::size_t i) { return cloud.world(i) != dvec3(0); }

/// Of the third of the points at each end: one or two are strays.
Bounds bounds_of_most(const PointCloud& cloud) {
  constexpr int n = 3;
  double low[3][n], high[3][n];  // the lowest and the highest so far, the outermost first
  for (int k = 0; k < 3; ++k) std::fill_n(low[k], n, HUGE_VAL), std::fill_n(high[k], n, -HUGE_VAL);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const dvec3 p = cloud.world(i);
    for (int k = 0; k < 3; ++k) {
      if (p[k] >= low[k][n - 1] && p[k] <= high[k][n - 1]) continue;  // nearly all
      if (!is_measured(cloud, i)) break;
      double lower = p[k], higher = p[k];
      for (int j = 0; j < n; ++j) {
        if (lower < low[k][j]) std::swap(lower, low[k][j]);
        if (higher > high[k][j]) std::swap(higher, high[k][j]);
      }
    }
  }
  return {{low[0][n - 1], low[1][n - 1], low[2][n - 1]}, {high[0][n - 1], high[1][n - 1], high[2][n - 1]}};
}

/// How surely somebody placed it there: its lowest place along an axis is at 0, and 0 is in the middle of it
/// across.
double placed(const Bounds& box, UpAxis up) {
  constexpr double at_zero = 0.001, off_zero = 0.004, in_middle = 0.25, aside = 0.15;  // of the extent
  const int axis = int(up) / 2;
  const dvec3 size = glm::max(box.max - box.min, dvec3(1e-300));
  const double lowest = int(up) % 2 == 0 ? box.min[axis] : -box.max[axis];
  double likely = 1 - ramp(std::abs(lowest) / size[axis], at_zero, off_zero);
  for (int k = 0; k < 3; ++k)
    if (k != axis) likely *= ramp(std::min(-box.min[k], box.max[k]) / size[k], aside, in_middle);
  return likely;
}

/// NaN of what is no part of the grid.
double row_of(const sfumato::Grid& grid, std::uint32_t place) {
  const std::uint32_t row = place / std::max(grid.width, 1u);
  return row < grid.height ? double(row) : std::numeric_limits<double>::quiet_NaN();
}

struct Sample {
  std::vector<dvec3> points;  ///< world
  std::vector<vec3> normals;  ///< of the file, may be empty
  std::vector<double> rows;   ///< of an organised file, from 0; may be empty
  dvec3 mean_normal{0};       ///< length 1 where all normals of the file agree, 0 where it has none
  dvec3 low{0}, high{0};      ///< of all but half a percent at each end
  dvec3 most{0};              ///< the extent of all but 5 % at each end

  explicit Sample(const PointCloud& cloud) {
    const std::size_t stride = std::max<std::size_t>(1, (cloud.size() + sample_size - 1) / sample_size);
    for (std::size_t i = 0; i < cloud.size(); i += stride) {
      if (!is_measured(cloud, i)) continue;
      points.push_back(cloud.world(i));
      if (cloud.grids.size() == 1 && !cloud.grid_index.empty())
        rows.push_back(row_of(cloud.grids[0], cloud.grid_index[i]));
      if (cloud.normals.empty()) continue;
      normals.push_back(cloud.normals[i]);
      mean_normal += dvec3(cloud.normals[i]);
    }
    mean_normal /= double(std::max<std::size_t>(1, points.size()));
    std::vector<double> values(points.size());
    for (int k = 0; k < 3; ++k) {
      for (std::size_t i = 0; i < points.size(); ++i) values[i] = points[i][k];
      low[k] = value_at_share(values, 0.005), high[k] = value_at_share(values, 0.995);
      most[k] = value_at_share(values, 0.95) - value_at_share(values, 0.05);
    }
  }
  dvec3 size() const { return high - low; }

  double share(auto&& holds) const {
    return double(std::count_if(points.begin(), points.end(), holds)) / double(points.size());
  }

  /// Where a point is in the box, 0 to 1.
  dvec3 place(const dvec3& p) const { return (p - low) / glm::max(size(), dvec3(1e-300)); }

  /// How broad the side across an axis is, against the broadest: a slab does not stand on its edge.
  double broadness(int axis) const {
    const dvec3 extent = glm::max(size(), dvec3(1e-150));
    return std::sqrt(extent.x * extent.y * extent.z / extent[axis] /
                     std::max({extent.x * extent.y, extent.y * extent.z, extent.z * extent.x}));
  }

  /// How surely all lies in the axes of a camera at the origin that looked along an axis, and of that what
  /// speaks for the other sign of y than the custom of such cameras.
  struct Picture {
    double seen = 0, turned = 0;
  };
  Picture seen_along(int axis, bool positive, bool colored, bool photographed = false) const;
  bool is_all_before() const;

  double downwards(int axis) const;
  double turned_about(const dvec3& lidar, int axis) const;
  double looked_down(const dvec3& lidar, int axis) const;
  double beneath(const dvec3& lidar, const dvec3& up, double ground) const;

  /// Of the columns along an axis that hold anything, the shares that reach its ends and that reach both;
  /// `held` those of all columns of the box; `fullest` the share of its layers that one of them holds.
  struct Ends {
    double held = 0, low = 0, high = 0, both = 0, fullest = 0;
    double bare() const { return std::abs(high - low); }  ///< more of the one end than of the other
  };
  Ends ends_along(int axis) const;
  std::vector<std::uint32_t> columns_along(int axis, int across) const;  ///< a bit for each layer
  int columns_across(double points_each = points_of_column, int most_cells = cells) const {
    return std::clamp(int(std::sqrt(double(points.size()) / points_each)), fewest_cells, most_cells);
  }
  std::optional<UpAxis> up_in_room() const;
  struct Support {
    double base = 0, aside = 0;
  };
  Support support(int axis, bool positive) const;
  bool is_box() const;
  bool is_closed_along(int axis) const;
  double lies(int axis) const;
  double mirrored_across(int axis) const;
  /// How surely it stands on what is below along an axis, and which way is up then.
  struct Stand {
    double sure = 0;
    dvec3 up{0};
  };
  Stand stands(UpAxis way) const;
  dvec3 ground(UpAxis up, const Stand& stand) const;
};
using Stands = std::array<Sample::Stand, 6>;  ///< of each UpAxis

/// All is within 60 degrees of the axis, and each line of sight meets one surface only, as of no body or room
/// that was scanned from several sides; but not land, which any place above it sees so: a tile whose plan
/// was shifted to its middle has the origin far below it. Or its lines of sight are in rows and columns, or
/// end at the sides of an image and not of a plan. What many photographs saw has colours and the axes of the
/// first camera, which it is before.
Sample::Picture Sample::seen_along(int axis, bool positive, bool colored, bool photographed) const {
  // The sign of y: of 12 public pictures of pixels the custom holds for all, of 21 other sources for 14. The
  // rows of an organised file say it without a custom. More of what is level is seen from its side along y
  // than from the other, as floors and tables are, where a tenth of all is so surely: that says it in 25 of
  // 26 pictures, but not of who looks at a ceiling. What photographs saw was seen from more sides than one.
  constexpr double not_of_pixels = 0.25, seen_from_more = 0.4, sure_floors = 0.1, in_rows = 0.9;
  // Of eight public sources with colours that lie before the origin so and are no picture six are of
  // photographs. Of seventeen that lie afar along z, thin ones too, twelve are what depth cameras saw.
  constexpr double of_photographs = 0.75;
  // Of five that lie to one side of where a camera looked and fill no picture two are what one saw.
  constexpr double of_segments = 0.4;
  dvec3 along(0);
  along[axis] = positive ? 1 : -1;
  const SensorView view =
      sensor_view_of(points, dvec3(0), along, axis == 1 ? dvec3(0, 0, 1) : dvec3(0, 1, 0));
  if (view.width == 0 && photographed && axis == 2 && positive && is_all_before()) {
    const double seen = of_photographs * (1 - lies(axis));
    return {seen, seen * not_of_pixels};
  }
  if (view.is_narrow()) return {};
  const double one = is_one_picture(view), image = is_image(view);
  const bool is_afar = axis == 2 && positive && view.afar;
  const double before = view.is_beside
                            ? (is_afar ? of_photographs : of_segments) * one
                            : std::max(one, view.ahead && (colored || is_afar) ? of_photographs : 0);
  const double seen = std::max(image, before * (1 - lies(axis)));
  const double custom = positive ? -1 : 1, down = custom * downwards(axis);
  const double sign = down < -in_rows ? -custom : custom;
  const double floors = sign * std::clamp(view.faces_up / sure_floors, -1.0, 1.0);
  const double unsure = view.of_pixels || std::abs(down) > in_rows ? 0 : not_of_pixels;
  // Where they contradict the rows, of which 8 of 9 run down, 25 of 26 floors are right: 25 to 8.
  const double opposed = std::abs(down) > in_rows ? 0.75 : std::max({one, image, seen_from_more});
  const double opposite = std::max(-opposed * floors, unsure * std::min(1 - floors, 1.0));
  const double turned = sign == custom ? opposite : 1 - opposite;
  return {seen, seen * turned};
}

/// Seen along z nothing lies behind the origin nor near it, and most within 60 degrees: what several cameras
/// that looked about the same way saw, in the axes of the first.
bool Sample::is_all_before() const {
  constexpr double behind = 0.005, nearest = 0.02, near = 0.33;  // of the points, and of the median depth
  constexpr double cone = 1.73, within = 0.75;                   // tan 60 degrees
  std::vector<double> depths;
  for (const dvec3& p : points) depths.push_back(p.z);
  return share([&](const dvec3& p) { return std::max(std::abs(p.x), std::abs(p.y)) < cone * p.z; }) >
             within &&
         value_at_share(depths, behind) > 0 &&
         value_at_share(depths, nearest) > near * value_at_share(depths, 0.5);
}

/// How far down rows run that lie side by side before the origin along an axis: the correlation of a row's
/// number with -y over the depth. In 8 of 9 organised pictures of depth cameras the first row is on top, as
/// in images; one camera lay on its side.
double Sample::downwards(int axis) const {
  double n = 0, row = 0, slope = 0, rows2 = 0, slopes2 = 0, both = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double depth = std::abs(points[i][axis]);
    if (!(depth > 0) || std::isnan(rows[i])) continue;
    const double down = -points[i].y / depth;
    ++n, row += rows[i], slope += down;
    rows2 += rows[i] * rows[i], slopes2 += down * down, both += rows[i] * down;
  }
  const double spread = (n * rows2 - row * row) * (n * slopes2 - slope * slope);
  return spread > 0 ? (n * both - row * slope) / std::sqrt(spread) : 0;
}

/// How surely a lidar turned there about an axis: it saw something on all sides, and nothing along the axis,
/// where it is blind. Its lines rise or fall by 45 degrees at most (Ouster OS0; 25 to 31 of Velodyne's), and
/// by more than what lies level in a plane with the origin, as a floor does: those of 16 lines by 15.
double Sample::turned_about(const dvec3& lidar, int axis) const {
  constexpr double steepest = 0.707, too_steep = 0.866;  // sin 45, 60 degrees
  constexpr double level = 0.035, steep_enough = 0.17;   // sin 2, 10 degrees
  constexpr double usual_enough = 0.087;                 // sin 5 degrees
  constexpr std::size_t sectors = 36;
  constexpr double least = 0.07;  // of what a sector holds in the mean
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  std::array<int, sectors> held{};
  std::vector<double> steepness;
  for (const dvec3& p : points) {
    const dvec3 way = p - lidar;
    if (!(glm::length(way) > 0)) continue;
    steepness.push_back(std::abs(way[axis]) / glm::length(way));
    const double turn = 0.5 + std::atan2(way[v], way[u]) / glm::two_pi<double>();
    ++held[std::min(std::size_t(turn * sectors), sectors - 1)];
  }
  const double fewest = least * double(points.size()) / double(sectors);
  if (!(*std::min_element(held.begin(), held.end()) > fewest)) return 0;
  // A map about its origin is flat: of a lidar's returns half are steeper than what grazes.
  const double usual = value_at_share(steepness, 0.5);
  const double steep = value_at_share(steepness, 0.995);  // not what a stray one says
  return ramp(usual, level, usual_enough) * ramp(steep, level, steep_enough) *
         (1 - ramp(steep, steepest, too_steep));
}

/// How surely a lidar that turned there saw more of one side of an axis: 1 below, -1 above, 0 alike. Those of
/// vehicles fall by 25 and 31 degrees and rise by 2 and 11 (Velodyne's HDL-64E, HDL-32E), others as far; no
/// sky and no removed ground changes that.
double Sample::looked_down(const dvec3& lidar, int axis) const {
  constexpr double alike = 0.5, unlike = 0.8;  // the difference by the greater of both
  std::vector<double> sines;
  for (const dvec3& p : points)
    if (const double far = glm::length(p - lidar); far > 0) sines.push_back((p[axis] - lidar[axis]) / far);
  if (sines.empty()) return 0;
  const double up = std::max(value_at_share(sines, 0.995), 0.0),
               down = std::max(-value_at_share(sines, 0.005), 0.0);
  const double more = (down - up) / std::max({down, up, 1e-300});
  return std::copysign(ramp(std::abs(more), alike, unlike), more);
}

/// How surely that is no ground below a lidar, so far down: much of what lies lower than the lidar is as far
/// again below it.
double Sample::beneath(const dvec3& lidar, const dvec3& up, double ground) const {
  constexpr double little = 0.02, much = 0.1;  // of 31 sweeps all have .001 at most, maps up to .1
  double lower = 0, beneath = 0;
  for (const dvec3& p : points) {
    const double depth = glm::dot(lidar - p, up);
    lower += depth > 0, beneath += depth > 2 * ground;
  }
  return ramp(beneath / std::max(lower, 1.0), little, much);
}

std::vector<std::uint32_t> Sample::columns_along(int axis, int across) const {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  std::vector<std::uint32_t> columns(std::size_t(across * across));
  for (const dvec3& p : points) {
    const dvec3 at = place(p);
    if (at[u] < 0 || at[u] > 1 || at[v] < 0 || at[v] > 1) continue;
    columns[std::size_t(std::min(int(at[u] * across), across - 1) * across +
                        std::min(int(at[v] * across), across - 1))] |=
        1u << int(std::clamp(at[axis], 0.0, 0.9999) * layers);
  }
  return columns;
}

Sample::Ends Sample::ends_along(int axis) const {
  constexpr std::uint32_t lowest = 1, highest = 1u << (layers - 1);
  const std::vector<std::uint32_t> columns = columns_along(axis, columns_across());
  Ends ends;
  for (const std::uint32_t column : columns) {
    const bool reaches_low = (column & lowest) != 0, reaches_high = (column & highest) != 0;
    ends.held += column != 0, ends.low += reaches_low, ends.high += reaches_high;
    ends.both += reaches_low && reaches_high;
    ends.fullest = std::max(ends.fullest, std::popcount(column) / double(layers));
  }
  const double all = std::max(ends.held, 1.0);
  ends.held /= double(columns.size()), ends.low /= all, ends.high /= all, ends.both /= all;
  return ends;
}

/// A room, scanned from within, is closed below and above; so are the columns along walls that are in line
/// with the axes, but a room is lower than long, and than wide where walls are, and its floor hides behind
/// furniture as no ceiling does, and more than either wall behind the other. Nothing where floor and walls
/// are alike.
std::optional<UpAxis> Sample::up_in_room() const {
  constexpr double open_columns = 0.4, lower = 0.8, bare_ceiling = 0.1, bare_wall = 0.05;
  for (int axis : {1, 2}) {
    const Ends ends = ends_along(axis);
    if (!(ends.both > closed_columns)) continue;
    bool is_height = size()[axis] < std::max(size()[axis == 1 ? 2 : 1], size()[0]);
    for (int other = 0; other < 3; ++other) {
      const Ends walls = ends_along(other);
      if (other == axis || walls.both < open_columns) continue;
      is_height = is_height && size()[axis] < lower * size()[other] && ends.bare() > bare_ceiling &&
                  ends.bare() > walls.bare() + bare_wall;
    }
    const bool turned = ends.low > ends.high + bare_ceiling;
    if (is_height && !(axis == 2 && turned)) return UpAxis(2 * axis + turned);
  }
  return std::nullopt;
}

/// Closed all around, as a room: its walls may be larger than its floor, and it stands on any of its sides.
bool Sample::is_box() const {
  return std::min({ends_along(0).both, ends_along(1).both, ends_along(2).both}) > closed_columns;
}

/// Whether it is a closed body: of the columns along `axis`, half or more hold two sheets and nothing
/// between, and they do not fill their rectangle. 0 of land.
bool Sample::is_closed_along(int axis) const {
  const std::vector<std::uint32_t> filled = columns_along(axis, columns_across(10, fine));
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
  return 2 * closed >= columns && 4 * std::size_t(columns) < 3 * filled.size();
}

/// How much nearly all is land: thin along an axis, whatever pylons and trees stand on it, and not a figure
/// that is closed all around, unless it is as flat as a sheet.
double Sample::lies(int axis) const {
  const double thin = most[axis] / std::max(std::min(size()[(axis + 1) % 3], size()[(axis + 2) % 3]), 1e-300);
  constexpr double sheet = 0.05;
  return thin > sheet && thin < 0.4 && is_closed_along(axis) ? 0 : 1 - ramp(thin, 0.15, 0.4);
}

/// How like its mirror image the box is across the middle of an axis: of the cells that hold anything in one
/// of both, the share that does in both. What stands is alike left and right, not above and below.
double Sample::mirrored_across(int axis) const {
  const int side = std::clamp(int(std::cbrt(double(points.size()) / 8)), 6, 24);
  std::vector<bool> held(std::size_t(side * side * side));
  const auto cell = [&](int x, int y, int z) { return std::size_t((z * side + y) * side + x); };
  for (const dvec3& p : points) {
    const dvec3 at = glm::clamp(place(p), dvec3(0), dvec3(0.9999)) * double(side);
    held[cell(int(at.x), int(at.y), int(at.z))] = true;
  }
  int either = 0, both = 0;
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const bool here = held[cell(x, y, z)];
        const bool there = held[cell(axis == 0 ? side - 1 - x : x, axis == 1 ? side - 1 - y : y,
                                     axis == 2 ? side - 1 - z : z)];
        either += here || there, both += here && there;
      }
  return double(both) / double(std::max(either, 1));
}

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

/// Static stability (Fu, Cohen-Or, Dror and Sheffer 2008, "Upright orientation of man-made objects", 4.1):
/// the area of the support polygon, which is the convex hull of the base, over that of the outline seen from
/// above; 0 where the centre of mass is not above it. Of the points, whose bodies are not known. And how far
/// from below that centre the middle of the foot is, over the root mean square of all distances from it, 1
/// at most: what grows from a stem or stands on legs is over it, though that is no polygon.
Sample::Support Sample::support(int axis, bool positive) const {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  std::vector<glm::dvec2> base, outline;
  glm::dvec2 center(0), foot(0);
  double feet = 0, spread = 0;
  for (const dvec3& p : points) {
    if (glm::any(glm::lessThan(p, low)) || glm::any(glm::greaterThan(p, high))) continue;  // strays
    const glm::dvec2 at = glm::dvec2(p[u], p[v]) - glm::dvec2(low[u], low[v]);
    outline.push_back(at);
    center += at;
    const double height = positive ? p[axis] - low[axis] : high[axis] - p[axis];
    if (height <= base_height * size()[axis]) base.push_back(at);
    if (height <= foot_height * size()[axis]) foot += at, ++feet;
  }
  if (outline.empty()) return {};
  center /= double(outline.size());
  for (const glm::dvec2& at : outline) spread += glm::dot(at - center, at - center);
  spread = std::sqrt(spread / double(outline.size()));
  Support support;
  if (feet > 0 && spread > 0) {
    const double far = glm::length(foot / feet - center);
    support.aside = far < spread ? far / spread : 1;  // also of coordinates whose squares are no numbers
  }
  if (base.size() < 3) return support;
  const std::vector<glm::dvec2> polygon = hull_of(base);
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 edge = polygon[(i + 1) % polygon.size()] - polygon[i], way = center - polygon[i];
    if (!(edge.x * way.y - edge.y * way.x > 0)) return support;
  }
  const double all = area_of(hull_of(outline));
  if (all > 0) support.base = area_of(polygon) / all;
  return support;
}

/// The plane of three points, tilted by 40 degrees at most, that most others are near (Fischler and Bolles
/// 1981). Where a quarter of them are, so many tries find it with 1 - (1 - 0.25^3)^300 = 99 %.
struct Plane {
  dvec3 up, place;
  std::ptrdiff_t near = 0;
};
Plane plane_of(const std::vector<const dvec3*>& points, const dvec3& straight, double reach) {
  constexpr double upright = 0.77;  // cos 40 degrees
  std::mt19937 random(5);           // the same every time
  Plane best{straight, dvec3(0)};
  for (int tries = 0; tries < 300; ++tries) {
    const dvec3 &a = *points[random() % points.size()], &b = *points[random() % points.size()],
                &c = *points[random() % points.size()];
    const dvec3 normal = glm::cross(b - a, c - a);
    const double length = glm::length(normal), along = glm::dot(normal, straight);
    if (!(std::abs(along) > upright * length)) continue;
    const dvec3 up = normal / (along > 0 ? length : -length);
    const std::ptrdiff_t near = std::count_if(
        points.begin(), points.end(), [&](const dvec3* p) { return std::abs(glm::dot(*p - a, up)) < reach; });
    if (near > best.near) best = {up, a, near};
  }
  return best;
}

/// Of the columns along an axis, the share that end below on one plane, tilted by 40 degrees at most,
/// weighted by how broad that side is and by how much more lies above the plane than below: a floor and land
/// reach everywhere below what stands on them, statues have a base, and the other end is as rough as what
/// stands; the legs and the top of a table are in line from its side, but fill little of it. Nothing for
/// tubes, seen from their end, and for boxes.
Sample::Stand Sample::stands(UpAxis way) const {
  const dvec3 extent = glm::max(size(), dvec3(1e-300)), straight = up_vector(way);
  const int axis = int(way) / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
  const bool positive = int(way) % 2 == 0;
  if (!(glm::length(size()) > 0)) return {0, straight};
  const Ends ends = ends_along(axis);
  if (extent[axis] > 2 * std::max(extent[u], extent[v]) && ends.both > closed_columns) return {0, straight};
  if (is_box()) return {0, straight};
  const int across = columns_across();
  const auto column = [&](const dvec3& p) {
    const dvec3 at = glm::clamp(place(p), dvec3(0), dvec3(0.9999));
    return std::size_t(int(at[u] * across) * across + int(at[v] * across));
  };
  std::vector<const dvec3*> last(std::size_t(across * across), nullptr);
  for (const dvec3& p : points) {
    if (glm::any(glm::lessThan(p, low)) || glm::any(glm::greaterThan(p, high))) continue;  // strays
    const dvec3*& here = last[column(p)];
    if (!here || (positive ? p[axis] < (*here)[axis] : p[axis] > (*here)[axis])) here = &p;
  }
  std::erase(last, nullptr);
  const double reach = on_plane * glm::length(extent);
  const auto [up, place_on, most_near] = plane_of(last, straight, reach);
  std::vector<unsigned> sides(std::size_t(across * across));
  for (const dvec3& p : points) {
    const double height = glm::dot(p - place_on, up);
    sides[column(p)] |= (height > 2 * reach ? 1u : 0u) | (height < -2 * reach ? 2u : 0u);
  }
  const auto columns_with = [&](unsigned side) {
    return double(std::count_if(sides.begin(), sides.end(), [&](unsigned s) { return (s & side) != 0; }));
  };
  // The legs of a table are in one column of a hundred.
  const double above = columns_with(1), below = columns_with(2), few = 0.1 * double(last.size());
  const double share = double(most_near) / double(last.size()) * broadness(axis);
  return {share * (above - below) / (above + below + few), up};
}

/// The direction along which points are spread much farther than across it, as those of a statue or a tower
/// are, within 45 degrees of `straight`; else 0.
dvec3 length_of(const std::vector<const dvec3*>& points, const dvec3& straight) {
  constexpr double much = 2.5, upright = 0.707;  // of standard deviations; cos 45 degrees
  dvec3 mean(0);
  for (const dvec3* p : points) mean += *p / double(points.size());
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  for (const dvec3* p : points) {
    const dvec3 d = *p - mean;
    const Eigen::Vector3d v(d.x, d.y, d.z);
    squares += v * v.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(squares);
  const Eigen::Vector3d longest = solver.eigenvectors().col(2);
  const dvec3 along(longest[0], longest[1], longest[2]);
  const double rise = glm::dot(along, straight);
  if (!(solver.eigenvalues()[2] > much * much * solver.eigenvalues()[1])) return dvec3(0);
  return std::abs(rise) > upright ? (rise > 0 ? along : -along) : dvec3(0);
}

/// The way up from what the columns along an axis end on, where a plane that a quarter of all points are
/// near says the same, which knows nothing of ends. Otherwise along the length of all, or 0. By cameras such
/// planes err by 7 degrees, axes by 19 (docs/measurements/first_view.md).
dvec3 Sample::ground(UpAxis up, const Stand& stand) const {
  constexpr double agree = 0.985, least = 0.25;  // cos 10 degrees
  constexpr std::size_t fewest = 500, sampled = 4'000;
  std::vector<const dvec3*> some;
  const std::size_t stride = points.size() / sampled + 1;
  for (std::size_t i = 0; i < points.size(); i += stride)
    if (!glm::any(glm::lessThan(points[i], low)) && !glm::any(glm::greaterThan(points[i], high)))
      some.push_back(&points[i]);
  if (some.size() < fewest || !(glm::length(size()) > 0)) return dvec3(0);
  const Plane plane = plane_of(some, up_vector(up), on_plane * glm::length(size()));
  const bool is_certain =
      double(plane.near) >= least * double(some.size()) && glm::dot(plane.up, stand.up) > agree;
  return is_certain ? stand.up : length_of(some, up_vector(up));
}

Stands stands_of(const Sample& sample, Progress& progress) {
  Stands stands;
  for (std::size_t i = 0; i < stands.size(); ++i) {
    progress.check();
    stands[i] = sample.stands(UpAxis(i));
  }
  return stands;
}

std::vector<UpCandidate> candidates_of(const PointCloud& cloud, const Sample& sample, const Stands& stands,
                                       Progress& progress) {
  const std::optional<UpAxis> room = sample.up_in_room();
  // Depth cameras look along z with y down, renderers along -z with y up, robots along x with z up. What
  // faces -z where the file has normals was seen by a depth camera too: nothing that one walks on faces down.
  std::array<double, 6> camera{};
  const bool colored = !cloud.colors.empty();
  const Sample::Picture ahead =
      cloud.up == UpAxis::pos_z ? sample.seen_along(0, true, false) : Sample::Picture{};
  // Who has -Y for convention says nothing new by that.
  const bool photographed = cloud.up != UpAxis::neg_y && are_of_photographs(cloud.colors);
  Sample::Picture before = sample.seen_along(2, true, colored, photographed);
  const Sample::Picture behind = sample.seen_along(2, false, colored);
  before.seen = std::max(before.seen, ramp(-sample.mean_normal.z, 0.4, 0.5));
  camera[int(UpAxis::pos_z)] = ahead.seen;
  camera[int(UpAxis::pos_y)] = behind.seen - behind.turned + before.turned;
  camera[int(UpAxis::neg_y)] = before.seen - before.turned + behind.turned;
  const bool by_photographs = cloud.up == UpAxis::neg_y;  // COLMAP, splats, depth images
  const dvec3 lidar =
      cloud.scanners.size() == 1 && std::isfinite(cloud.scanners[0].x) ? cloud.scanners[0] : dvec3(0);
  std::array<double, 3> turned{}, looked_down{};
  if (cloud.scanners.size() <= 1 && !by_photographs)
    for (int axis = 0; axis < 3; ++axis) {
      turned[std::size_t(axis)] = sample.turned_about(lidar, axis);
      if (turned[std::size_t(axis)] > 0) looked_down[std::size_t(axis)] = sample.looked_down(lidar, axis);
    }
  // What a picture shows is cut by its frame and faces the camera, and the lines of a lidar are no surfaces:
  // that is no evidence any more.
  const double whole = (1 - std::max({ahead.seen, before.seen, behind.seen})) *
                       (1 - *std::max_element(turned.begin(), turned.end()));
  // Where Z is the convention, what is thin along y is a wall, unless none is so high: maps of LOAM have y up
  // (Zhang and Singh 2014).
  constexpr double highest_wall = 100;  // metres
  const bool is_wall = cloud.up == UpAxis::pos_z && sample.size().z < highest_wall;
  const double wall = is_wall ? sample.lies(1) : 0;
  const dvec3 lies(0, is_wall ? 0 : sample.lies(1), sample.lies(2));
  std::vector<UpCandidate> candidates;
  double grounded = 0;  // how surely any way
  for (const Sample::Stand& stand : stands) grounded = std::max(grounded, stand.sure);
  const Facets facets(sample.points, sample.normals, sample.low, sample.high);
  const bool is_box = sample.is_box();
  const Bounds box = bounds_of_most(cloud);
  const bool is_model = cloud.provenance == Provenance::model;
  double all = 0;
  for (int i = 0; i < 6; ++i) {
    progress.check();
    const UpAxis up = UpAxis(i);
    candidates.push_back({up, {}, 0});
    const int axis = i / 2;
    const dvec3 way = up_vector(up);
    const bool positive = i % 2 == 0;
    const auto set = [&](UpEvidence what, double value) {
      candidates.back().evidence[std::size_t(what)] = value;
    };
    const double unseen = 1 - camera[std::size_t(i)];  // what a camera explains is not unusual
    set(UpEvidence::y_for_z, unseen * (cloud.up == UpAxis::pos_z && up == UpAxis::pos_y));
    set(UpEvidence::z_for_y, cloud.up == UpAxis::pos_y && up == UpAxis::pos_z);
    set(UpEvidence::z_in_obj, is_model && cloud.up == UpAxis::pos_y && up == UpAxis::pos_z);
    const bool rare = (axis == 0 || up == UpAxis::neg_z) && up != cloud.up;
    set(UpEvidence::down, unseen * (!rare && (up == UpAxis::neg_y) != (cloud.up == UpAxis::neg_y)));
    set(UpEvidence::rare, rare);
    set(UpEvidence::camera, camera[std::size_t(i)]);
    // Those of a shell, a face or half a head, point to its front.
    set(UpEvidence::normals, whole * std::max(lies.y, lies.z) * glm::dot(sample.mean_normal, way));
    const Sample::Support support = sample.support(axis, positive);
    // Land stands on no base: not at a straight border, and not on the tops of its trees; and the lowest
    // place of tilted ground is no foot.
    set(UpEvidence::base, whole * (1 - std::max(lies.y, lies.z)) * support.base);
    // What photographs reconstruct is a place, and stands on no foot.
    set(UpEvidence::aside, by_photographs ? 0 : whole * (1 - grounded) * support.aside);
    set(UpEvidence::lies, whole * lies[axis]);
    set(UpEvidence::stands, whole * 0.5 * (stands[std::size_t(i)].sure - stands[std::size_t(i ^ 1)].sure));
    set(UpEvidence::room, room && *room == up ? whole : 0);
    set(UpEvidence::mirrored, whole * (1 - lies[axis]) * sample.mirrored_across(axis));
    // On tilted ground what is level is across its plane, as surely as that is the ground.
    const Sample::Stand& stand = stands[std::size_t(i)];
    const Facing surface = facets.facing(way, stand.up, std::max(stand.sure, 0.0));
    set(UpEvidence::level, is_box ? 0 : whole * (axis == 1 ? 1 - wall : 1) * surface.level);
    set(UpEvidence::plumb, whole * surface.plumb);
    set(UpEvidence::faces_up, whole * surface.ahead);
    set(UpEvidence::reaches, whole * sample.ends_along(axis).fullest);
    set(UpEvidence::lidar, turned[std::size_t(axis)]);
    if (turned[std::size_t(axis)] > 0) {
      const double down = (positive ? 1 : -1) * looked_down[std::size_t(axis)];
      const Facets::Level level = facets.level_about(lidar, way);
      const double ground = std::lerp(level.below, down < 0 ? -1 : 1, std::abs(down) / 3);
      const double beneath =
          level.usually > 0 ? sample.beneath(lidar, ground < 0 ? -way : way, level.usually) : 0;
      set(UpEvidence::ground, turned[std::size_t(axis)] * ground * (1 - beneath));
    }
    set(UpEvidence::placed, whole * placed(box, up));
    double score = 0;
    for (std::size_t k = 0; k < std::size(weights); ++k) score += weights[k] * candidates.back().evidence[k];
    candidates.back().probability = std::exp(score);
    all += candidates.back().probability;
  }
  for (UpCandidate& candidate : candidates) candidate.probability /= all;
  std::sort(candidates.begin(), candidates.end(),
            [](const UpCandidate& a, const UpCandidate& b) { return a.probability > b.probability; });
  return candidates;
}

/// Of coordinates of a map that names no system: two are eastings and northings, which have six digits in the
/// metres of any national grid (its zones begin 100 km from their origin, so that none is negative), and the
/// third lies between the deepest and the highest land. No thing is measured from 100 km away.
std::optional<UpAxis> height_of_map_coordinates(const PointCloud& cloud) {
  constexpr double smallest_easting = 1e5, deepest = -500, highest = 9000;
  const Bounds box = robust_bounds(cloud);
  const auto plan = [&](int axis) {
    return box.min[axis] >= smallest_easting || box.max[axis] <= -smallest_easting;
  };
  const auto height = [&](int axis) { return box.min[axis] >= deepest && box.max[axis] <= highest; };
  if (plan(0) && plan(1) && height(2)) return UpAxis::pos_z;
  if (plan(0) && plan(2) && height(1)) return UpAxis::pos_y;
  return {};
}

}  // namespace

std::vector<UpCandidate> up_candidates(const PointCloud& cloud, Progress& progress) {
  progress.check();
  const Sample sample(cloud);
  return candidates_of(cloud, sample, stands_of(sample, progress), progress);
}

dvec3 up_from_ground(const PointCloud& cloud, UpAxis up) {
  const Sample sample(cloud);
  return sample.ground(up, sample.stands(up));
}

Upright guess_upright(const PointCloud& cloud, Progress& progress) {
  constexpr std::size_t fewest = 100;
  Upright upright{cloud.up, "the convention of its format"};
  if (cloud.size() < fewest) return upright;
  if (cloud.las) return upright;
  const auto says = [&](UpAxis up, const char* reason) {
    upright.up = up, upright.reason = reason;
    if (cloud.up != up) upright.other = cloud.up;
    return upright;
  };
  if (!cloud.crs.empty()) return says(UpAxis::pos_z, "heights of its coordinate system");
  if (const auto up = height_of_map_coordinates(cloud)) return says(*up, "heights of map coordinates");
  progress.check();
  const Sample sample(cloud);
  if (sample.points.size() < fewest) return upright;
  const Stands stands = stands_of(sample, progress);
  const std::vector<UpCandidate> candidates = candidates_of(cloud, sample, stands, progress);
  const UpCandidate &best = candidates[0], &next = candidates[1];
  upright.up = best.up;
  const bool is_of_pictures =
      cloud.up == UpAxis::neg_y || best.evidence[std::size_t(UpEvidence::camera)] > 0.5;
  if (is_of_pictures && up_vector(best.up).y != 0)
    upright.vertical = sample.ground(best.up, stands[std::size_t(best.up)]);
  // Why it is not the convention, or not the next.
  const UpCandidate& over =
      best.up == cloud.up ? next : *std::find_if(candidates.begin(), candidates.end(), [&](const auto& each) {
        return each.up == cloud.up;
      });
  const auto gain = [&](std::size_t i) { return weights[i] * (best.evidence[i] - over.evidence[i]); };
  std::size_t why = std::size_t(UpEvidence::camera);
  for (std::size_t i = why; i < std::size(weights); ++i)
    if (gain(i) > gain(why)) why = i;
  if (best.up != cloud.up || gain(why) > 1) upright.reason = words[why];
  if (best.probability < sure) upright.reason = "guessed: " + upright.reason, upright.other = next.up;
  if (best.up != cloud.up) upright.other = cloud.up;
  return upright;
}

}  // namespace sfumato::analysis
