#include "scene/degrees.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

namespace sfumato::scene {
namespace {

/// EPSG numbers geographic systems 4000 to 4999, but for the geocentric ones of the same datums.
bool is_geographic(const std::string& crs) {
  const auto has = [&](const char* word) { return crs.find(word) != std::string::npos; };
  if (has("GEOGCS") || has("GEOGCRS") || has("GEODCRS") || has("GEODETICCRS"))
    return !has("PROJCS") && !has("PROJCRS") && !has("PROJECTEDCRS") && !has("GEOCCS") && !has("Cartesian");
  constexpr std::string_view prefix = "EPSG:";
  if (!crs.starts_with(prefix)) return false;
  int code = 0;
  std::from_chars(crs.data() + prefix.size(), crs.data() + crs.size(), code);
  return code >= 4000 && code < 5000 && code != 4978 && code != 4936;
}

}  // namespace

std::optional<LocalMetres> degrees_of(const std::string& crs, const Bounds& box, const Bounds& middle) {
  constexpr double thinner = 1000;
  const dvec3 most = glm::max(glm::abs(box.min), glm::abs(box.max));
  const bool latitude_first = most.x <= 90 && most.y > 90 && most.y <= 180;
  if (!(most.x <= 180 && most.y <= 90) && !latitude_first) return std::nullopt;
  const bool is_known = is_geographic(crs);
  const double plan = std::max(middle.size().x, middle.size().y);
  if (!is_known && !(crs.empty() && plan > 0 && middle.size().z > thinner * plan)) return std::nullopt;
  LocalMetres local;
  local.latitude_first = latitude_first, local.by_values = !is_known;
  local.longitude = middle.center().x, local.latitude = middle.center().y;
  if (latitude_first) std::swap(local.longitude, local.latitude);
  // Radii of the meridian and of the prime vertical (Snyder 1987, Eqs. 4-18 and 4-20).
  constexpr double a = 6378137, e2 = 0.00669437999014, degree = std::numbers::pi / 180;
  const double sine = std::sin(local.latitude * degree), w2 = 1 - e2 * sine * sine;
  local.north = degree * a * (1 - e2) / (w2 * std::sqrt(w2));
  local.east = degree * a * std::cos(local.latitude * degree) / std::sqrt(w2);
  if (!(local.east > 1)) return std::nullopt;  // at a pole
  return local;
}

std::optional<LocalMetres> degrees_of(const PointCloud& cloud) {
  if (cloud.empty() || cloud.up != UpAxis::pos_z) return std::nullopt;
  return degrees_of(cloud.crs, bounds(cloud), robust_bounds(cloud));
}

dvec3 LocalMetres::moved(const dvec3& degrees) const {
  const double x = latitude_first ? degrees.y : degrees.x, y = latitude_first ? degrees.x : degrees.y;
  return {(x - longitude) * east, (y - latitude) * north, degrees.z};
}

Bounds LocalMetres::moved(const Bounds& degrees) const { return {moved(degrees.min), moved(degrees.max)}; }

void LocalMetres::apply(PointCloud& cloud) const {
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
  const UpAxis up = cloud.up;
  transform(cloud, metres);
  cloud.up = up;
  cloud.normals = std::move(normals), cloud.radii = std::move(radii);
  cloud.crs.clear();
}

std::string LocalMetres::note() const {
  char text[320];
  std::snprintf(
      text, sizeof text,
      "x and y are degrees (%s): drawn in metres around %.6f %s %.6f %s, %.1f km a degree east and %.1f km "
      "north; sfumato info gives the file's numbers",
      by_values ? "by their values; the file names no coordinate system" : "by the coordinate system",
      std::abs(latitude), latitude < 0 ? "S" : "N", std::abs(longitude), longitude < 0 ? "W" : "E",
      east / 1000, north / 1000);
  return text;
}

}  // namespace sfumato::scene
