#include "techniques/soft/haze_depth.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace sfumato::soft {
namespace {

constexpr int columns = 32;                  // of cells across the picture's longer side
constexpr std::size_t most_points = 65'536;  // looked at; the rest count through them
constexpr double mean_depth =
    1.0 / 3;  // of a sphere over its disc, in every model and of the cone (notes of Eq. 7)
constexpr double share_of_rays = 0.95;

/// Length that [a, b] and the cell from `cell` to `cell` + 1 have in common.
double overlap(double a, double b, int cell) {
  return std::max(0.0, std::min(b, cell + 1.0) - std::max(a, double(cell)));
}

/// Appends the depth of every cell of the view.
void add_cells(const HazeSpheres& spheres, const Camera& camera, const dvec3& origin, const HazeSettings& s,
               std::vector<double>& all) {
  const auto& [positions, radii, soft, field] = spheres;
  const Intrinsics k = camera.intrinsics();
  const double cell_px = std::max(camera.width, camera.height) / double(columns);
  const int across = int(std::ceil(camera.width / cell_px)), down = int(std::ceil(camera.height / cell_px));
  std::vector<double> depths(std::size_t(across) * std::size_t(down), 0.0);
  const std::size_t step = std::max<std::size_t>(1, (soft.size() + most_points - 1) / most_points);
  const dmat4 eye_from_cloud = camera.view(origin);
  for (std::size_t slot = step / 2; slot < soft.size(); slot += step) {
    const std::uint32_t i = soft[slot];
    const dvec3 p(eye_from_cloud * glm::dvec4(dvec3(positions[i]), 1));
    if (!(-p.z > 1e-4 * camera.far_plane)) continue;
    const double scale = camera.orthographic() ? k.fx : k.fx / -p.z;
    const double x = (p.x * scale + k.cx) / cell_px, y = (k.cy - p.y * scale) / cell_px;
    const double radius = std::min(radii[i], s.radius_limit) * s.radius_scale * scale / cell_px;
    double weight = 1;
    if (s.modulation_threshold > s.field_threshold)
      weight =
          s.cone_factor + (1 - s.cone_factor) * std::clamp((double(field[i]) - s.field_threshold) /
                                                               (s.modulation_threshold - s.field_threshold),
                                                           0.0, 1.0);
    // Spread over a square of at least a cell, so that nothing jumps when it moves from one cell to the next.
    const double half = std::max(radius, 0.5);
    const double depth = weight * double(step) * mean_depth * M_PI * radius * radius / (4 * half * half);
    const int x0 = std::max(0, int(std::floor(x - half))),
              x1 = std::min(across - 1, int(std::floor(x + half)));
    const int y0 = std::max(0, int(std::floor(y - half))), y1 = std::min(down - 1, int(std::floor(y + half)));
    for (int row = y0; row <= y1; ++row)
      for (int column = x0; column <= x1; ++column)
        depths[std::size_t(row) * std::size_t(across) + std::size_t(column)] +=
            depth * overlap(x - half, x + half, column) * overlap(y - half, y + half, row);
  }
  all.insert(all.end(), depths.begin(), depths.end());
}

}  // namespace

double haze_depth(const HazeSpheres& spheres, std::span<const Camera> views, const dvec3& origin,
                  const HazeSettings& s) {
  std::vector<double> depths;
  for (const Camera& view : views) add_cells(spheres, view, origin, s, depths);
  // Cells count by the share of their rays that meet a sphere, were these placed at random.
  std::sort(depths.begin(), depths.end());
  auto met = [](double depth) { return 1 - std::exp(-depth / mean_depth); };
  double all = 0, below = 0, last = 0;
  for (double depth : depths) all += met(depth);
  for (double depth : depths) {
    // Between two cells, so that nothing jumps from the depth of one to that of the next.
    if (below + met(depth) >= share_of_rays * all && met(depth) > 0)
      return std::lerp(last, depth, (share_of_rays * all - below) / met(depth));
    below += met(depth);
    last = depth;
  }
  return 0;
}

}  // namespace sfumato::soft
