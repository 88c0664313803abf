#include "session/standpoint.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "analysis/sight.h"

namespace sfumato {
namespace {

/// Height over the side of a square of the same ground: below the first all lies flat, above the second it
/// stands.
constexpr double lies = 0.35, stands = 0.8;
constexpr double elevation_lying = 32, elevation_standing = 14, elevation_amid = 50, elevation_room = 55;
/// A view's score is the share of a picture of 16 to 9 that it fills, and twice the logarithm of what it
/// shows of the area, less twice the share of that which faces away, what it costs to look at what stands
/// from another side than the front (most from the opposite one), and to look from farther above, unless more
/// relief is seen from there, as in an open room, by its logarithm. By the labels of 48 public scans (good
/// sides, whether from above) 42 are right; half and twice each weight give 41 to 43.
constexpr double weight_seen = 2, weight_high = 0.35;
/// The share of the surface that a cutaway must reveal, which no view from outside shows: rooms have 0.6 to 8
/// %, closed bodies none.
constexpr double revealed_least = 0.005;

constexpr double nothing = -1e300;

double height_over_width(const Bounds& box, UpAxis up) {
  const dvec3 size = box.size(), axis = glm::abs(up_vector(up));
  double area = 1;
  for (int k = 0; k < 3; ++k)
    if (axis[k] < 0.5) area *= size[k];
  return area > 0 ? glm::dot(size, axis) / std::sqrt(area) : stands;
}

/// A subject's surface by its area: the middles of the voxels that hold points, and where those face. On a
/// square as wide as the scan each would hold four.
struct Area {
  Bounds box;
  double edge = 0;
  std::vector<dvec3> voxels, facing;
};

Area area_of(const Subject& subject) {
  const double edges = std::clamp(std::sqrt(double(subject.points.size())) / 2, 8.0, 100.0);
  Area area{subject.box, subject.box.diagonal() / edges, {}, {}};
  if (!(area.edge > 0)) return area;
  std::vector<std::pair<std::uint64_t, std::size_t>> keys;  // of a point its voxel, 21 bits an axis
  for (std::size_t i = 0; i < subject.points.size(); ++i) {
    const dvec3 at = glm::floor((subject.points[i] - area.box.min) / area.edge);
    keys.emplace_back(std::uint64_t(at.x) << 42 | std::uint64_t(at.y) << 21 | std::uint64_t(at.z), i);
  }
  std::sort(keys.begin(), keys.end());
  for (std::size_t first = 0, last; first < keys.size(); first = last) {
    dvec3 facing(0);
    for (last = first; last < keys.size() && keys[last].first == keys[first].first; ++last)
      if (!subject.facing.empty()) facing += dvec3(subject.facing[keys[last].second]);
    const std::uint64_t key = keys[first].first;
    const dvec3 at(double(key >> 42), double(key >> 21 & 0x1fffff), double(key & 0x1fffff));
    area.voxels.push_back(area.box.min + area.edge * (at + 0.5));
    area.facing.push_back(glm::length(facing) > 0 ? glm::normalize(facing) : facing);
  }
  return area;
}

/// What of an area a small depth picture from far off shows; of a room, through the walls before it.
struct Shown {
  std::vector<bool> voxels;   ///< that no other one hides
  double seen = 1, away = 0;  ///< shares: of all voxels those, and of those what faces away
  double filled = 0;          ///< of a picture of 16 to 9
};

Shown shown_of(const Area& area, UpAxis up, const Standpoint& from, double cell_edges,
               const Room* room = nullptr) {
  constexpr int columns = 32, rows = 18;  // coarse enough for a few thousand points to fill
  constexpr double edge_on = 0.1;         // sine of 6 degrees, which normals are not sure to
  Shown shown;
  if (area.voxels.empty()) return shown;
  const Camera camera =
      frame(area.box, up, 16 * 80, 9 * 80, glm::radians(from.azimuth_deg), glm::radians(from.elevation_deg));
  const std::vector<glm::dvec4> walls = room ? walls_before(*room, camera) : std::vector<glm::dvec4>();
  const dmat4 to_eye = camera.view();
  // As deep as a surface that is seen aslant is in a cell.
  const double cell = cell_edges * area.edge, behind = 3 * area.edge;
  const int across = int(area.box.diagonal() / cell) + 3;
  std::vector<double> nearest(std::size_t(across) * std::size_t(across), -1e300);
  const auto place = [&](const dvec3& p) {
    return std::size_t(std::clamp(int(p.y / cell + across / 2.0), 0, across - 1)) * std::size_t(across) +
           std::size_t(std::clamp(int(p.x / cell + across / 2.0), 0, across - 1));
  };
  const auto on_screen = [](const dvec3& p) { return glm::dvec2(p) / -p.z; };
  std::vector<dvec3> at;
  glm::dvec2 low(1e300), high(-1e300);
  for (const dvec3& world : area.voxels) {
    at.push_back(is_behind(walls, world) ? dvec3(0, 0, -1e301) : dvec3(to_eye * glm::dvec4(world, 1)));
    if (at.back().z < -1e300) continue;
    double& here = nearest[place(at.back())];
    here = std::max(here, at.back().z);
    low = glm::min(low, on_screen(at.back())), high = glm::max(high, on_screen(at.back()));
  }
  const double scale = std::max({(high.x - low.x) / columns, (high.y - low.y) / rows, 1e-300});
  std::bitset<std::size_t(columns * rows)> cells;
  std::size_t seen = 0, away = 0;
  shown.voxels.resize(at.size());
  for (std::size_t i = 0; i < at.size(); ++i) {
    if (at[i].z < -1e300) continue;
    const glm::dvec2 in_picture = (on_screen(at[i]) - 0.5 * (low + high)) / scale;
    cells.set(std::size_t(std::clamp(int(in_picture.y + 0.5 * rows), 0, rows - 1) * columns +
                          std::clamp(int(in_picture.x + 0.5 * columns), 0, columns - 1)));
    if (!(at[i].z > nearest[place(at[i])] - behind)) continue;
    shown.voxels[i] = true;
    ++seen, away += glm::dot(area.facing[i], camera.direction()) > edge_on;
  }
  shown.seen = double(seen) / double(at.size());
  shown.away = seen > 0 ? double(away) / double(seen) : 0;
  shown.filled = double(cells.count()) / (columns * rows);
  return shown;
}

double score_of(const Shown& shown) {
  return shown.filled + weight_seen * (std::log(std::max(shown.seen, 1e-3)) - shown.away);
}

constexpr double next_edges = 1.2;  // wider than a voxel
/// A lattice leaves no circle of 0.71 edges empty, so walls have no gaps.
constexpr double closed_edges = 1.5;

/// Whether a cutaway shows what no view from outside does, from above or below. Of a closed body it shows
/// none: the inside of what is seen from the other side.
bool reveals(const Area& area, UpAxis up, const Standpoint& into, const Room& room) {
  std::vector<bool> hidden = shown_of(area, up, into, closed_edges, &room).voxels;
  for (const double elevation : {-elevation_amid, elevation_lying, elevation_amid})
    for (int side = 0; side < 12; ++side) {
      const std::vector<bool> seen = shown_of(area, up, {30.0 * side, elevation}, closed_edges).voxels;
      for (std::size_t i = 0; i < seen.size(); ++i) hidden[i] = hidden[i] && !seen[i];
    }
  return double(std::count(hidden.begin(), hidden.end(), true)) > revealed_least * double(hidden.size());
}

/// Over the corner of two walls that leave most to be seen.
Standpoint into_room(const Area& area, UpAxis up, const Room& room) {
  double first = -30;
  if (room.outside.size() > 1) first += glm::degrees(Compass(up).azimuth(dvec3(room.outside[1])));
  Standpoint best{first, elevation_room};
  double most = -1e300;
  for (int side = 0; side < 4; ++side)
    for (double corner : {0.0, 60.0}) {
      const Standpoint from{std::remainder(first + 90 * side + corner, 360), elevation_room};
      const double score = score_of(shown_of(area, up, from, next_edges, &room));
      if (score > most) most = score, best = from;
    }
  return best;
}

/// Of a square depth picture the sum of the angles, in radians, between the normals of cells that are side by
/// side on one surface. Where nothing is seen it holds `nothing`.
double curvature_of(const std::vector<double>& depths, std::size_t across, double cell) {
  const auto joined = [&](std::size_t a, std::size_t b) {
    return std::abs(depths[a] - depths[b]) < 3 * cell;
  };
  const auto slope = [&](std::size_t here, std::size_t step) {
    const std::size_t before = joined(here, here - step) ? here - step : here,
                      after = joined(here, here + step) ? here + step : here;
    return before == after ? nothing
                           : (depths[after] - depths[before]) / (cell * double((after - before) / step));
  };
  std::vector<dvec3> normals(depths.size(), dvec3(0));
  double sum = 0;
  for (std::size_t y = 1; y + 1 < across; ++y)
    for (std::size_t x = 1; x + 1 < across; ++x) {
      const std::size_t here = y * across + x;
      if (depths[here] == nothing) continue;
      const double along_x = slope(here, 1), along_y = slope(here, across);
      if (along_x == nothing || along_y == nothing) continue;
      normals[here] = glm::normalize(dvec3(-along_x, -along_y, 1));
      for (const std::size_t other : {here - 1, here - across})
        if (normals[other] != dvec3(0) && joined(here, other))
          sum += std::acos(std::clamp(glm::dot(normals[other], normals[here]), -1.0, 1.0));
    }
  return sum;
}

/// How much relief the points show to who looks from there: the curvature of a depth picture in which eight
/// of a square as wide as the scan fall in a cell.
double relief_of(const Subject& subject, UpAxis up, const Standpoint& from) {
  const double cell =
      subject.box.diagonal() / std::clamp(std::sqrt(double(subject.points.size()) / 8), 8.0, 128.0);
  const Camera camera = frame(subject.box, up, 16 * 80, 9 * 80, glm::radians(from.azimuth_deg),
                              glm::radians(from.elevation_deg));
  const dmat4 to_eye = camera.view();
  const std::size_t across = std::size_t(subject.box.diagonal() / cell) + 4;
  std::vector<double> nearest(across * across, nothing), sums(nearest.size(), 0), counts(nearest.size(), 0);
  std::vector<std::pair<std::size_t, double>> depths;
  depths.reserve(subject.points.size());
  for (const dvec3& world : subject.points) {
    const dvec3 p(to_eye * glm::dvec4(world, 1));
    const glm::dvec2 at = glm::clamp(glm::dvec2(p) / cell + 0.5 * double(across), 0.0, double(across - 1));
    depths.emplace_back(std::size_t(at.y) * across + std::size_t(at.x), p.z);
    nearest[depths.back().first] = std::max(nearest[depths.back().first], p.z);
  }
  for (const auto& [here, depth] : depths)  // the mean of what is no farther: noise is no relief
    if (depth > nearest[here] - 2 * cell) sums[here] += depth, ++counts[here];
  for (std::size_t i = 0; i < nearest.size(); ++i)
    if (counts[i] > 0) nearest[i] = sums[i] / counts[i];
  return curvature_of(nearest, across, cell);
}

/// Relief seen from all around at an elevation.
struct Around {
  dvec3 side{0};  ///< of most: the first harmonic over the mean
  double mean = 0;
};

Around relief_around(const Subject& subject, UpAxis up, double elevation_deg) {
  constexpr int turns = 12;
  const Compass compass(up);
  Around around;
  if (!(subject.box.diagonal() > 0)) return around;  // all in one place
  for (double azimuth_deg = 0; azimuth_deg < 360; azimuth_deg += 360 / turns) {
    const double seen = relief_of(subject, up, {azimuth_deg, elevation_deg});
    around.mean += seen / turns;
    around.side += 2 * seen / turns * compass.from(glm::radians(azimuth_deg), 0);
  }
  if (around.mean > 0) around.side /= around.mean;
  return around;
}

/// Degrees. Where one side faces, as of a wall, a mask or what one scanner saw, from there: the normals of a
/// closed surface cancel, those of half a sphere have a mean of .5. Else from where clearly more relief is
/// seen, as of a face or an open arcade, and half as far to the left of that as by custom.
double front_of(const Area& area, UpAxis up, const dvec3& relief) {
  // Noise has up to .09. Of 48 labelled scans 42 are seen from a good side with anything from .04 to .14, 40
  // without.
  constexpr double clearly = 0.1, custom = glm::radians(-30.0);
  const Compass compass(up);
  dvec3 mean(0);
  for (const dvec3& facing : area.facing) mean += facing / double(area.facing.size());
  mean -= glm::dot(mean, compass.up) * compass.up;
  const double guess =
      glm::length(relief) > clearly ? compass.azimuth(glm::normalize(relief)) + 0.5 * custom : custom;
  const double doubt = std::max(0.0, 0.5 - glm::length(mean));
  return glm::degrees(compass.azimuth(mean + doubt * compass.from(guess, 0)));
}

}  // namespace

Standpoint standpoint_for(Subject& subject, UpAxis up) {
  const double upright = std::clamp((height_over_width(subject.box, up) - lies) / (stands - lies), 0.0, 1.0);
  const Area area = area_of(subject);
  if (subject.room) {
    const Standpoint into = into_room(area, up, *subject.room);
    if (reveals(area, up, into, *subject.room)) return into;
    subject.room.reset();
  }
  const double usual = std::lerp(elevation_lying, elevation_standing, upright);
  Around around;  // land has no front
  double gain_high = 0;
  if (upright > 0) {
    around = relief_around(subject, up, usual);
    if (upright < 1 && around.mean > 0)
      gain_high = (1 - upright) * std::log(relief_around(subject, up, elevation_amid).mean / around.mean);
  }
  const double front = front_of(area, up, around.side);
  Standpoint best;
  double most = -1e300;
  for (const double elevation : {usual, elevation_amid})
    for (int turn = 0; turn < 12; ++turn) {
      const Standpoint from{std::remainder(front + 30 * turn, 360), elevation};
      const double score = score_of(shown_of(area, up, from, next_edges)) -
                           upright * (1 - std::cos(glm::radians(30.0 * turn))) -
                           (elevation > usual ? weight_high - gain_high : 0);
      if (score > most + 1e-9) most = score, best = from;
    }
  return best;
}

std::optional<Sensor> sensor_of(const PointCloud& cloud, const Subject& subject) {
  constexpr double axial = 0.7;     // cosine of 45 degrees
  constexpr double steepest = 0.9;  // sine: of what is seen from above or below, the view is another
  const std::vector<dvec3> places = scanners_of(cloud);
  const bool is_known = !places.empty();
  if (places.size() > 1 || subject.points.empty()) return std::nullopt;
  if (!is_known && (cloud.las || height_over_width(subject.box, cloud.up) < lies)) return std::nullopt;
  Sensor sensor{is_known ? places[0] : dvec3(0), dvec3(0)};
  for (const dvec3& p : subject.points)
    if (p != sensor.place) sensor.along += glm::normalize(p - sensor.place);
  if (!(glm::length(sensor.along) > 0)) return std::nullopt;
  sensor.along = glm::normalize(sensor.along);
  const dvec3 up = up_vector(cloud.up);
  // Cameras look along z where y is up or down, robots along x.
  if (!is_known && !(std::abs(up.y) > 0.5 ? std::abs(sensor.along.z) > axial : sensor.along.x > axial))
    return std::nullopt;
  if (std::abs(glm::dot(sensor.along, up)) > steepest) return std::nullopt;
  if (is_one_picture(analysis::sight_of(subject.points, sensor.place, sensor.along, up)) < 0.5)
    return std::nullopt;
  for (int step = 0; step < 3; ++step) {  // to the middle of what appears
    const auto [low, high] = slopes_of(subject, sensor.place, sensor.along, up);
    const dvec3 right = glm::normalize(glm::cross(sensor.along, up));
    sensor.along += 0.5 * ((low.x + high.x) * right + (low.y + high.y) * glm::cross(right, sensor.along));
    sensor.along = glm::normalize(sensor.along);
  }
  return sensor;
}

dvec3 place_inside(const PointCloud& cloud) {
  const std::vector<dvec3> places = scanners_of(cloud);
  return places.empty() ? bounds(cloud).center() : places[0];
}

}  // namespace sfumato
