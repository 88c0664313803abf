#include "session/standpoint.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <limits>
#include <vector>

#include "analysis/sight.h"
#include "session/voxels.h"

namespace sfumato {
namespace {

/// Height over the side of a square of the same ground: below the first all lies flat, above the second it
/// stands.
constexpr double lies = 0.35, stands = 0.8;
constexpr double elevation_lying = 32, elevation_standing = 14, elevation_amid = 50, elevation_room = 55;
/// By how much another side must fill more of the picture than the custom one.
constexpr double gain = 1.12;
constexpr int columns = 32, rows = 18;  // coarse enough for a few thousand points to fill
/// How many times as many points one must see from `elevation_amid` for walls before the camera to be looked
/// over: 0.7 to 1.2 for objects, up to 1.5 for land, 1.9 for a room without a ceiling.
constexpr double gain_from_above = 1.6;
/// Where hills and roofs hide a part of the area, and from `elevation_amid` less than a share of that: 0.3
/// and 0.46 of a village on hills and of a pit, of which a quarter is hidden; of other scans of which a fifth
/// is, 0.55 along a power line, 0.65 of a park, 0.75 and more of forests, streets and objects.
constexpr double hides_much = 0.2, leaves_hidden = 0.5;
/// The share of the surface that a cutaway must reveal: one voxel in fifty, where rooms have 4 to 17.
constexpr double revealed_least = 0.02;
/// What lies this share of the subject's size behind the nearest point of its cell is hidden.
constexpr double hidden_behind = 0.04;

double height_over_width(const Bounds& box, UpAxis up) {
  const dvec3 size = box.size(), axis = glm::abs(up_vector(up));
  double area = 1;
  for (int k = 0; k < 3; ++k)
    if (axis[k] < 0.5) area *= size[k];
  return area > 0 ? glm::dot(size, axis) / std::sqrt(area) : stands;
}

/// Calls `take(column, row, eye depth)` for the points that a picture of so many columns and rows holds.
template <class Take>
void for_each_in_picture(const Subject& subject, UpAxis up, const Standpoint& from, int wide, int high,
                         const Take& take) {
  Camera camera = frame(subject.box, up, 16 * 80, 9 * 80, glm::radians(from.azimuth_deg),
                        glm::radians(from.elevation_deg));
  const std::vector<glm::dvec4> walls =
      subject.room ? walls_before(*subject.room, camera) : std::vector<glm::dvec4>();
  fit(camera, subject);
  const dmat4 to_eye = camera.view();
  const double tan_y = std::tan(0.5 * camera.fov_y), tan_x = tan_y * camera.width / camera.height;
  for (const dvec3& world : subject.points) {
    if (is_behind(walls, world)) continue;
    const dvec3 p(to_eye * glm::dvec4(world, 1));
    const int x = int((p.x / (-p.z * tan_x) + 1) * 0.5 * wide),
              y = int((p.y / (-p.z * tan_y) + 1) * 0.5 * high);
    if (p.z < 0 && x >= 0 && y >= 0 && x < wide && y < high) take(x, y, -p.z);
  }
}

/// The share of the picture's cells that hold a point.
double filled(const Subject& subject, UpAxis up, const Standpoint& from) {
  std::bitset<std::size_t(columns * rows)> cells;
  for_each_in_picture(subject, up, from, columns, rows,
                      [&](int x, int y, double) { cells.set(std::size_t(y * columns + x)); });
  return double(cells.count()) / (columns * rows);
}

/// The share of the points that no other one hides.
double visible(const Subject& subject, UpAxis up, const Standpoint& from) {
  // Cells as wide as a few points are apart, so that surfaces hide what lies behind.
  const int high = std::clamp(int(std::sqrt(double(subject.points.size()) / 16)), 9, 60),
            wide = high * 16 / 9;
  const double behind = hidden_behind * subject.box.diagonal();
  std::vector<double> nearest(std::size_t(wide * high), std::numeric_limits<double>::infinity());
  for_each_in_picture(subject, up, from, wide, high, [&](int x, int y, double depth) {
    double& here = nearest[std::size_t(y * wide + x)];
    here = std::min(here, depth);
  });
  std::size_t seen = 0, all = 0;
  for_each_in_picture(subject, up, from, wide, high, [&](int x, int y, double depth) {
    ++all, seen += depth < nearest[std::size_t(y * wide + x)] + behind;
  });
  return all > 0 ? double(seen) / double(all) : 1;
}

/// A subject's surface by its area: the middles of the voxels that hold points. On a square as wide as the
/// scan each would hold four.
struct Area {
  Bounds box;
  std::vector<dvec3> voxels;
  double edge = 0;
};

Area area_of(const Subject& subject) {
  const double edges = std::clamp(std::sqrt(double(subject.points.size())) / 2, 8.0, 100.0);
  Area area{subject.box, {}, subject.box.diagonal() / edges};
  if (!(area.edge > 0)) return area;
  Voxels all(area.box.min, area.edge);
  for (const dvec3& p : subject.points) all.add(p);
  for (const dvec3& middle : all.holding(1)) area.voxels.push_back(area.box.min + area.edge * middle);
  return area;
}

/// The voxels that no other one hides, seen from far off; of a room, through the walls before it.
std::vector<bool> seen_of(const Area& area, UpAxis up, const Standpoint& from, double cell_edges,
                          const Room* room = nullptr) {
  const Camera camera =
      frame(area.box, up, 16 * 80, 9 * 80, glm::radians(from.azimuth_deg), glm::radians(from.elevation_deg));
  const std::vector<glm::dvec4> walls = room ? walls_before(*room, camera) : std::vector<glm::dvec4>();
  const dmat4 to_eye = camera.view();
  // As deep as a surface that is seen aslant is in a cell.
  const double cell = cell_edges * area.edge, behind = 3 * area.edge;
  std::vector<bool> free(area.voxels.size());
  if (area.voxels.empty()) return free;
  const int across = int(area.box.diagonal() / cell) + 3;
  std::vector<double> nearest(std::size_t(across) * std::size_t(across), -1e300);
  const auto place = [&](const dvec3& p) {
    return std::size_t(std::clamp(int(p.y / cell + across / 2.0), 0, across - 1)) * std::size_t(across) +
           std::size_t(std::clamp(int(p.x / cell + across / 2.0), 0, across - 1));
  };
  std::vector<dvec3> at;
  for (const dvec3& world : area.voxels) {
    at.push_back(is_behind(walls, world) ? dvec3(0, 0, -1e301) : dvec3(to_eye * glm::dvec4(world, 1)));
    double& here = nearest[place(at.back())];
    here = std::max(here, at.back().z);
  }
  for (std::size_t i = 0; i < at.size(); ++i)
    free[i] = at[i].z > nearest[place(at[i])] - behind && at[i].z > -1e300;
  return free;
}

double share(const std::vector<bool>& seen) {
  return seen.empty() ? 1 : double(std::count(seen.begin(), seen.end(), true)) / double(seen.size());
}

/// Whether so much of the area is hidden that one looks from farther above, where that shows most of it.
bool hides_land(const Subject& subject, UpAxis up, const Standpoint& from, const Standpoint& over) {
  constexpr double wide = 1.2;  // edges: wider than a voxel
  const Area area = area_of(subject);
  const double hidden = 1 - share(seen_of(area, up, from, wide));
  return hidden > hides_much && 1 - share(seen_of(area, up, over, wide)) < leaves_hidden * hidden;
}

/// Whether a cutaway shows what no view from outside does. Of a closed body it shows none: the inside of what
/// is seen from the other side.
bool reveals(const Subject& subject, UpAxis up, const Standpoint& into) {
  constexpr double closed =
      1.5;  // edges: a lattice leaves no circle of 0.71 edges empty, so walls have no gaps
  const Area area = area_of(subject);
  std::vector<bool> hidden = seen_of(area, up, into, closed, &*subject.room);
  for (const double elevation : {elevation_lying, elevation_amid})
    for (int side = 0; side < 12; ++side) {
      const std::vector<bool> seen = seen_of(area, up, {30.0 * side, elevation}, closed);
      for (std::size_t i = 0; i < seen.size(); ++i) hidden[i] = hidden[i] && !seen[i];
    }
  return share(hidden) > revealed_least;
}

/// Over the corner of two walls that leave most to be seen.
Standpoint into_room(const Subject& subject, UpAxis up) {
  const Compass compass(up);
  double first = -30;
  if (subject.room->outside.size() > 1)
    first += glm::degrees(compass.azimuth(dvec3(subject.room->outside[1])));
  Standpoint best{first, elevation_room};
  double most = -1;
  for (int side = 0; side < 4; ++side)
    for (double corner : {0.0, 60.0}) {
      const Standpoint from{std::remainder(first + 90 * side + corner, 360), elevation_room};
      const double share = filled(subject, up, from);
      if (share > most) most = share, best = from;
    }
  return best;
}

}  // namespace

Standpoint standpoint_for(Subject& subject, UpAxis up) {
  const double steep = height_over_width(subject.box, up);
  const double upright = std::clamp((steep - lies) / (stands - lies), 0.0, 1.0);
  // Amid what thins out, farther things would stand before the camera.
  if (subject.thins_out) return {-30, elevation_amid};
  if (subject.room) {
    const Standpoint into = into_room(subject, up);
    if (reveals(subject, up, into)) return into;
    subject.room.reset();
  }
  Standpoint best{-30, std::lerp(elevation_lying, elevation_standing, upright)};
  Standpoint over = best;
  over.elevation_deg = elevation_amid;
  if (upright < 1 && (visible(subject, up, over) > gain_from_above * visible(subject, up, best) ||
                      hides_land(subject, up, best, over)))
    best = over;
  if (upright > 0) return best;
  double most = gain * filled(subject, up, best);
  for (double azimuth : {30, 60, -60, 120, -120, 150, -150}) {
    const Standpoint other{azimuth, best.elevation_deg};
    const double share = filled(subject, up, other);
    if (share > most) most = share, best = other;
  }
  return best;
}

std::optional<Sensor> sensor_of(const PointCloud& cloud, const Subject& subject) {
  constexpr double steepest = 0.9;  // sine: of what is seen from above or below, the view is another
  std::vector<dvec3> places;
  for (const dvec3& scanner : cloud.scanners) places.push_back(scanner);
  for (const Grid& grid : cloud.grids)
    if (grid.viewpoint && std::find(places.begin(), places.end(), *grid.viewpoint) == places.end())
      places.push_back(*grid.viewpoint);
  const bool is_known = !places.empty();
  if (!is_known) places.push_back(dvec3(0));
  if (places.size() > 1 || !std::isfinite(places[0].x) || subject.points.empty()) return std::nullopt;
  if (!is_known && height_over_width(subject.box, cloud.up) < lies) return std::nullopt;
  Sensor sensor{places[0], dvec3(0)};
  for (const dvec3& p : subject.points)
    if (p != sensor.place) sensor.along += glm::normalize(p - sensor.place);
  const dvec3 up = up_vector(cloud.up);
  for (int step = 0; step < 4; ++step) {
    if (!(glm::length(sensor.along) > 0)) return std::nullopt;
    sensor.along = glm::normalize(sensor.along);
    if (std::abs(glm::dot(sensor.along, up)) > steepest) return std::nullopt;
    if (step == 0 &&
        analysis::is_one_picture(analysis::sight_of(subject.points, sensor.place, sensor.along, up)) < 0.5)
      return std::nullopt;
    const auto [low, high] = slopes_of(subject, sensor.place, sensor.along, up);
    const dvec3 right = glm::normalize(glm::cross(sensor.along, up));
    sensor.along += 0.5 * ((low.x + high.x) * right + (low.y + high.y) * glm::cross(right, sensor.along));
  }
  return Sensor{sensor.place, glm::normalize(sensor.along)};
}

dvec3 place_inside(const PointCloud& cloud) {
  for (const dvec3& scanner : cloud.scanners)
    if (std::isfinite(scanner.x)) return scanner;
  for (const Grid& grid : cloud.grids)
    if (grid.viewpoint) return *grid.viewpoint;
  return bounds(cloud).center();
}

}  // namespace sfumato
