#include "scene/degrees.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

namespace sfumato::scene {
namespace {

constexpr double semi_major = 6378137, e2 = 0.00669437999014;  // WGS 84

dvec3 outwards(double longitude, double latitude) {
  const double l = glm::radians(longitude), p = glm::radians(latitude);
  return {std::cos(p) * std::cos(l), std::cos(p) * std::sin(l), std::sin(p)};
}

dvec3 from_centre(double longitude, double latitude, double height) {
  const dvec3 up = outwards(longitude, latitude);
  const double vertical = semi_major / std::sqrt(1 - e2 * up.z * up.z);
  return {(vertical + height) * up.x, (vertical + height) * up.y, (vertical * (1 - e2) + height) * up.z};
}

/// From the centre of the Earth to metres east, north and up around a middle.
dmat4 to_local(double longitude, double latitude, double height) {
  const dvec3 up = outwards(longitude, latitude), east = glm::normalize(dvec3(-up.y, up.x, 0));
  const glm::dmat3 axes = glm::transpose(glm::dmat3(east, glm::cross(up, east), up));
  dmat4 moved(axes);
  moved[3] = glm::dvec4(dvec3(0, 0, height) - axes * from_centre(longitude, latitude, height), 1);
  return moved;
}

/// By its kind of system, or EPSG 4978 and 4936, of WGS 84 and ETRS89.
bool is_geocentric(const std::string& crs) {
  const auto has = [&](const char* word) { return crs.find(word) != std::string::npos; };
  return has("GEOCCS") || crs == "EPSG:4978" || crs == "EPSG:4936" ||
         ((has("GEODCRS") || has("GEODETICCRS")) && has("Cartesian"));
}

/// EPSG numbers geographic systems 4000 to 4999, and the geocentric ones of the same datums.
bool is_geographic(const std::string& crs) {
  if (is_geocentric(crs)) return false;
  const auto has = [&](const char* word) { return crs.find(word) != std::string::npos; };
  if (has("GEOGCS") || has("GEOGCRS") || has("GEODCRS") || has("GEODETICCRS"))
    return !has("PROJCS") && !has("PROJCRS") && !has("PROJECTEDCRS") && !has("Cartesian");
  constexpr std::string_view prefix = "EPSG:";
  if (!crs.starts_with(prefix)) return false;
  int code = 0;
  std::from_chars(crs.data() + prefix.size(), crs.data() + crs.size(), code);
  return code >= 4000 && code < 5000;
}

}  // namespace

std::optional<LocalMetres> degrees_of(const std::string& crs, const Bounds& box, const Bounds& middle) {
  constexpr double thinner = 1000;
  const bool is_known = is_geographic(crs);
  const double farthest_east = is_known ? 360 : 180;  // some count on from 180 E
  const dvec3 most = glm::max(glm::abs(box.min), glm::abs(box.max));
  const bool latitude_first = most.x <= 90 && most.y > 90 && most.y <= farthest_east;
  if (!(most.x <= farthest_east && most.y <= 90) && !latitude_first) return std::nullopt;
  const double plan = std::max(middle.size().x, middle.size().y);
  if (!is_known && !(crs.empty() && plan > 0 && middle.size().z > thinner * plan)) return std::nullopt;
  LocalMetres local;
  local.latitude_first = latitude_first, local.by_values = !is_known;
  local.longitude = middle.center().x, local.latitude = middle.center().y;
  if (latitude_first) std::swap(local.longitude, local.latitude);
  // Radii of the meridian and of the prime vertical (Snyder 1987, Eqs. 4-18 and 4-20).
  constexpr double a = semi_major, degree = std::numbers::pi / 180;
  const double sine = std::sin(local.latitude * degree), w2 = 1 - e2 * sine * sine;
  local.north = degree * a * (1 - e2) / (w2 * std::sqrt(w2));
  local.east = degree * a * std::cos(local.latitude * degree) / std::sqrt(w2);
  if (!(local.east > 1)) return std::nullopt;  // at a pole
  return local;
}

std::optional<LocalMetres> geocentric_of(const std::string& crs, const Bounds& middle) {
  constexpr double highest_land = 9000, lowest = -500, highest_flight = 15'000;
  const bool is_known = is_geocentric(crs);
  const dvec3 place = middle.center();
  // Writers name the system of degrees that geocentric places belong to.
  const bool is_open = crs.empty() || is_geographic(crs);
  if (!is_known && !(is_open && glm::all(glm::greaterThan(glm::abs(place), dvec3(highest_land)))))
    return std::nullopt;
  // Bowring's first step (1976): within a millimetre of latitude up to ten kilometres.
  const double across = std::hypot(place.x, place.y), shrunk = std::sqrt(1 - e2);
  if (!(across > 0)) return std::nullopt;  // at a pole
  const double reduced = std::atan2(place.z, across * shrunk),
               latitude = std::atan2(place.z + e2 / shrunk * semi_major * std::pow(std::sin(reduced), 3),
                                     across - e2 * semi_major * std::pow(std::cos(reduced), 3)),
               sine = std::sin(latitude);
  LocalMetres local;
  local.geocentric = true, local.by_values = !is_known;
  local.longitude = glm::degrees(std::atan2(place.y, place.x)), local.latitude = glm::degrees(latitude);
  local.height = across * std::cos(latitude) + place.z * sine - semi_major * std::sqrt(1 - e2 * sine * sine);
  if (!(local.height > lowest && local.height < highest_flight)) return std::nullopt;
  return local;
}

std::optional<LocalMetres> local_metres_of(const std::string& crs, const Bounds& box, const Bounds& middle) {
  const std::optional<LocalMetres> geocentric = geocentric_of(crs, middle);
  return geocentric ? geocentric : degrees_of(crs, box, middle);
}

std::optional<LocalMetres> local_metres_of(const PointCloud& cloud) {
  if (cloud.empty()) return std::nullopt;
  const Bounds middle = robust_bounds(cloud);
  if (cloud.up == UpAxis::pos_z) return local_metres_of(cloud.crs, bounds(cloud), middle);
  return geocentric_of(cloud.crs, middle);
}

dvec3 LocalMetres::moved(const dvec3& degrees) const {
  if (geocentric) return dvec3(to_local(longitude, latitude, height) * glm::dvec4(degrees, 1));
  const double x = latitude_first ? degrees.y : degrees.x, y = latitude_first ? degrees.x : degrees.y;
  return {(x - longitude) * east, (y - latitude) * north, degrees.z};
}

Bounds LocalMetres::moved(const Bounds& degrees) const {
  Bounds box{moved(degrees.min), moved(degrees.min)};
  for (const dvec3& corner : degrees.corners()) {
    const dvec3 at = moved(corner);
    box.min = glm::min(box.min, at), box.max = glm::max(box.max, at);
  }
  return box;
}

void LocalMetres::apply(PointCloud& cloud) const {
  if (geocentric) {
    transform(cloud, to_local(longitude, latitude, height));
    cloud.up = UpAxis::pos_z, cloud.up_is_known = true;
    cloud.crs.clear();
    return;
  }
  // Normals and radii are metric already.
  std::vector<vec3> normals = std::exchange(cloud.normals, {});
  std::vector<float> radii = std::exchange(cloud.radii, {});
  dmat4 metres(1);
  if (latitude_first) {
    metres[0] = {0, north, 0, 0};
    metres[1] = {east, 0, 0, 0};
  } else {
    metres[0].x = east, metres[1].y = north;
  }
  metres[3] = glm::dvec4(moved(dvec3(0)), 1);
  transform(cloud, metres);
  cloud.up = UpAxis::pos_z, cloud.up_is_known = true;
  cloud.normals = std::move(normals), cloud.radii = std::move(radii);
  cloud.crs.clear();
}

namespace {

std::string of_wide_steps(const PointCloud& degrees, const LocalMetres& metres) {
  constexpr double least = 100;  // a scan has thousands
  if (!degrees.las || !(degrees.las->scale.x > 0 && degrees.las->scale.y > 0)) return {};
  const dvec3 places = glm::round(bounds(degrees).size() / degrees.las->scale) + 1.0;
  if (std::max(places.x, places.y) >= least) return {};
  const double step = std::max(degrees.las->scale.x, degrees.las->scale.y);
  char text[200];
  std::snprintf(
      text, sizeof text,
      "; the file keeps them in steps of %g degrees, %.0f m, which leave %.0f x %.0f places of the plan: "
      "convert the original with a finer scale",
      step, step * std::max(metres.east, metres.north), places.x, places.y);
  return text;
}

}  // namespace

std::string LocalMetres::note(const PointCloud& degrees) const {
  char text[320];
  const double from_greenwich = std::remainder(longitude, 360);
  if (geocentric) {
    std::snprintf(
        text, sizeof text,
        "places are metres from the centre of the Earth (%s): drawn in metres east, north and up around "
        "%.6f %s %.6f %s; sfumato info gives the file's numbers",
        !by_values            ? "by the coordinate system"
        : degrees.crs.empty() ? "by their values; the file names no coordinate system"
                              : "by their values, which are no degrees",
        std::abs(latitude), latitude < 0 ? "S" : "N", std::abs(from_greenwich),
        from_greenwich < 0 ? "W" : "E");
    return text;
  }
  std::snprintf(
      text, sizeof text,
      "x and y are degrees (%s): drawn in metres around %.6f %s %.6f %s, %.1f km a degree east and %.1f km "
      "north; sfumato info gives the file's numbers",
      by_values ? "by their values; the file names no coordinate system" : "by the coordinate system",
      std::abs(latitude), latitude < 0 ? "S" : "N", std::abs(from_greenwich), from_greenwich < 0 ? "W" : "E",
      east / 1000, north / 1000);
  return text + of_wide_steps(degrees, *this);
}

}  // namespace sfumato::scene
