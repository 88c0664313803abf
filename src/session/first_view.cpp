#include "session/first_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "core/error.h"
#include "core/param.h"
#include "session/connected.h"

namespace sfumato {

Compass::Compass(UpAxis axis)
    : up(up_vector(axis)),
      front(std::abs(up.y) > 0.5 ? dvec3(0, 0, 1) : dvec3(0, -1, 0)),
      right(glm::cross(up, front)) {}

double Compass::azimuth(const dvec3& from) const {
  return std::atan2(glm::dot(from, right), glm::dot(from, front));
}

double Compass::elevation(const dvec3& from) const {
  return std::asin(std::clamp(glm::dot(from, up), -1.0, 1.0));
}

dvec3 Compass::from(double azimuth, double elevation) const {
  return std::cos(elevation) * (std::cos(azimuth) * front + std::sin(azimuth) * right) +
         std::sin(elevation) * up;
}

// The formula of Rodrigues for the angle between them.
glm::dmat3 turn_between(const dvec3& from, const dvec3& to) {
  const dvec3 v = glm::cross(from, to);
  const glm::dmat3 cross(0, v.z, -v.y, -v.z, 0, v.x, v.y, -v.x, 0);  // columns
  return glm::dmat3(1) + cross + cross * cross * (1 / (1 + glm::dot(from, to)));
}

void stand_on(Camera& camera, UpAxis axis, const dvec3& vertical) {
  const glm::dmat3 turn = turn_between(up_vector(axis), vertical);
  camera.position = camera.target + turn * (camera.position - camera.target);
  camera.up = turn * camera.up;
}

// A point at (x, y) and z towards the camera is inside when |y - y_camera| <= tan (z_camera - z), x alike.
void fit(Camera& camera, const std::vector<dvec3>& points) {
  if (std::all_of(points.begin(), points.end(), [&](const dvec3& p) { return p == points[0]; })) return;
  const dmat4 to_eye = camera.view(), to_world = camera.inverse_view();
  const double target_z = -glm::length(camera.target - camera.position);
  const double tan_y = std::tan(0.5 * camera.fov_y) * filled_share,
               tan_x = tan_y * camera.width / camera.height;
  const double slope_x = camera.orthographic() ? 0 : tan_x, slope_y = camera.orthographic() ? 0 : tan_y;
  double left = -1e300, right = -1e300, bottom = -1e300, top = -1e300;
  std::vector<dvec3> seen;
  seen.reserve(points.size());
  for (const dvec3& world : points) {
    const dvec3 p(to_eye * glm::dvec4(world, 1));
    seen.push_back(p);
    right = std::max(right, p.x + slope_x * p.z);
    left = std::max(left, -p.x + slope_x * p.z);
    top = std::max(top, p.y + slope_y * p.z);
    bottom = std::max(bottom, -p.y + slope_y * p.z);
  }
  dvec3 eye(0.5 * (right - left), 0.5 * (top - bottom), 0);
  if (camera.orthographic()) {
    camera.height_world =
        std::max({top + bottom, (right + left) * camera.height / camera.width, 1e-9}) / filled_share;
  } else {
    eye.z = std::max({0.5 * (right + left) / tan_x, 0.5 * (top + bottom) / tan_y, 0.95 * target_z});
  }
  if (!camera.orthographic()) {
    // Where one direction decides the distance, the margins of the other are made equal on the screen, not in
    // the scene: what is near moves more.
    for (int axis : {0, 1}) {
      double low = eye[axis] - (axis == 0 ? tan_x : tan_y) * std::abs(target_z), high = 2 * eye[axis] - low;
      for (int step = 0; step < 24; ++step) {
        const double middle = 0.5 * (low + high);
        double over = -1e300, under = -1e300;
        for (const dvec3& p : seen) {
          const double slope = (p[axis] - middle) / (eye.z - p.z);
          over = std::max(over, slope), under = std::max(under, -slope);
        }
        (over > under ? low : high) = middle;
      }
      eye[axis] = 0.5 * (low + high);
    }
  }
  camera.position = dvec3(to_world * glm::dvec4(eye, 1));
  camera.target = dvec3(to_world * glm::dvec4(eye.x, eye.y, target_z, 1));
}

NamedView find_view(std::string_view wanted, const std::string& who) {
  // The front is what azimuth 0 shows; iso sees three sides of a cube at equal angles (atan(1 / sqrt 2)).
  static constexpr NamedView views[] = {{"front", 0, 0},
                                        {"back", 180, 0},
                                        {"left", -90, 0},
                                        {"right", 90, 0},
                                        {"top", 0, 90},
                                        {"bottom", 0, -90},
                                        {"iso", -45, 35.26438968275465}};
  std::vector<std::string> names;
  std::string all;
  for (const NamedView& view : views) {
    if (wanted == view.name) return view;
    names.push_back(view.name);
    all += (all.empty() ? "" : ", ") + names.back();
  }
  const std::string near = nearest_word(wanted, names);
  throw Error(ErrorCode::usage, who + ": '" + std::string(wanted) + "' is not one of " + all +
                                    (near.empty() ? "" : "; did you mean " + near + "?"));
}

void look_from(Camera& camera, UpAxis axis, std::optional<double> azimuth, std::optional<double> elevation,
               bool upright) {
  const Compass compass(axis);
  const dvec3 from = -camera.direction();
  const double turn = azimuth ? *azimuth : compass.azimuth(from);
  const double height = elevation ? *elevation : compass.elevation(from);
  camera.position = camera.target + compass.from(turn, height) * glm::length(camera.target - camera.position);
  // Straight down has no upright picture of its own: it is what a steep view comes to.
  if (std::abs(std::sin(height)) > 1 - 1e-12)
    camera.up = (height > 0 ? -1.0 : 1.0) * compass.from(turn, 0);
  else if (upright)
    camera.up = compass.up;
}

void magnify(Camera& camera, double factor) {
  if (camera.custom_intrinsics) {
    camera.custom_intrinsics->fx *= factor;
    camera.custom_intrinsics->fy *= factor;
  }
  camera.height_world /= factor;
  camera.fov_y = 2 * std::atan(std::tan(0.5 * camera.fov_y) / factor);
}

void roll(Camera& camera, double angle) {
  const dmat4 upright = camera.inverse_view();
  camera.up = std::cos(angle) * dvec3(upright[1]) - std::sin(angle) * dvec3(upright[0]);
}

void make_orthographic(Camera& camera) {
  if (camera.orthographic()) return;
  camera.projection = Projection::orthographic;
  camera.height_world = 2 * std::tan(0.5 * camera.fov_y) * glm::length(camera.target - camera.position);
}

namespace {

/// The points that are drawn for who looks from there, and framed.
std::vector<dvec3> drawn_for(const Camera& camera, const Subject& subject) {
  const Cut cut = subject.room ? cut_before(*subject.room, camera) : Cut{};
  std::vector<dvec3> drawn;
  for (std::size_t i = 0; i < subject.points.size(); ++i)
    if (subject.is_framed(i) && !is_cut(cut, subject.points[i])) drawn.push_back(subject.points[i]);
  return drawn.empty() ? subject.points : drawn;
}

}  // namespace

void fit(Camera& camera, const Subject& subject) { fit(camera, drawn_for(camera, subject)); }

void move_along_axes(Camera& camera, const dvec3& by) {
  const glm::dmat3 axes(camera.inverse_view());
  const dvec3 way = axes * (by * glm::length(camera.target - camera.position));
  camera.position += way, camera.target += way;
}

Subject within(const Subject& subject, const Reach& around) {
  Subject near{{}, {}, {}, {}, 1, subject.room};
  for (std::size_t i = 0; i < subject.points.size(); ++i)
    if (subject.is_framed(i) && glm::distance(subject.points[i], around.place) <= around.radius)
      near.points.push_back(subject.points[i]);
  if (near.points.empty()) return subject;
  near.box = {near.points[0], near.points[0]};
  for (const dvec3& p : near.points)
    near.box.min = glm::min(near.box.min, p), near.box.max = glm::max(near.box.max, p);
  return near;
}

namespace {

/// Where values in order that begin at `end` end, if it goes on without a gap that shows; `end` where it
/// would go on too far.
double end_without_gap(std::span<const double> beyond, double end, double extent) {
  double last = end;
  for (const double next : beyond) {
    if (std::abs(next - last) > gap_that_shows * extent) break;
    last = next;
  }
  return std::abs(last - end) > most_added * extent ? end : last;
}

}  // namespace

std::pair<glm::dvec2, glm::dvec2> slopes_of(const Subject& subject, const dvec3& eye, const dvec3& along,
                                            const dvec3& up, double beyond) {
  const dvec3 right = glm::normalize(glm::cross(along, up)), above = glm::cross(right, along);
  std::array<std::vector<double>, 2> slopes;
  for (std::size_t i = 0; i < subject.points.size(); ++i) {
    const dvec3& p = subject.points[i];
    const double depth = glm::dot(p - eye, along);
    if (!subject.is_framed(i) || !(depth > 0)) continue;
    slopes[0].push_back(glm::dot(p - eye, right) / depth);
    slopes[1].push_back(glm::dot(p - eye, above) / depth);
  }
  if (slopes[0].empty()) return {};
  glm::dvec2 low, high;
  for (int k = 0; k < 2; ++k) {
    std::vector<double>& all = slopes[std::size_t(k)];
    std::sort(all.begin(), all.end());
    const auto first = std::size_t(beyond * double(all.size() - 1)), last = all.size() - 1 - first;
    const double extent = all[last] - all[first];
    const std::vector<double> below(all.rend() - std::ptrdiff_t(first), all.rend());
    low[k] = end_without_gap(below, all[first], extent);
    high[k] = end_without_gap(std::span(all).subspan(last + 1), all[last], extent);
  }
  return {low, high};
}

void see_from(Camera& camera, const dvec3& place, const Subject& subject) {
  constexpr double widest = 3.7;  // tan 75 degrees
  const dvec3 along = camera.direction();
  const auto [low, high] = slopes_of(subject, place, along, camera.up, beyond_picture);
  const glm::dvec2 most = glm::max(-low, high);
  const double slope = std::max(most.y, most.x * camera.height / camera.width) / filled_share;
  camera.target = place + along * glm::dot(camera.target - place, along);
  camera.position = place;
  if (slope > 0) camera.fov_y = 2 * std::atan(std::min(slope, widest));
}

namespace {
/// The middle of the smallest upright cylinder around the points: its circle by Badoiu and Clarkson 2003,
/// whose radius is right to 1 %.
dvec3 middle_of_turn(const std::vector<dvec3>& points, const dvec3& up) {
  const auto height = [&](const dvec3& p) { return glm::dot(p, up); };
  const auto [low, high] = std::minmax_element(
      points.begin(), points.end(), [&](const dvec3& a, const dvec3& b) { return height(a) < height(b); });
  const double level = 0.5 * (height(*low) + height(*high));
  std::vector<dvec3> plan;
  for (const dvec3& p : points) plan.push_back(p + (level - height(p)) * up);
  dvec3 middle = plan.front();
  for (int i = 1; i <= 100; ++i) {
    dvec3 farthest = middle;
    double most = 0;
    for (const dvec3& p : plan)
      if (const double distance = glm::distance(p, middle); distance > most) most = distance, farthest = p;
    middle += (farthest - middle) / (i + 1.0);
  }
  return middle;
}
}  // namespace

void step_back(Camera& camera, const dvec3& up, const Subject& subject) {
  constexpr int sides = 24;
  constexpr double shown = 0.98;  // of the picture
  const dvec3 aside = middle_of_turn(drawn_for(camera, subject), up) - camera.target;
  camera.position += aside, camera.target += aside;
  const dvec3 way = camera.position - camera.target;
  const double before = glm::length(way);
  const double tan_y = shown * std::tan(0.5 * camera.fov_y), aspect = double(camera.width) / camera.height;
  double distance = before, height = camera.height_world;
  for (const Camera& side : orbit(camera, up, sides, 360)) {
    const dmat4 to_eye = side.view();
    for (const dvec3& world : drawn_for(side, subject)) {
      const dvec3 p(to_eye * glm::dvec4(world, 1));
      const double half = std::max(std::abs(p.y), std::abs(p.x) / aspect);
      distance = std::max(distance, half / tan_y + p.z + before);
      height = std::max(height, 2 * half / shown);
    }
  }
  if (camera.orthographic())
    camera.height_world = height;
  else
    camera.position = camera.target + distance / before * way;
}

std::vector<Camera> orbit(const Camera& start, const dvec3& up, int frames, double degrees) {
  std::vector<Camera> cameras;
  for (int i = 0; i < frames; ++i) {
    // A full turn does not repeat its first frame; an arc includes both ends.
    const bool closed = std::abs(std::fmod(degrees, 360.0)) < 1e-9;
    const double share = frames == 1 ? 0 : double(i) / (closed ? frames : frames - 1);
    const dmat4 turn = glm::rotate(dmat4(1), glm::radians(degrees * share), up);
    Camera camera = start;
    camera.position = start.target + dvec3(turn * glm::dvec4(start.position - start.target, 0));
    camera.up = dvec3(turn * glm::dvec4(start.up, 0));
    cameras.push_back(camera);
  }
  return cameras;
}

Camera interpolated(const std::vector<Camera>& keys, double place) {
  const auto key = [&](std::ptrdiff_t i) -> const Camera& {
    return keys[std::size_t(std::clamp<std::ptrdiff_t>(i, 0, std::ptrdiff_t(keys.size()) - 1))];
  };
  const std::ptrdiff_t k =
      std::min(std::ptrdiff_t(place), std::max<std::ptrdiff_t>(0, std::ptrdiff_t(keys.size()) - 2));
  const double t = place - double(k);
  const auto blend = [&](const auto& a, const auto& b, const auto& c, const auto& d) {
    return 0.5 * (2.0 * b + t * (c - a) + t * t * (2.0 * a - 5.0 * b + 4.0 * c - d) +
                  t * t * t * (3.0 * b - a - 3.0 * c + d));
  };
  Camera camera = key(k);
  camera.position = blend(key(k - 1).position, key(k).position, key(k + 1).position, key(k + 2).position);
  camera.target = blend(key(k - 1).target, key(k).target, key(k + 1).target, key(k + 2).target);
  camera.up = glm::normalize(glm::mix(key(k).up, key(k + 1).up, t));
  camera.fov_y = glm::mix(key(k).fov_y, key(k + 1).fov_y, t);
  camera.height_world = glm::mix(key(k).height_world, key(k + 1).height_world, t);
  return camera;
}

std::vector<Camera> interpolate(const std::vector<Camera>& keys, int frames) {
  std::vector<Camera> cameras;
  for (int i = 0; i < frames; ++i)
    cameras.push_back(
        interpolated(keys, frames == 1 ? 0 : double(i) / (frames - 1) * double(keys.size() - 1)));
  return cameras;
}

std::vector<dvec3> scanners_of(const PointCloud& cloud) {
  std::vector<dvec3> places;
  const auto add = [&](const dvec3& place) {
    if (std::isfinite(place.x) && std::find(places.begin(), places.end(), place) == places.end())
      places.push_back(place);
  };
  for (const dvec3& scanner : cloud.scanners) add(scanner);
  for (const Grid& grid : cloud.grids)
    if (grid.viewpoint) add(*grid.viewpoint);
  return places;
}

namespace {

/// Adds to a part what is above it without a gap that shows: of the tops of trees and towers a scanner on the
/// ground sees few points, but they are one with the rest for whoever looks. Noise above land has no end.
void add_tops(std::span<const dvec3> points, const dvec3& up, Connected& part) {
  const dvec3 level = 1.0 - glm::abs(up);
  const auto is_over = [&](const dvec3& p) {
    return glm::all(glm::greaterThanEqual(p * level, part.box.min * level)) &&
           glm::all(glm::lessThanEqual(p * level, part.box.max * level));
  };
  const auto height = [&](const dvec3& p) { return glm::dot(p, up); };
  const double bottom = std::min(height(part.box.min), height(part.box.max));
  const double old = std::max(height(part.box.min), height(part.box.max));
  std::vector<double> above;
  for (const dvec3& p : points)
    if (height(p) > old && is_over(p)) above.push_back(height(p));
  std::sort(above.begin(), above.end());
  const double top = end_without_gap(above, old, old - bottom);
  for (std::size_t i = 0; i < points.size(); ++i)
    if (height(points[i]) > old && height(points[i]) <= top && is_over(points[i])) part.members[i] = true;
  part.box.max += glm::max(up, dvec3(0)) * (top - old), part.box.min += glm::min(up, dvec3(0)) * (top - old);
}

}  // namespace

Subject subject_of(const PointCloud& cloud, bool whole, Progress& progress) {
  // What would make the frame twice as wide is outside unless it has a seventh of the points. Readers mark .2
  // higher than .12, which leaves the page empty around what many far points surround, and .35 as high, which
  // cuts sweeps (docs/measurements/first_view.md). A stray point is worth nothing.
  constexpr double gain = 0.2, gain_whole = 0.01;
  constexpr std::size_t each_counts = 100;  // of fewer, none is a stray
  const std::size_t stride = std::max<std::size_t>(1, cloud.size() / 200'000);
  std::vector<dvec3> sample;
  for (std::size_t i = 0; i < cloud.size(); i += stride) sample.push_back(cloud.world(i));
  Subject subject{bounds(cloud), {}, {}, {}, 1, {}};
  std::vector<bool> members(sample.size(), true);
  if (cloud.size() >= each_counts) {
    Connected found = connected(sample, robust_bounds(cloud), whole ? gain_whole : gain, progress);
    add_tops(sample, up_vector(cloud.up), found);
    subject.box = found.box, members = std::move(found.members);
    subject.share = double(std::count(members.begin(), members.end(), true)) / double(members.size());
  }
  const std::vector<dvec3> scanners = scanners_of(cloud);
  const std::size_t thinner = std::max<std::size_t>(1, sample.size() / 50'000);
  for (std::size_t k = 0; k < sample.size(); k += thinner) {
    const dvec3& p = sample[k];
    if (!(glm::all(glm::greaterThanEqual(p, subject.box.min)) &&
          glm::all(glm::lessThanEqual(p, subject.box.max))))
      continue;
    subject.points.push_back(p);
    subject.framed.push_back(members[k]);
    if (!cloud.normals.empty())
      subject.facing.push_back(cloud.normals[k * stride]);
    else if (scanners.size() == 1)
      subject.facing.push_back(scanners[0] == p ? vec3(0) : vec3(glm::normalize(scanners[0] - p)));
  }
  return subject;
}

}  // namespace sfumato
