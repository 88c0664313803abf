#include "isosurface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <random>
#include <stdexcept>

namespace sfumato::bench {
namespace {

using Triangle = std::array<vec3, 3>;

/// Triangles of one tetrahedron: an edge is cut where the linear interpolant passes the level.
void cut_tetrahedron(const std::array<vec3, 4>& p, const std::array<float, 4>& v, float level,
                     std::vector<Triangle>& out) {
  std::array<int, 4> order{0, 1, 2, 3};
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return v[a] < v[b]; });
  const int below = int(std::count_if(v.begin(), v.end(), [&](float x) { return x < level; }));
  auto cut = [&](int a, int b) {
    a = order[a], b = order[b];
    return glm::mix(p[a], p[b], (level - v[a]) / (v[b] - v[a]));
  };
  if (below == 1) out.push_back({cut(0, 1), cut(0, 2), cut(0, 3)});
  if (below == 3) out.push_back({cut(0, 3), cut(1, 3), cut(2, 3)});
  if (below == 2) {
    out.push_back({cut(0, 2), cut(0, 3), cut(1, 3)});
    out.push_back({cut(0, 2), cut(1, 3), cut(1, 2)});
  }
}

std::vector<Triangle> isosurface(const Volume& volume, float level) {
  // Six tetrahedra around the diagonal of a cell: neighbours share their faces' diagonals.
  constexpr int paths[6][2] = {{1, 3}, {1, 5}, {2, 3}, {2, 6}, {4, 5}, {4, 6}};
  std::vector<Triangle> triangles;
  for (int z = 0; z + 1 < volume.size; ++z)
    for (int y = 0; y + 1 < volume.size; ++y)
      for (int x = 0; x + 1 < volume.size; ++x)
        for (const auto& path : paths) {
          std::array<vec3, 4> p;
          std::array<float, 4> v;
          const int corners[4] = {0, path[0], path[1], 7};
          for (int k = 0; k < 4; ++k) {
            const int cx = x + (corners[k] & 1), cy = y + (corners[k] >> 1 & 1), cz = z + (corners[k] >> 2);
            p[std::size_t(k)] = vec3(cx, cy, cz);
            v[std::size_t(k)] = volume.at(cx, cy, cz);
          }
          cut_tetrahedron(p, v, level, triangles);
        }
  return triangles;
}

}  // namespace

float Volume::value(vec3 p) const {
  p = glm::clamp(p, vec3(0), vec3(float(size) - 1.001f));
  const int x = int(p.x), y = int(p.y), z = int(p.z);
  const vec3 f = p - vec3(x, y, z);
  auto row = [&](int dy, int dz) { return glm::mix(at(x, y + dy, z + dz), at(x + 1, y + dy, z + dz), f.x); };
  return glm::mix(glm::mix(row(0, 0), row(1, 0), f.y), glm::mix(row(0, 1), row(1, 1), f.y), f.z);
}

vec3 Volume::gradient(vec3 p) const {
  vec3 g;
  for (int axis = 0; axis < 3; ++axis) {
    vec3 step(0);
    step[axis] = 0.5f;
    g[axis] = value(p + step) - value(p - step);
  }
  return g;
}

Volume load_volume(const std::filesystem::path& folder, const std::string& name) {
  const bool bytes = name == "neghip";
  Volume volume;
  volume.size = bytes ? 66 : 64;
  const std::size_t count = std::size_t(volume.size) * volume.size * volume.size;
  std::ifstream in(folder / (bytes ? "neghip_66x66x66_uint8.raw" : "hydrogen_64x64x64_float32le.raw"),
                   std::ios::binary);
  volume.values.resize(count);
  if (bytes) {
    std::vector<std::uint8_t> raw(count);
    in.read(reinterpret_cast<char*>(raw.data()), std::streamsize(count));
    std::transform(raw.begin(), raw.end(), volume.values.begin(),
                   [](std::uint8_t v) { return float(v) / 255; });
  } else {
    in.read(reinterpret_cast<char*>(volume.values.data()), std::streamsize(count * sizeof(float)));
  }
  if (!in) throw std::runtime_error("no volume " + name + " in " + folder.string());
  return volume;
}

PointCloud sample_isosurface(const Volume& volume, float level, std::size_t count, Rgba8 color, int layer) {
  const std::vector<Triangle> triangles = isosurface(volume, level);
  std::vector<double> up_to;
  double area = 0;
  for (const Triangle& t : triangles)
    up_to.push_back(area += 0.5 * glm::length(glm::cross(t[1] - t[0], t[2] - t[0])));
  if (!(area > 0)) throw std::runtime_error("the volume has no surface at that level");
  std::mt19937_64 random{std::uint64_t(20100201 + layer)};
  std::uniform_real_distribution<double> uniform(0, 1);
  const float scale = 2 / float(volume.size - 1);
  PointCloud cloud;
  ScalarField layers{"layer", 0, std::vector<float>(count, float(layer)), StoredType::uint8};
  for (std::size_t i = 0; i < count; ++i) {
    const auto pick = std::upper_bound(up_to.begin(), up_to.end(), uniform(random) * area);
    const Triangle& t = triangles[std::min(std::size_t(pick - up_to.begin()), triangles.size() - 1)];
    float a = float(uniform(random)), b = float(uniform(random));
    if (a + b > 1) a = 1 - a, b = 1 - b;
    const vec3 p = t[0] + a * (t[1] - t[0]) + b * (t[2] - t[0]), g = volume.gradient(p);
    cloud.positions.push_back(p * scale - 1.0f);
    cloud.normals.push_back(glm::length(g) > 0 ? -glm::normalize(g) : vec3(0));
    cloud.colors.push_back(color);
  }
  cloud.set_scalar(std::move(layers));
  return cloud;
}

PointCloud isosurfaces(const std::filesystem::path& folder, const std::string& name) {
  const Volume volume = load_volume(folder, name);
  if (name == "neghip") return sample_isosurface(volume, 0.25f, 128'000, {90, 140, 200, 255}, 0);
  PointCloud cloud = sample_isosurface(volume, 0.05f, 178'000, {60, 90, 220, 255}, 0);
  append(cloud, sample_isosurface(volume, 0.2f, 178'000, {60, 190, 80, 255}, 1));
  append(cloud, sample_isosurface(volume, 0.5f, 179'000, {200, 100, 50, 255}, 2));
  return cloud;
}

}  // namespace sfumato::bench
