#include "synth/scene.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace sfumato::synth {
namespace {

Bounds merge(const std::vector<Bounds>& boxes) {
  Bounds all = boxes.front();
  for (const Bounds& box : boxes) all.min = glm::min(all.min, box.min), all.max = glm::max(all.max, box.max);
  return all;
}

}  // namespace

void Scene::build() {
  std::vector<Bounds> boxes;
  boxes.reserve(surface_count());
  for (const Primitive& primitive : primitives) boxes.push_back(bounds(primitive));
  for (const auto& corners : mesh.triangles) {
    const dvec3 a(mesh.positions[corners[0]]), b(mesh.positions[corners[1]]), c(mesh.positions[corners[2]]);
    boxes.push_back({glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c))});
  }
  if (boxes.empty()) return;
  box = merge(boxes);
  bvh_ = Bvh(boxes);
}

std::optional<Hit> Scene::intersect(const Ray& ray, double t_min, double t_max) const {
  double nearest = t_max;
  std::uint32_t found = 0;
  bool any = false;
  const auto consider = [&](double t, std::uint32_t surface) {
    // Coincident surfaces: the first of the list wins, whatever order the tree visits them in.
    if (t <= t_min || t > nearest || (t == nearest && !(any && surface < found))) return;
    nearest = t, found = surface, any = true;
  };
  bvh_.traverse(ray, t_min, nearest, [&](std::uint32_t surface) {
    if (surface >= primitives.size()) {
      if (const auto t = triangle_crossing(surface - primitives.size(), ray)) consider(*t, surface);
      return;
    }
    const Roots roots = crossings(primitives[surface], ray);
    for (int i = 0; i < roots.count; ++i) consider(roots.t[std::size_t(i)], surface);
  });
  if (!any) return std::nullopt;
  Hit hit{describe_surface(found, ray.origin + nearest * ray.direction)};
  hit.t = nearest;
  hit.surface = found;
  return hit;
}

std::vector<Hit> Scene::intersect_all(const Ray& ray) const {
  std::vector<Hit> hits;
  const auto add = [&](double t, std::uint32_t surface) {
    if (t <= 0) return;
    Hit hit{describe_surface(surface, ray.origin + t * ray.direction)};
    hit.t = t;
    hit.surface = surface;
    hits.push_back(hit);
  };
  const double far = std::numeric_limits<double>::infinity();
  bvh_.traverse(ray, 0, far, [&](std::uint32_t surface) {
    if (surface >= primitives.size()) {
      if (const auto t = triangle_crossing(surface - primitives.size(), ray)) add(*t, surface);
      return;
    }
    const Roots roots = crossings(primitives[surface], ray);
    for (int i = 0; i < roots.count; ++i) add(roots.t[std::size_t(i)], surface);
  });
  std::sort(hits.begin(), hits.end(),
            [](const Hit& a, const Hit& b) { return a.t != b.t ? a.t < b.t : a.surface < b.surface; });
  return hits;
}

double Scene::surface_area(std::size_t surface) const {
  if (surface < primitives.size()) return area(primitives[surface]);
  const auto& corners = mesh.triangles[surface - primitives.size()];
  const dvec3 a(mesh.positions[corners[0]]), b(mesh.positions[corners[1]]), c(mesh.positions[corners[2]]);
  return 0.5 * glm::length(glm::cross(b - a, c - a));
}

SurfacePoint Scene::sample_surface(std::size_t surface, Random& random) const {
  if (surface < primitives.size()) return sample(primitives[surface], random);
  // Uniform in a triangle: fold the unit square along its diagonal.
  double u = random.uniform(), v = random.uniform();
  if (u + v > 1) u = 1 - u, v = 1 - v;
  return describe_triangle(surface - primitives.size(), dvec3(1 - u - v, u, v));
}

vec3 Scene::surface_albedo(std::uint32_t surface, const SurfacePoint& point) const {
  if (surface < primitives.size()) return albedo(materials[primitives[surface].material], point, surface);
  if (mesh.colors.empty()) return albedo(materials.front(), point, 0);
  const std::size_t triangle = surface - primitives.size();
  const dvec3 weights = barycentric(triangle, point.position);
  vec3 color(0);
  for (int i = 0; i < 3; ++i) {
    const Rgba8 c = mesh.colors[mesh.triangles[triangle][std::size_t(i)]];
    color += float(weights[i]) * from_srgb(c.r, c.g, c.b);
  }
  return glm::clamp(color, vec3(0), vec3(1));
}

std::uint8_t Scene::surface_alpha(std::uint32_t surface) const {
  return surface < primitives.size() ? materials[primitives[surface].material].alpha : std::uint8_t(255);
}

