#include "session/standpoint.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "analysis/sensor_view.h"

namespace sfumato {
namespace {

/// Height over the side of a square of the same ground: below the first all lies flat, above the second it
/// stands.
constexpr double lies = 0.35, stands = 0.8;
/// Of land what is seen grows with the elevation up to 45 degrees, and no more beyond.
constexpr double elevation_lying = 45, elevation_standing = 14;
/// A view's score is half the logarithm of the share of a page of 16 to 9 that it fills, and twice that of
/// what it shows of the area, less twice the share of that which faces away, less, for what stands, what it
/// costs to look from another side than the front (most from the opposite one) or from farther above, as into
/// an open room. By the labels of public scans (good sides, whether from above) half and twice each weight
/// are as good.
constexpr double weight_seen = 2, weight_into = 0.3;
/// How much more a cutaway must show of what it does not leave out than any whole view from as far above:
/// rooms have 1.27 to 1.5, a sweep below a roof 1.12, layers of noise 1 (docs/measurements/first_view.md).
constexpr double gain_least = 1.2;

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
  std::vector<bool> framed;
};

Area area_of(const Subject& subject) {
  const double edges = std::clamp(std::sqrt(double(subject.points.size())) / 2, 8.0, 100.0);
  Area area{subject.box, subject.box.diagonal() / edges, {}, {}, {}};
  if (!(area.edge > 0)) return area;
  std::vector<std::pair<std::uint64_t, std::size_t>> keys;  // of a point its voxel, 21 bits an axis
  for (std::size_t i = 0; i < subject.points.size(); ++i) {
    const dvec3 at = glm::floor((subject.points[i] - area.box.min) / area.edge);
    keys.emplace_back(std::uint64_t(at.x) << 42 | std::uint64_t(at.y) << 21 | std::uint64_t(at.z), i);
  }
  std::sort(keys.begin(), keys.end());
  for (std::size_t first = 0, last; first < keys.size(); first = last) {
    dvec3 facing(0);
    bool framed = false;
    for (last = first; last < keys.size() && keys[last].first == keys[first].first; ++last) {
      if (!subject.facing.empty()) facing += dvec3(subject.facing[keys[last].second]);
      framed = framed || subject.is_framed(keys[last].second);
    }
    const std::uint64_t key = keys[first].first;
    const dvec3 at(double(key >> 42), double(key >> 21 & 0x1fffff), double(key & 0x1fffff));
    area.voxels.push_back(area.box.min + area.edge * (at + 0.5));
    area.framed.push_back(framed);
    area.facing.push_back(glm::length(facing) > 0 ? glm::normalize(facing) : facing);
  }
  return area;
}

Camera camera_at(const Bounds& box, UpAxis up, const Standpoint& from) {
  return frame(box, up, 16 * 80, 9 * 80, glm::radians(from.azimuth_deg), glm::radians(from.elevation_deg));
}

/// Which voxels no other one hides in a small depth picture from far off; of a room, through the walls before
/// it.
std::vector<bool> seen_of(const Area& area, const Camera& camera, double cell_edges,
                          const Room* room = nullptr) {
  if (area.voxels.empty()) return {};  // all in one place
  const Cut cut = room ? cut_before(*room, camera) : Cut{};
  const dmat4 to_eye = camera.view();
  // As deep as a surface that is seen aslant is in a cell.
  const double cell = cell_edges * area.edge, behind = 3 * area.edge;
  const int across = int(area.box.diagonal() / cell) + 3;
  std::vector<double> nearest(std::size_t(across) * std::size_t(across), nothing);
  const auto place = [&](const dvec3& p) {
    return std::size_t(std::clamp(int(p.y / cell + across / 2.0), 0, across - 1)) * std::size_t(across) +
           std::size_t(std::clamp(int(p.x / cell + across / 2.0), 0, across - 1));
  };
  std::vector<dvec3> at;
  for (const dvec3& world : area.voxels) {
    at.push_back(is_cut(cut, world) ? dvec3(0, 0, 2 * nothing) : dvec3(to_eye * glm::dvec4(world, 1)));
    double& here = nearest[place(at.back())];
    here = std::max(here, at.back().z);
  }
  std::vector<bool> seen;
  for (const dvec3& p : at) seen.push_back(p.z > std::max(nothing, nearest[place(p)] - behind));
  return seen;
}

double score_of(const Area& area, UpAxis up, const Standpoint& from, const Room* room) {
  constexpr int columns = 32, rows = 18;  // coarse enough for a few thousand points to fill
  constexpr double edge_on = 0.1;         // sine of 6 degrees, which normals are not sure to
  constexpr double next_edges = 1.2;      // wider than a voxel
  Camera camera = camera_at(area.box, up, from);
  const std::vector<bool> seen = seen_of(area, camera, next_edges, room);
  std::vector<dvec3> shown, framed;
  std::size_t away = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (!seen[i]) continue;
    shown.push_back(area.voxels[i]);
    if (area.framed[i]) framed.push_back(area.voxels[i]);
    away += glm::dot(area.facing[i], camera.direction()) > edge_on;
  }
  if (shown.empty()) return nothing;
  fit(camera, framed.empty() ? shown : framed);
  const dmat4 to_page = camera.projection_matrix() * camera.view();
  std::bitset<std::size_t(columns * rows)> cells;
  for (const dvec3& world : shown) {
    const glm::dvec4 p = to_page * glm::dvec4(world, 1);
    cells.set(std::size_t(std::clamp(int((p.y / p.w + 1) * rows / 2), 0, rows - 1) * columns +
                          std::clamp(int((p.x / p.w + 1) * columns / 2), 0, columns - 1)));
  }
  const double count = double(shown.size());
  return 0.5 * std::log(double(cells.count()) / (columns * rows)) +
         weight_seen * (std::log(count / double(seen.size())) - double(away) / count);
}

