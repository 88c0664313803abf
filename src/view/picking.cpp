#include "view/picking.h"

#include "core/units.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "core/classes.h"
#include "view/controls.h"

namespace sfumato::view {
namespace {

struct Candidate {
  double depth, distance2;
  std::size_t index;
};

std::string fixed(double value, int decimals) {
  char text[400];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

}  // namespace

std::optional<std::size_t> nearest_point(const PointCloud& cloud, const Camera& camera, double x_px,
                                         double y_px, double reach_px, double depth_share,
                                         const std::optional<Room>& room, std::span<const Batch> batches) {
  const dmat4 view = camera.view(cloud.origin);
  const Intrinsics k = camera.intrinsics();
  const bool parallel = camera.orthographic();
  const Cut cut = room ? cut_before(*room, camera) : Cut{};
  std::vector<Candidate> near;
  double front = std::numeric_limits<double>::infinity();
  const auto look_at = [&](std::size_t first, std::size_t count) {
    for (std::size_t i = first; i < first + count; ++i) {
      const dvec3 eye(view * glm::dvec4(dvec3(cloud.positions[i]), 1));
      const double depth = -eye.z;
      if (!parallel && !(depth > 0)) continue;
      const double w = parallel ? 1 : depth;
      const double dx = k.cx + k.fx * eye.x / w - x_px, dy = k.cy - k.fy * eye.y / w - y_px;
      const double distance2 = dx * dx + dy * dy;
      if (distance2 > reach_px * reach_px || (!cut.empty() && is_cut(cut, cloud.world(i)))) continue;
      near.push_back({depth, distance2, i});
    }
  };
  // The sides of a square around the cursor are planes through the eye: a box outside one of them is out of
  // reach. Half a pixel is for rounding.
  const double reach = reach_px + 0.5;
  const auto may_reach = [&](const Batch& batch) {
    glm::dvec4 most(-std::numeric_limits<double>::infinity());
    for (const dvec3& place : batch.box().corners()) {
      const dvec3 eye(view * glm::dvec4(place, 1));
      const double w = parallel ? 1 : -eye.z;
      const double dx = (k.cx - x_px) * w + k.fx * eye.x, dy = (k.cy - y_px) * w - k.fy * eye.y;
      most = glm::max(most, glm::dvec4(reach * w - dx, reach * w + dx, reach * w - dy, reach * w + dy));
    }
    return glm::all(glm::greaterThanEqual(most, glm::dvec4(0)));
  };
  if (batches.empty()) look_at(0, cloud.size());
  for (const Batch& batch : batches)
    if (may_reach(batch)) look_at(batch.first, batch.count);
  if (near.empty()) return std::nullopt;
  // The surface in front: the nearest depth near the cursor, and those the view's scale allows to be of the
  // same surface.
  for (const Candidate& each : near) front = std::min(front, each.depth);
  const double behind = depth_share * (parallel ? camera.height_world : front);
  const Candidate* best = nullptr;
  for (const Candidate& each : near)
    if (each.depth <= front + behind && (!best || each.distance2 < best->distance2 ||
                                         (each.distance2 == best->distance2 && each.depth < best->depth)))
      best = &each;
  return best->index;
}

Picked describe(const PointCloud& cloud, std::size_t index, const std::vector<std::string>& file_names) {
  Picked out;
  out.index = index;
  out.source = cloud.source_index.empty() ? index : cloud.source_index[index];
  out.world = cloud.world(index);
  const auto say = [&](const std::string& name, const std::string& value) {
    out.attributes.emplace_back(name, value);
  };
  if (!cloud.colors.empty()) {
    const Rgba8 c = cloud.colors[index];
    say("rgb", c == no_color ? "none"
                             : std::to_string(c.r) + ", " + std::to_string(c.g) + ", " + std::to_string(c.b));
  }
  for (const ScalarField& field : cloud.scalars) {
    const double value = field.value(index);
    std::string text = number_text(float(value));
    if (field.offset != 0) text = number_text(value);
    if (field.name == "classification") text += " (" + class_name(int(value)) + ")";
    if (field.name == "file" && value >= 1 && std::size_t(value) <= file_names.size())
      text = file_names[std::size_t(value) - 1];
    say(field.name, text);
  }
  if (!cloud.radii.empty()) say("radius", number_text(cloud.radii[index]));
  if (!cloud.normals.empty()) {
    const vec3 n = cloud.normals[index];
    say("normal", fixed(double(n.x), 3) + ", " + fixed(double(n.y), 3) + ", " + fixed(double(n.z), 3));
  }
  return out;
}

Measure measure(const dvec3& from, const dvec3& to, UpAxis up) {
  const dvec3 way = to - from;
  Measure out;
  out.distance = glm::length(way);
  out.height = glm::dot(way, up_vector(up));
  out.horizontal = glm::length(way - out.height * up_vector(up));
  return out;
}

int decimals_of(double scene_size) {
  // A hundred-thousandth of the scene is less than anybody points at.
  return std::clamp(5 - int(std::floor(std::log10(std::max(scene_size, 1e-12)))), 0, 9);
}

std::string coordinate_text(double value, double scene_size) { return fixed(value, decimals_of(scene_size)); }

std::string unit_of(const std::string& crs) { return horizontal_unit(crs).symbol; }

}  // namespace sfumato::view
