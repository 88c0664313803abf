#include "techniques/soft/haze_depth.h"

#include <algorithm>
#include <cmath>
#include <optional>
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

/// A square of cells that a sphere is spread over, in cells: at least as large as one, so that nothing jumps
/// when it moves from one to the next.
struct Square {
  double x, y, radius, half;
  int x0, x1, y0, y1;  ///< those in the view; none where the last is before the first
};

struct Cells {
  double px;  ///< side
  int across, down;
  explicit Cells(const Camera& camera)
      : px(std::max(camera.width, camera.height) / double(columns)),
        across(int(std::ceil(camera.width / px))),
        down(int(std::ceil(camera.height / px))) {}
};

/// Of nothing that is behind the camera. `radius`: scene units.
std::optional<Square> square_of(const Cells& cells, const Camera& camera, const Intrinsics& k,
                                const dmat4& eye_from_cloud, const vec3& place, double radius) {
  const dvec3 p(eye_from_cloud * glm::dvec4(dvec3(place), 1));
  if (!(-p.z > 1e-4 * camera.far_plane)) return std::nullopt;
  const double scale = camera.orthographic() ? k.fx : k.fx / -p.z;
  Square s;
  s.x = (p.x * scale + k.cx) / cells.px, s.y = (k.cy - p.y * scale) / cells.px;
  s.radius = radius * scale / cells.px, s.half = std::max(s.radius, 0.5);
  const auto from = [&](double at) { return int(std::floor(std::clamp(at - s.half, 0.0, 1e6))); };
  const auto to = [&](double at, int count) {
    return int(std::floor(std::clamp(at + s.half, -1.0, count - 1.0)));
  };
  s.x0 = from(s.x), s.x1 = to(s.x, cells.across), s.y0 = from(s.y), s.y1 = to(s.y, cells.down);
  return s;
}

/// Appends the depth of every cell of the view.
void add_cells(const HazeSpheres& spheres, const Camera& camera, const dvec3& origin, const HazeSettings& s,
               std::vector<double>& all) {
  const auto& [positions, radii, soft, field] = spheres;
  const Intrinsics k = camera.intrinsics();
  const Cells cells(camera);
  std::vector<double> depths(std::size_t(cells.across) * std::size_t(cells.down), 0.0);
  const std::size_t step = std::max<std::size_t>(1, (soft.size() + most_points - 1) / most_points);
  const dmat4 eye_from_cloud = camera.view(origin);
  for (std::size_t slot = step / 2; slot < soft.size(); slot += step) {
    const std::uint32_t i = soft[slot];
    const auto square = square_of(cells, camera, k, eye_from_cloud, positions[i],
                                  std::min(radii[i], s.radius_limit) * s.radius_scale);
    if (!square) continue;
    const auto& [x, y, radius, half, x0, x1, y0, y1] = *square;
    double weight = 1;
    if (s.modulation_threshold > s.field_threshold)
      weight =
          s.cone_factor + (1 - s.cone_factor) * std::clamp((double(field[i]) - s.field_threshold) /
                                                               (s.modulation_threshold - s.field_threshold),
                                                           0.0, 1.0);
    const double depth = weight * double(step) * mean_depth * M_PI * radius * radius / (4 * half * half);
    for (int row = y0; row <= y1; ++row)
      for (int column = x0; column <= x1; ++column)
        depths[std::size_t(row) * std::size_t(cells.across) + std::size_t(column)] +=
            depth * overlap(x - half, x + half, column) * overlap(y - half, y + half, row);
  }
  all.insert(all.end(), depths.begin(), depths.end());
}

}  // namespace

bool counts_in_depth(const Camera& view, const dmat4& eye_from_cloud, const vec3& place, double radius) {
  const auto square = square_of(Cells(view), view, view.intrinsics(), eye_from_cloud, place, radius);
  return square && square->x0 <= square->x1 && square->y0 <= square->y1;
}

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
