// The oracle of everything that draws splats: all hits of a pixel by brute force, in double precision, sorted
// along the ray. A technique is a short fold over that list. Rays and planes are taken in world space, discs
// by two tangents; the shaders work in eye space relative to the centre.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/camera.h"
#include "core/image.h"
#include "core/point_cloud.h"

namespace sfumato::testing {

struct OracleSplat {
  dvec3 center{0}, normal{0};  // world
  double radius = 0;
  dvec3 color{0};  // linear
  double shadow = 1, field = 0;
  std::size_t source = 0;
};

struct OracleHit {
  double t = 0;      // distance along the ray
  double rho = 0;    // 0 centre, 1 rim
  double depth = 0;  // eye depth
  std::size_t splat = 0;
};

inline double linear_of(std::uint8_t code) {
  const double c = code / 255.0;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

/// One splat a point, in the order of the cloud; radii limited, then scaled.
inline std::vector<OracleSplat> oracle_splats(const PointCloud& cloud, double radius_scale = 1,
                                              double radius_limit = std::numeric_limits<double>::infinity()) {
  std::vector<OracleSplat> splats(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    OracleSplat& s = splats[i];
    s.center = cloud.world(i);
    if (!cloud.normals.empty()) s.normal = glm::normalize(dvec3(cloud.normals[i]));
    s.radius = std::min(double(cloud.radii[i]), radius_limit) * radius_scale;
    const Rgba8 c = cloud.colors[i];
    s.color = {linear_of(c.r), linear_of(c.g), linear_of(c.b)};
    s.source = cloud.source_index.empty() ? i : cloud.source_index[i];
  }
  return splats;
}

struct OracleRay {
  dvec3 origin, direction;  // world, direction unit
  double cosine;            // eye depth = cosine * t (+ 0: the origin lies in the plane of the eye)
};

inline OracleRay oracle_ray(const Camera& camera, double x, double y) {
  const Intrinsics k = camera.intrinsics();
  const dmat4 back = camera.inverse_view();
  const dvec3 right(back[0]), up(back[1]), ahead(-dvec3(back[2])), eye(back[3]);
  const double a = (x - k.cx) / k.fx, b = -(y - k.cy) / k.fy;
  if (camera.orthographic()) return {eye + a * right + b * up, ahead, 1};
  const dvec3 d = ahead + a * right + b * up;
  return {eye, glm::normalize(d), 1 / glm::length(d)};
}

/// Hits nearer than this are not drawn (see shaders/splat.glsl).
inline double splat_near(const Camera& camera) { return 1e-4 * camera.far_plane; }

/// All hits of the ray, nearest first, equal distances by source index. `fragile`, when given, is set where
/// one of the rims passes within `margin` (in rho) of the ray, so that float may decide otherwise.
inline std::vector<OracleHit> oracle_hits(const OracleRay& ray, const std::vector<OracleSplat>& splats,
                                          double near_plane, bool* fragile = nullptr, double margin = 1e-3) {
  std::vector<OracleHit> hits;
  for (std::size_t i = 0; i < splats.size(); ++i) {
    const OracleSplat& s = splats[i];
    const double facing = glm::dot(s.normal, ray.direction);
    if (facing == 0) continue;
    const double t = glm::dot(s.center - ray.origin, s.normal) / facing;
    const dvec3 away = ray.origin + t * ray.direction - s.center;
    const dvec3 helper = std::abs(s.normal.x) < 0.6 ? dvec3(1, 0, 0) : dvec3(0, 1, 0);
    const dvec3 u = s.radius * glm::normalize(glm::cross(helper, s.normal));
    const dvec3 v = s.radius * glm::normalize(glm::cross(s.normal, u));
    const double rho = std::hypot(glm::dot(u, away) / glm::dot(u, u), glm::dot(v, away) / glm::dot(v, v));
    if (t * ray.cosine < near_plane) continue;
    // A disc seen almost edge-on moves more under rounding: its rim in the image is 1/|facing| sharper.
    if (fragile && std::abs(rho - 1) < margin / std::min(1.0, 10 * std::abs(facing))) *fragile = true;
    if (rho < 1) hits.push_back({t, rho, t * ray.cosine, i});
  }
  std::sort(hits.begin(), hits.end(), [&](const OracleHit& a, const OracleHit& b) {
    return a.t != b.t ? a.t < b.t : splats[a.splat].source < splats[b.splat].source;
  });
  return hits;
}

inline double wendland(double rho) { return std::pow(1 - rho, 4) * (4 * rho + 1); }
inline double gaussian(double rho) { return std::exp(-rho * rho / (2 * 0.316)); }

/// What the three passes of Botsch 2005 leave in a pixel.
struct OracleSurface {
  double weight = 0;  // 0: background
  dvec3 color{0}, normal{0};
  double t = 0, depth = std::numeric_limits<double>::infinity(), shadow = 1;
  bool fragile = false;
};

/// Where the nearest hits around a pixel are farther: in the picture to the right and up, world, of any
/// length; 0 where nobody asks. Discs seen from more than 70 degrees aside turn their normals there, for they
/// know no inside.
struct OracleDeeper {
  dvec3 way{0};
  bool fragile = false;
};

template <class Weight>
OracleSurface oracle_surface(const OracleRay& ray, const std::vector<OracleSplat>& splats, double near_plane,
                             double epsilon, Weight weight, const OracleDeeper& deeper = {}) {
  OracleSurface out;
  const std::vector<OracleHit> hits = oracle_hits(ray, splats, near_plane, &out.fragile);
  dvec3 normal(0);
  double t = 0, shadow = 0;
  for (const OracleHit& hit : hits) {
    const double behind = hit.t - hits.front().t - epsilon;
    if (std::abs(behind) < 1e-3 * epsilon) out.fragile = true;
    if (behind >= 0) continue;
    const OracleSplat& s = splats[hit.splat];
    const double w = weight(hit.rho);
    out.weight += w;
    out.color += w * s.color;
    const double cosine = glm::dot(s.normal, ray.direction);
    dvec3 turned = cosine > 0 ? -s.normal : s.normal;
    if (deeper.way != dvec3(0) && std::abs(cosine) < 0.35) {
      const double along = glm::dot(deeper.way, turned);
      if (deeper.fragile || std::abs(along) < 2e-3 * epsilon) out.fragile = true;
      if (along < 0) turned = -turned;
    }
    if (std::abs(std::abs(cosine) - 0.35) < 1e-3) out.fragile = true;
    normal += w * turned;
    t += w * hit.t;
    shadow += w * s.shadow;
  }
  if (out.weight > 0) {
    out.color /= out.weight;
    normal -= std::max(0.0, glm::dot(normal, ray.direction)) * ray.direction;
    out.normal = glm::normalize(normal);
    out.t = t / out.weight;
    out.depth = out.t * ray.cosine;
    out.shadow = shadow / out.weight;
  }
  return out;
}

struct OracleImages {
  Image<vec4> color;
  Image<float> depth;
  Image<vec3> normal;
  Image<std::uint8_t> band;
};

/// The whole picture, unlit; `fold` turns a ray into an OracleSurface.
template <class Fold>
OracleImages oracle_images(const Camera& camera, Fold fold) {
  const int w = camera.width, h = camera.height;
  OracleImages out{Image<vec4>(w, h), Image<float>(w, h), Image<vec3>(w, h), Image<std::uint8_t>(w, h)};
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const OracleSurface s = fold(oracle_ray(camera, x + 0.5, y + 0.5));
      out.color.at(x, y) = s.weight > 0 ? vec4(vec3(s.color), 1) : vec4(0);
      out.depth.at(x, y) = float(s.depth);
      out.normal.at(x, y) = vec3(s.normal);
      out.band.at(x, y) = s.fragile;
    }
  return out;
}

}  // namespace sfumato::testing
