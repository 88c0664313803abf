#include "session/standpoint.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <limits>
#include <vector>

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

Standpoint standpoint_for(const Subject& subject, UpAxis up) {
  const double steep = height_over_width(subject.box, up);
  const double upright = std::clamp((steep - lies) / (stands - lies), 0.0, 1.0);
  // Amid what thins out, farther things would stand before the camera.
  if (subject.thins_out) return {-30, elevation_amid};
  if (subject.room) return into_room(subject, up);
  Standpoint best{-30, std::lerp(elevation_lying, elevation_standing, upright)};
  Standpoint over = best;
  over.elevation_deg = elevation_amid;
  if (upright < 1 && visible(subject, up, over) > gain_from_above * visible(subject, up, best)) best = over;
  if (upright > 0) return best;
  double most = gain * filled(subject, up, best);
  for (double azimuth : {30, 60, -60, 120, -120, 150, -150}) {
    const Standpoint other{azimuth, best.elevation_deg};
    const double share = filled(subject, up, other);
    if (share > most) most = share, best = other;
  }
  return best;
}

dvec3 place_inside(const PointCloud& cloud) {
  for (const dvec3& scanner : cloud.scanners)
    if (std::isfinite(scanner.x)) return scanner;
  for (const Grid& grid : cloud.grids)
    if (grid.viewpoint) return *grid.viewpoint;
  return bounds(cloud).center();
}

}  // namespace sfumato