std::uint8_t Scene::surface_class(std::uint32_t surface) const {
  return surface < primitives.size() ? primitives[surface].class_id : mesh_class;
}

SurfacePoint Scene::describe_surface(std::uint32_t surface, dvec3 position) const {
  if (surface < primitives.size()) return describe_point(primitives[surface], position);
  const std::size_t triangle = surface - primitives.size();
  return describe_triangle(triangle, barycentric(triangle, position));
}

std::optional<double> Scene::triangle_crossing(std::size_t triangle,
                                               const Ray& ray) const {  // Moeller, Trumbore 1997
  const auto& corners = mesh.triangles[triangle];
  const dvec3 a(mesh.positions[corners[0]]);
  const dvec3 e1 = dvec3(mesh.positions[corners[1]]) - a, e2 = dvec3(mesh.positions[corners[2]]) - a;
  const dvec3 p = glm::cross(ray.direction, e2);
  const double determinant = glm::dot(e1, p);
  if (determinant == 0) return std::nullopt;
  const dvec3 s = ray.origin - a, q = glm::cross(s, e1);
  const double u = glm::dot(s, p) / determinant, v = glm::dot(ray.direction, q) / determinant;
  if (u < 0 || v < 0 || u + v > 1) return std::nullopt;
  return glm::dot(e2, q) / determinant;
}

dvec3 Scene::barycentric(std::size_t triangle, dvec3 position) const {
  const auto& corners = mesh.triangles[triangle];
  const dvec3 a(mesh.positions[corners[0]]), b(mesh.positions[corners[1]]), c(mesh.positions[corners[2]]);
  const dvec3 normal = glm::cross(b - a, c - a);
  const double scale = 1 / glm::dot(normal, normal);
  const double v = scale * glm::dot(normal, glm::cross(position - a, c - a));
  const double w = scale * glm::dot(normal, glm::cross(b - a, position - a));
  return {1 - v - w, v, w};
}

SurfacePoint Scene::describe_triangle(std::size_t triangle, dvec3 weights) const {
  const auto& corners = mesh.triangles[triangle];
  SurfacePoint s;
  for (int i = 0; i < 3; ++i) {
    s.position += weights[i] * dvec3(mesh.positions[corners[std::size_t(i)]]);
    s.normal += weights[i] * dvec3(mesh_normals[corners[std::size_t(i)]]);
  }
  const double length = glm::length(s.normal);
  s.normal = length > 0 ? s.normal / length : dvec3(0, 0, 1);
  s.uv = dvec2(s.position.x, s.position.y);
  return s;
}

Scene make_mesh_scene(Mesh mesh) {
  Scene scene;
  scene.name = "mesh";
  scene.up = UpAxis::pos_y;
  scene.mesh = std::move(mesh);
  std::vector<dvec3> normals(scene.mesh.positions.size(), dvec3(0));
  double total = 0;
  for (const auto& corners : scene.mesh.triangles) {
    for (std::uint32_t corner : corners)
      if (corner >= normals.size())
        throw Error(ErrorCode::bad_input, "mesh: a triangle names vertex " + std::to_string(corner) + " of " +
                                              std::to_string(normals.size()) + "; the file is damaged");
    for (std::size_t i = 0; i < 3; ++i) {
      const dvec3 here(scene.mesh.positions[corners[i]]);
      const dvec3 to_next = dvec3(scene.mesh.positions[corners[(i + 1) % 3]]) - here;
      const dvec3 to_last = dvec3(scene.mesh.positions[corners[(i + 2) % 3]]) - here;
      const dvec3 normal = glm::cross(to_next, to_last);
      const double twice_area = glm::length(normal);
      if (!(twice_area > 0)) continue;
      total += twice_area;
      // Weighted by the corner's angle, so that the tessellation does not tilt the normal (Thuermer,
      // Wuethrich 1998).
      normals[corners[i]] += normal / twice_area * std::atan2(twice_area, glm::dot(to_next, to_last));
    }
  }
  if (!(total > 0))
    throw Error(ErrorCode::bad_input,
                "mesh: no triangle has an area, so there is nothing to sample; give a file with faces");
  scene.mesh_normals.reserve(normals.size());
  for (const dvec3& n : normals)
    scene.mesh_normals.emplace_back(glm::dot(n, n) > 0 ? glm::normalize(n) : dvec3(0, 0, 1));
  scene.build();
  Material clay{Pattern::plain, from_srgb(203, 170, 138)};
  clay.size = 0.05 * scene.box.diagonal();
  scene.materials = {clay};
  return scene;
}

}  // namespace sfumato::synth