/// A lattice leaves no circle of 0.71 edges empty, so walls have no gaps.
constexpr double closed_edges = 1.5;

/// Whether a cutaway shows clearly more than the best view from as far above of what it does not leave out.
bool reveals(const Area& area, UpAxis up, const Standpoint& into, const Room& room) {
  const Cut cut = cut_before(room, camera_at(area.box, up, into));
  const auto seen_from = [&](const Standpoint& from, const Room* through) {
    const std::vector<bool> seen = seen_of(area, camera_at(area.box, up, from), closed_edges, through);
    std::size_t count = 0;
    for (std::size_t i = 0; i < seen.size(); ++i) count += seen[i] && !is_cut(cut, area.voxels[i]);
    return double(count);
  };
  double most = 0;
  for (int side = 0; side < 12; ++side)
    most = std::max(most, seen_from({30.0 * side, elevation_lying}, nullptr));
  return seen_from(into, &room) > gain_least * most;
}

/// From one of twelve sides, at one of the elevations: a front that stands `upright` is not left for little.
Standpoint best_of(const Area& area, UpAxis up, const std::vector<double>& elevations, double front,
                   double upright, const Room* room = nullptr) {
  Standpoint best{std::remainder(front, 360), elevations.front()};
  double most = nothing;
  for (const double elevation : elevations)
    for (int turn = 0; turn < 12; ++turn) {
      const Standpoint from{std::remainder(front + 30 * turn, 360), elevation};
      const double score =
          score_of(area, up, from, room) - upright * (1 - std::cos(glm::radians(30.0 * turn)) +
                                                      (elevation > elevations.front() ? weight_into : 0));
      if (score > most + 1e-9) most = score, best = from;
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
  const dmat4 to_eye = camera_at(subject.box, up, from).view();
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

/// The side of which most relief is seen at an elevation: the first harmonic over the mean.
dvec3 relief_side(const Subject& subject, UpAxis up, double elevation_deg) {
  constexpr int turns = 12;
  const Compass compass(up);
  dvec3 side(0);
  double sum = 0;
  if (!(subject.box.diagonal() > 0)) return side;  // all in one place
  for (double azimuth_deg = 0; azimuth_deg < 360; azimuth_deg += 360 / turns) {
    const double seen = relief_of(subject, up, {azimuth_deg, elevation_deg});
    sum += seen;
    side += 2 * seen * compass.from(glm::radians(azimuth_deg), 0);
  }
  return sum > 0 ? side / sum : side;
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

bool is_lying(const Bounds& box, UpAxis up) { return height_over_width(box, up) < lies; }

Standpoint standpoint_for(Subject& subject, UpAxis up) {
  const double upright = std::clamp((height_over_width(subject.box, up) - lies) / (stands - lies), 0.0, 1.0);
  const Area area = area_of(subject);
  if (subject.room) {  // as a rule over the corner of two walls
    const std::vector<glm::dvec4>& walls = subject.room->outside;
    const double first = walls.empty() ? 0 : glm::degrees(Compass(up).azimuth(dvec3(walls[0])));
    const Standpoint into = best_of(area, up, {elevation_lying}, first - 30, 0, &*subject.room);
    if (reveals(area, up, into, *subject.room)) return into;
    subject.room.reset();
  }
  std::vector<double> elevations = {std::lerp(elevation_lying, elevation_standing, upright)};
  if (upright > 0 && upright < 1) elevations.push_back(elevation_lying);
  // Land has no front.
  const dvec3 relief = upright > 0 ? relief_side(subject, up, elevations[0]) : dvec3(0);
  return best_of(area, up, elevations, front_of(area, up, relief), upright);
}

namespace {

/// Whether all was seen from the origin on a grid of pixels, along a coordinate axis that is level: a picture
/// however noisy its depths are, as those of stereo. Or, in the axes of a camera, is framed as an image or,
/// with colours, lies before it, as what photographs saw lies before the first.
bool is_of_camera(const PointCloud& cloud, const Subject& subject, const dvec3& up) {
  constexpr double widest = 2;  // a lens of 90 degrees
  for (const dvec3& axis : {dvec3(1, 0, 0), dvec3(0, 1, 0), dvec3(0, 0, 1)})
    for (const double sign : {-1.0, 1.0}) {
      if (glm::dot(axis, up) != 0) continue;
      const analysis::SensorView seen = analysis::sensor_view_of(subject.points, dvec3(0), sign * axis, up);
      const bool is_optical = axis.z != 0 && up.y != 0;
      if (seen.is_narrow()) continue;
      const bool of_photographs = seen.ahead && seen.width < widest && !cloud.colors.empty();
      if (seen.of_pixels || (is_optical && (of_photographs || is_image(seen) > 0.5))) return true;
    }
  return false;
}

}  // namespace

std::optional<Sensor> sensor_of(const PointCloud& cloud, const Subject& subject) {
  constexpr double steepest = 0.9;  // sine: of what is seen from above or below, the view is another
  const std::vector<dvec3> places = scanners_of(cloud);
  const bool is_known = !places.empty();
  if (places.size() > 1 || subject.points.empty()) return std::nullopt;
  const dvec3 up = up_vector(cloud.up);
  const bool of_camera = !is_known && is_of_camera(cloud, subject, up);
  if (!is_known && !of_camera && (cloud.las || is_lying(subject.box, cloud.up))) return std::nullopt;
  Sensor sensor{is_known ? places[0] : dvec3(0), dvec3(0)};
  sensor.along = analysis::mean_direction(subject.points, sensor.place);
  if (sensor.along == dvec3(0)) return std::nullopt;
  if (std::abs(glm::dot(sensor.along, up)) > steepest) return std::nullopt;
  if (!of_camera) {
    const analysis::SensorView seen =
        analysis::sensor_view_of(subject.points, sensor.place, sensor.along, up);
    if (is_one_picture(seen) < 0.5 || (!is_known && seen.is_narrow())) return std::nullopt;
  }
  for (int step = 0; step < 3; ++step) {  // to the middle of what appears
    const auto [low, high] = slopes_of(subject, sensor.place, sensor.along, up, beyond_picture);
    const dvec3 right = glm::normalize(glm::cross(sensor.along, up));
    const glm::dvec2 turn = glm::tan(0.5 * (glm::atan(low) + glm::atan(high)));
    sensor.along = glm::normalize(sensor.along + turn.x * right + turn.y * glm::cross(right, sensor.along));
  }
  return sensor;
}

dvec3 place_inside(const PointCloud& cloud) {
  const std::vector<dvec3> places = scanners_of(cloud);
  return places.empty() ? bounds(cloud).center() : places[0];
}

}  // namespace sfumato
