#include "analysis/upright.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace sfumato::analysis {
namespace {

constexpr std::size_t sample_size = 65'536;
/// A cloud less than this share as thick as wide is ground seen from the air, a street, a tile.
constexpr double flat = 0.4;
/// So is one whose middle 90 % of heights are this share of its width, whatever pylons and trees stand on it.
constexpr double mostly_flat = 0.3;
/// By how much another axis must stand firmer than the format's own. Measured on upright statues, rooms and
/// scenes: the right axis leads by 0.15 or more in nine cases of ten.
constexpr double lead = 0.15;
constexpr int cells = 24, layers = 25;

UpAxis axis_of(int axis, bool positive) { return UpAxis(2 * axis + (positive ? 0 : 1)); }

struct Sample {
  std::vector<dvec3> points;  ///< world
  dvec3 mean_normal{0};       ///< length 1 where all normals of the file agree, 0 where it has none
  dvec3 low{0}, high{0};      ///< of all but half a percent at each end
  double most_heights = 0;    ///< along z, of all but 5 % at each end

  explicit Sample(const PointCloud& cloud) {
    const std::size_t stride = std::max<std::size_t>(1, (cloud.size() + sample_size - 1) / sample_size);
    for (std::size_t i = 0; i < cloud.size(); i += stride) {
      points.push_back(cloud.world(i));
      if (!cloud.normals.empty()) mean_normal += dvec3(cloud.normals[i]);
    }
    if (!points.empty()) mean_normal /= double(points.size());
    std::vector<double> values(points.size());
    for (int k = 0; k < 3 && !points.empty(); ++k) {
      for (std::size_t i = 0; i < points.size(); ++i) values[i] = points[i][k];
      std::sort(values.begin(), values.end());
      low[k] = values[values.size() / 200], high[k] = values[values.size() - 1 - values.size() / 200];
      if (k == 2) most_heights = values[values.size() - 1 - values.size() / 20] - values[values.size() / 20];
    }
  }
  dvec3 size() const { return high - low; }

  double share(auto&& holds) const {
    return double(std::count_if(points.begin(), points.end(), holds)) / double(points.size());
  }

  /// Whether all lies in the view of a camera at the origin that looks along `axis`: within 45 degrees of it,
  /// spread over 30 at least and wide itself, which a far object that happens to lie there is not, nor a tile
  /// in map coordinates.
  bool seen_along(int axis, bool positive) const {
    const double sign = positive ? 1 : -1;
    const auto slope = [&](const dvec3& p) {
      const double depth = sign * p[axis];
      return depth > 0 ? std::max(std::abs(p[(axis + 1) % 3]), std::abs(p[(axis + 2) % 3])) / depth : 1e9;
    };
    const auto width = [&](int aside) {
      std::vector<double> slopes;
      for (const dvec3& p : points) slopes.push_back(p[aside] / std::abs(p[axis]));
      std::sort(slopes.begin(), slopes.end());
      return slopes[slopes.size() - 1 - slopes.size() / 50] - slopes[slopes.size() / 50];
    };
    return share([&](const dvec3& p) { return slope(p) < 1; }) > 0.98 &&
           share([&](const dvec3& p) { return slope(p) > 0.27; }) > 0.05 &&
           std::max(width((axis + 1) % 3), width((axis + 2) % 3)) > 0.27;
  }

  /// How well the cloud stands on its end: the share of the columns along `axis` that reach the lowest layer,
  /// weighted by how broad that side is. Statues have a base, rooms and streets a floor.
  double stands_on(int axis, bool positive) const {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const dvec3 extent = glm::max(size(), dvec3(1e-300));
    std::array<int, std::size_t(cells * cells)> lowest;
    lowest.fill(layers);
    for (const dvec3& p : points) {
      const dvec3 at = (p - low) / extent;
      if (at[u] < 0 || at[u] > 1 || at[v] < 0 || at[v] > 1) continue;
      const double height = positive ? at[axis] : 1 - at[axis];
      const int layer = std::clamp(int(height * layers), 0, layers - 1);
      int& cell = lowest[std::size_t(std::min(int(at[u] * cells), cells - 1) * cells +
                                     std::min(int(at[v] * cells), cells - 1))];
      cell = std::min(cell, layer);
    }
    double columns = 0, standing = 0;
    for (int layer : lowest) columns += layer < layers, standing += layer < 1;
    const double broad =
        extent[u] * extent[v] / std::max({extent.x * extent.y, extent.y * extent.z, extent.z * extent.x});
    return columns > 0 ? standing / columns * std::sqrt(broad) : 0;
  }
};

/// Of one picture, from about where it was taken: farther round, all that it hid would gape.
Upright camera_view(UpAxis up, const char* reason) {
  const bool sideways = up == UpAxis::neg_y;  // azimuth 0 of -Y looks from +z, i.e. from behind
  return {up, reason, sideways ? 165.0 : -15.0, 10, true};
}

}  // namespace

Upright guess_upright(const PointCloud& cloud) {
  const Upright custom{cloud.up, "the custom of its format", -45, 30};
  if (cloud.size() < 100) return custom;
  const Sample sample(cloud);
  const dvec3 size = sample.size();

  // Depth cameras look along z with y down, renderers along -z with y up.
  if (sample.seen_along(2, true))
    return camera_view(UpAxis::neg_y, "a camera's view: all lies before the origin, along z");
  if (sample.seen_along(2, false))
    return camera_view(UpAxis::pos_y, "a camera's view: all lies before the origin, along -z");
  // Nothing that one walks on faces down: these normals face a camera that looked along z.
  if (sample.mean_normal.z < -0.5)
    return camera_view(UpAxis::neg_y, "its normals face a camera that looked along z");

  const std::array<int, 3> by_size = [&] {
    std::array<int, 3> order{0, 1, 2};
    std::sort(order.begin(), order.end(), [&](int a, int b) { return size[a] < size[b]; });
    return order;
  }();
  const int thin = by_size[0];
  if (thin > 0 && size[thin] < flat * size[by_size[1]])
    return {axis_of(thin, true), std::string("flat: thin along ") + "xyz"[thin], -45, 30};

  if (thin == 2 && sample.most_heights < mostly_flat * size[by_size[1]])
    return {UpAxis::pos_z, "mostly flat: nearly all is thin along z", -45, 30};

  const int own = int(cloud.up) / 2;
  Upright best = custom;
  double most = sample.stands_on(own, int(cloud.up) % 2 == 0) + lead;
  for (int axis : {1, 2}) {
    const double firm = sample.stands_on(axis, true);
    if (axis == own || !(firm > most)) continue;  // NaN where there is no extent
    most = firm;
    best = {axis_of(axis, true), std::string("stands on its lowest layer along ") + "xyz"[axis], -45, 30};
  }
  return best;
}

}  // namespace sfumato::analysis
