#include "analysis/range_image.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "analysis/quantiles.h"
#include "core/order.h"
#include "core/typed_attributes.h"

namespace sfumato::analysis {
namespace {

constexpr float none = std::numeric_limits<float>::infinity();
/// Whether nearly all pixels have a neighbour. Of a picture that was thinned at random, every other one has
/// none that normals could come from.
template <class Cell>
bool are_side_by_side(const std::vector<Cell>& cells, Cell empty) {
  constexpr double nearly_all = 0.8;
  std::size_t occupied = 0, beside = 0;
  for (std::size_t i = 0; i + 1 < cells.size(); ++i)
    if (cells[i] != empty) ++occupied, beside += cells[i + 1] != empty;
  return double(beside) >= nearly_all * double(occupied);
}

/// One view: ranges from its viewpoint and the rays they were measured along.
class RangeImage {
 public:
  /// Nothing when the grid is no picture.
  static std::optional<RangeImage> from(const PointCloud& cloud, const Grid& grid) {
    const std::size_t cells = std::size_t(grid.width) * grid.height;
    if (!grid.viewpoint || grid.width < 8 || grid.height < 8 || grid.first + grid.count > cloud.size() ||
        cloud.grid_index.size() != cloud.size())
      return std::nullopt;
    RangeImage image;
    image.width_ = int(grid.width), image.height_ = int(grid.height);
    image.range_.assign(cells, none);
    image.ray_.assign(cells, vec3(0));
    const vec3 eye(*grid.viewpoint - cloud.origin);
    vec3 sum(0);
    for (std::size_t i = grid.first; i < grid.first + grid.count; ++i) {
      const std::uint32_t cell = cloud.grid_index[i];
      const vec3 way = cloud.positions[i] - eye;
      const float range = glm::length(way);
      if (cell >= cells || !(range > 0)) continue;
      image.range_[cell] = range;
      image.ray_[cell] = way / range;
      sum += image.ray_[cell];
    }
    const vec3 axis = glm::normalize(sum);
    for (const vec3& ray : image.ray_)
      if (ray != vec3(0) && !(glm::dot(ray, axis) > std::cos(float(glm::radians(75.0))))) return std::nullopt;
    return image.measure() ? std::optional(std::move(image)) : std::nullopt;
  }

  float range(std::size_t cell) const { return range_[cell]; }
  /// Standard deviation of a range over the range squared.
  float deviation() const { return deviation_; }
  std::size_t pixels() const {
    return range_.size() - std::size_t(std::count(range_.begin(), range_.end(), none));
  }
  bool is_side_by_side() const { return are_side_by_side(range_, none); }
  /// Pixels that a neighbour beside and one above or below continue as one surface.
  std::size_t joined() const {
    std::size_t count = 0;
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x)
        count += (continues(x, y, 1, 0) || continues(x, y, -1, 0)) &&
                 (continues(x, y, 0, 1) || continues(x, y, 0, -1));
    return count;
  }
  float pitch(float range) const { return pixel_angle_ * range; }
  /// Side of the square that a point stands for on a surface of this normal (0: facing the camera), which a
  /// slant makes larger by the root of the cosine; not at an edge, whose normals are anybody's guess and
  /// where a large disc sticks out. Where the next terrace of depths is farther, half as much again, which
  /// closes most gaps between terraces and blurs little.
  float spacing(std::size_t cell, const vec3& normal) const {
    const float range = range_[cell];
    const bool known = normal != vec3(0) && is_whole(cell);
    const float facing = known ? std::max(std::abs(glm::dot(normal, ray_[cell])), 0.4f) : 1;
    const float terrace = std::min(1.5f, 0.6f * step_ * range / pixel_angle_);
    return pitch(range) * std::max(1 / std::sqrt(facing), terrace);
  }

  /// Gaussian in the picture, Gaussian in the ranges: noise averages out, edges stay (Tomasi, Manduchi 1998).
  /// In passes of 5 x 5 pixels that are 1 and 2 apart (a trous), and 4 and 8 where depths are counted:
  /// together they reach 30 pixels, across terraces.
  void smooth() {
    std::vector<float> smoothed(range_.size(), none);
    for (int step = 1; step <= (step_ > 0 ? 8 : 2); step *= 2) {
      tbb::parallel_for(0, height_, [&](int y) {
        for (int x = 0; x < width_; ++x) {
          const float center = range_[at(x, y)];
          smoothed[at(x, y)] = center;
          // The noisier, the more pixels: slopes are to be known to a fraction of the noise over the pitch.
          if (center == none || (step > 1 && 4 * noise(center) / pitch(center) < 2 * float(step))) continue;
          const float sigma = spread(center);
          float sum = 0, weights = 0;
          for (int v = y - 2 * step; v <= y + 2 * step; v += step)
            for (int u = x - 2 * step; u <= x + 2 * step; u += step) {
              if (u < 0 || v < 0 || u >= width_ || v >= height_) continue;
              const float range = range_[at(u, v)];
              if (range == none) continue;
              const float d = (range - center) / sigma,
                          s2 = float((u - x) * (u - x) + (v - y) * (v - y)) / float(step * step);
              const float w = std::exp(-0.5f * (d * d + s2 / (1.2f * 1.2f)));
              sum += w * range, weights += w;
            }
          smoothed[at(x, y)] = sum / weights;
        }
      });
      range_.swap(smoothed);
    }
  }

  /// Unit normal towards the viewpoint, 0 where the neighbours do not tell.
  vec3 normal(std::size_t cell) const {
    const int x = int(cell) % width_, y = int(cell) / width_;
    const std::optional<vec3> across = difference(x, y, 1, 0), down = difference(x, y, 0, 1);
    if (!across || !down) return vec3(0);
    const vec3 n = glm::cross(*across, *down);
    const float length = glm::length(n);
    if (!(length > 0)) return vec3(0);
    return glm::dot(n, ray_[cell]) > 0 ? -n / length : n / length;
  }

 private:
  static constexpr float steepest = 3.7f;  // tan 75 degrees
  std::size_t at(int x, int y) const { return std::size_t(y) * std::size_t(width_) + std::size_t(x); }
  vec3 place(std::size_t cell) const { return range_[cell] * ray_[cell]; }
  float noise(float range) const { return noise_ * range * range; }
  /// Ranges that differ by less are one surface: noise, and a slope of 75 degrees over a pixel.
  float spread(float range) const { return 2 * noise(range) + steepest * pitch(range); }

  /// Whatever the noise: that of leaves is as large as they are far apart.
  bool continues(int x, int y, int dx, int dy) const {
    const int u = x + dx, v = y + dy;
    if (u < 0 || v < 0 || u >= width_ || v >= height_) return false;
    const float here = range_[at(x, y)], there = range_[at(u, v)];
    return here != none && there != none && std::abs(there - here) <= steepest * pitch(std::min(here, there));
  }

  /// Whether all of 5 x 5 pixels may be of the surface in the middle.
  bool is_whole(std::size_t cell) const {
    const int x = int(cell) % width_, y = int(cell) / width_;
    if (x < 2 || y < 2 || x + 2 >= width_ || y + 2 >= height_) return false;
    for (int v = y - 2; v <= y + 2; ++v)
      for (int u = x - 2; u <= x + 2; ++u) {
        const float range = range_[at(u, v)];
        if (range == none || std::abs(range - range_[cell]) > 2 * spread(range_[cell])) return false;
      }
    return true;
  }

  /// From one neighbour to the other, or to the pixel itself where one is missing or across an edge.
  std::optional<vec3> difference(int x, int y, int dx, int dy) const {
    const std::size_t own = at(x, y);
    auto side = [&](int u, int v) -> std::optional<std::size_t> {
      if (u < 0 || v < 0 || u >= width_ || v >= height_) return std::nullopt;
      const float range = range_[at(u, v)];
      if (range == none || std::abs(range - range_[own]) > spread(range_[own])) return std::nullopt;
      return at(u, v);
    };
    const auto before = side(x - dx, y - dy), after = side(x + dx, y + dy);
    if (!before && !after) return std::nullopt;
    return place(after.value_or(own)) - place(before.value_or(own));
  }

  /// The angle of a pixel and the noise of the view; false where there are too few pixels side by side.
  bool measure() {
    std::vector<float> angles, bends;
    for (int y = 0; y < height_; ++y)
      for (int x = 1; x + 1 < width_; ++x) {
        const std::size_t a = at(x - 1, y), b = at(x, y), c = at(x + 1, y);
        if (range_[a] == none || range_[b] == none || range_[c] == none) continue;
        angles.push_back(0.5f * glm::length(ray_[c] - ray_[a]));
        bends.push_back(std::abs(range_[a] - 2 * range_[b] + range_[c]) / (range_[b] * range_[b]));
      }
    if (angles.size() < 16) return false;
    pixel_angle_ = quantile(angles, 0.5);
    step_ = depth_step();
    // Second differences of white noise have sqrt(6) times its deviation, which is the 68 % quantile of its
    // size.
    const float white = quantile(bends, 0.68) / std::sqrt(6.0f);
    noise_ = std::max(white, 0.8f * step_);
    deviation_ = std::max(white, step_ / std::sqrt(12.0f));
    return pixel_angle_ > 0;
  }

  /// Of a camera that counts depths (Kinect: disparities), the least difference but 0 between neighbours,
  /// over the depth squared; 0 of others. Most second differences are 0 there, and say nothing about the
  /// terraces that depths stand on.
  float depth_step() const {
    vec3 axis(0);
    for (const vec3& ray : ray_) axis += ray;
    axis = glm::normalize(axis);
    std::vector<float> steps;
    std::size_t pairs = 0;
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x + 1 < width_; ++x) {
        const std::size_t a = at(x, y), b = at(x + 1, y);
        if (range_[a] == none || range_[b] == none) continue;
        const float one = range_[a] * glm::dot(ray_[a], axis), other = range_[b] * glm::dot(ray_[b], axis);
        ++pairs;
        // Two floats of one depth differ by their rounding, and by that of the axis.
        if (std::abs(one - other) > 2e-5f * one) steps.push_back(std::abs(one - other) / (one * one));
      }
    const bool is_counted = pairs > 0 && double(pairs - steps.size()) > 0.15 * double(pairs);
    return is_counted && !steps.empty() ? quantile(steps, 0.3) : 0;
  }

  int width_ = 0, height_ = 0;
  std::vector<float> range_;  // scene units, `none` where the view is empty
  std::vector<vec3> ray_;     // unit
  float pixel_angle_ = 0;     // radians: 1 / focal length in pixels
  float step_ = 0;            // of depths that are counted, over the depth squared; else 0
  float noise_ = 0;      // deviation of a range over the range squared, as stereo has it, or most of a step
  float deviation_ = 0;  // the same, of a step what rounding to it leaves
};

/// Columns, or rows, of pixels: evenly spaced values that all others are near to.
struct Lines {
  double first = 0, pitch = 0;
  int count = 0;
  double place(double value) const { return (value - first) / pitch; }
};

/// Of points that lie in no pixel.
constexpr std::uint32_t nowhere = ~0u;
constexpr int most_lines = 8192, least_lines = 32;

/// A value at most this share of a pitch away from its line is on it; two in a hundred may lie farther off.
constexpr double off_line = 0.25, on_lines = 0.98;

std::optional<Lines> find_lines(std::vector<double> values) {
  if (values.size() < std::size_t(least_lines)) return std::nullopt;
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  const double range = values[n - 1] - values[0];
  std::vector<double> gaps;
  for (std::size_t i = 1; i < n; ++i)
    if (const double gap = values[i] - values[i - 1]; gap * most_lines > range) gaps.push_back(gap);
  if (gaps.size() < std::size_t(least_lines)) return std::nullopt;
  const double wide = 0.4 * median(gaps);
  std::vector<double> lines, steps;
  for (std::size_t first = 0; first < n;) {
    std::size_t last = first + 1;
    double sum = values[first];
    for (; last < n && values[last] - values[last - 1] <= wide; ++last) sum += values[last];
    lines.push_back(sum / double(last - first));
    first = last;
  }
  for (std::size_t k = 1; k < lines.size(); ++k) steps.push_back(lines[k] - lines[k - 1]);
  if (steps.size() < std::size_t(least_lines)) return std::nullopt;
  const double pitch = median(std::vector<double>(steps));
  // A line through the places of lines, by least squares: the pitch to a thousandth is not enough for 640 of
  // them.
  double number = 0, count = 0, sum_k = 0, sum_kk = 0, sum_v = 0, sum_kv = 0;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    if (k > 0) number += std::round(steps[k - 1] / pitch);
    ++count, sum_k += number, sum_kk += number * number, sum_v += lines[k], sum_kv += number * lines[k];
  }
  const double spread = count * sum_kk - sum_k * sum_k;
  if (!(spread > 0) || number >= most_lines) return std::nullopt;
  Lines found;
  found.pitch = (count * sum_kv - sum_k * sum_v) / spread;
  found.first = (sum_v - found.pitch * sum_k) / count;
  found.count = int(number) + 1;
  if (!(found.pitch > 0)) return std::nullopt;
  std::size_t on = 0;
  for (double value : values) {
    const double place = found.place(value), nearest = std::round(place);
    on += std::abs(place - nearest) < off_line && nearest >= 0 && nearest < found.count;
  }
  return double(on) >= on_lines * double(n) ? std::optional(found) : std::nullopt;
}

}  // namespace

bool recover_grid(PointCloud& cloud) {
  constexpr double filled = 0.25, twice = 0.02, strays = 0.005;
  const std::size_t n = cloud.size();
  if (!cloud.grids.empty() || !cloud.scanners.empty() || n < std::size_t(least_lines) * least_lines)
    return false;
  const double side = cloud.world(n / 2).z > 0 ? 1 : -1;
  const auto slopes = [&](std::size_t i) -> std::optional<glm::dvec2> {
    const dvec3 p = cloud.world(i);
    const double depth = side * p.z;
    if (!(std::abs(p.x) < 2 * depth && std::abs(p.y) < 2 * depth)) return std::nullopt;
    return glm::dvec2(p.x, p.y) / depth;
  };
  const std::size_t stride = std::max<std::size_t>(1, n / 4096);
  std::size_t outside = 0;
  for (std::size_t i = 0; i < n; i += stride) outside += !slopes(i);
  if (double(outside * stride) > 4 * strays * double(n)) return false;
  std::vector<double> across, down;
  across.reserve(n), down.reserve(n);
  for (std::size_t i = 0; i < n; ++i)
    if (const auto at = slopes(i)) across.push_back(at->x), down.push_back(at->y);
  if (double(n - across.size()) > strays * double(n)) return false;
  const auto columns = find_lines(across), rows = columns ? find_lines(down) : std::nullopt;
  if (!rows || double(n) < filled * columns->count * rows->count) return false;
  std::vector<std::uint32_t> cells(n);
  std::vector<std::uint32_t> first_in(std::size_t(columns->count) * std::size_t(rows->count), nowhere);
  std::size_t shared = 0;
  for (std::size_t i = 0; i < n; ++i) {
    cells[i] = nowhere;
    const auto at = slopes(i);
    if (!at) continue;
    const long x = std::lround(columns->place(at->x)), y = std::lround(rows->place(at->y));
    if (x < 0 || y < 0 || x >= columns->count || y >= rows->count) continue;
    cells[i] = std::uint32_t(y) * std::uint32_t(columns->count) + std::uint32_t(x);
    std::uint32_t& first = first_in[cells[i]];
    if (first == nowhere) first = std::uint32_t(i);
    shared += cloud.positions[first] != cloud.positions[i];
  }
  if (double(shared) > twice * double(n)) return false;
  if (!are_side_by_side(first_in, nowhere)) return false;
  cloud.grid_index = std::move(cells);
  cloud.grids = {{0, n, std::uint32_t(columns->count), std::uint32_t(rows->count), dvec3(0)}};
  return true;
}

void complete_from_grids(PointCloud& cloud, Attributes needs, Progress& progress) {
  const bool normals = needs.has(Attribute::normal) && cloud.normals.empty();
  const bool radii = needs.has(Attribute::radius) && cloud.radii.empty();
  if (!normals && !radii) return;
  const float cover = float(std::sqrt(4 / M_PI));
  for (const Grid& grid : cloud.grids) {
    progress.check();
    std::optional<RangeImage> image = RangeImage::from(cloud, grid);
    if (!image) continue;
    if (normals) cloud.normals.resize(cloud.size(), vec3(0));
    if (radii) cloud.radii.resize(cloud.size(), 0.0f);
    const std::size_t last = grid.first + grid.count, cells = std::size_t(grid.width) * grid.height;
    image->smooth();
    tbb::parallel_for(grid.first, last, [&](std::size_t i) {
      const std::uint32_t cell = cloud.grid_index[i];
      if (cell >= cells || image->range(cell) == none) return;
      const vec3 normal = image->normal(cell);
      if (normals) cloud.normals[i] = normal;
      if (radii) cloud.radii[i] = cover * image->spacing(cell, normal);
    });
  }
}

std::optional<DepthPictures> depth_pictures(const PointCloud& cloud) {
  constexpr double nearly_all = 0.95;
  struct Measured {
    std::size_t pixels = 0, joined = 0;
    float noise = 0;
  };
  std::vector<Measured> measured(cloud.grids.size());
  tbb::parallel_for(std::size_t(0), measured.size(), [&](std::size_t k) {
    const std::optional<RangeImage> image = RangeImage::from(cloud, cloud.grids[k]);
    if (image && image->is_side_by_side())
      measured[k] = {image->pixels(), image->joined(), image->deviation()};
  });
  std::size_t pixels = 0, joined = 0, count = 0;
  DepthPictures pictures;
  for (std::size_t k = 0; k < measured.size(); ++k) {
    if (measured[k].pixels == 0) continue;
    pixels += measured[k].pixels, joined += measured[k].joined, ++count;
    pictures.sensor = vec3(*cloud.grids[k].viewpoint - cloud.origin);
    pictures.noise = measured[k].noise;
  }
  if (count == 0 || !(double(pixels) >= nearly_all * double(cloud.size()))) return std::nullopt;
  if (count > 1) pictures.noise = 0;
  pictures.surface_share = float(joined) / float(pixels);
  return pictures;
}

ViewPlaces view_places(const PointCloud& cloud, const std::vector<std::uint32_t>& order) {
  ViewPlaces places;
  const bool views =
      std::any_of(cloud.grids.begin(), cloud.grids.end(), [](const Grid& g) { return bool(g.viewpoint); });
  if (!views || cloud.grid_index.size() != cloud.size() || (!cloud.normals.empty() && !cloud.radii.empty()))
    return places;
  places.grids = cloud.grids;
  std::vector<std::uint32_t> grid_of(cloud.size(), std::uint32_t(cloud.grids.size()));
  for (std::size_t g = 0; g < cloud.grids.size(); ++g) {
    const std::size_t last = std::min(cloud.size(), cloud.grids[g].first + cloud.grids[g].count);
    for (std::size_t i = cloud.grids[g].first; i < last; ++i) grid_of[i] = std::uint32_t(g);
    places.grids[g].first = places.grids[g].count = 0;
  }
  places.grid.resize(order.size()), places.cell.resize(order.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    places.grid[i] = grid_of[order[i]], places.cell[i] = cloud.grid_index[order[i]];
  return places;
}

void complete_from_views(PointCloud& cloud, const ViewPlaces& views, Attributes needs, Progress& progress) {
  if (views.grids.empty() || views.grid.size() != cloud.size() || cloud.source_index.size() != cloud.size())
    return;
  // The views side by side again, each in the order of the file, where a later point of a pixel replaces an
  // earlier one.
  const std::vector<std::uint32_t>& source = cloud.source_index;
  constexpr std::uint32_t nobody = ~0u;
  std::vector<std::uint32_t> by_source(std::size_t(*std::max_element(source.begin(), source.end())) + 1,
                                       nobody);
  for (std::uint32_t i = 0; i < cloud.size(); ++i)
    if (views.grid[i] < views.grids.size()) by_source[source[i]] = i;
  PointCloud organised;
  organised.origin = cloud.origin;
  organised.grids = views.grids;
  for (std::uint32_t i : by_source)
    if (i != nobody) ++organised.grids[views.grid[i]].count;
  std::vector<std::size_t> next;
  std::size_t count = 0;
  for (Grid& grid : organised.grids) {
    grid.first = count;
    next.push_back(count);
    count += grid.count;
  }
  organised.positions.resize(count), organised.grid_index.resize(count);
  std::vector<std::uint32_t> order(count);
  for (std::uint32_t i : by_source) {
    if (i == nobody) continue;
    const std::size_t k = next[views.grid[i]]++;
    order[k] = i;
    organised.positions[k] = cloud.positions[i];
    organised.grid_index[k] = views.cell[i];
  }
  Attributes lacking;
  if (needs.has(Attribute::normal) && cloud.normals.empty()) lacking = lacking | Attribute::normal;
  if (needs.has(Attribute::radius) && cloud.radii.empty()) lacking = lacking | Attribute::radius;
  complete_from_grids(organised, lacking, progress);
  for_each_attribute([&](const auto& each) {
    if (each.of(organised).empty()) return;
    each.of(cloud).assign(cloud.size(), each.missing);
    for (std::size_t k = 0; k < order.size(); ++k) each.of(cloud)[order[k]] = each.of(organised)[k];
  });
}

}  // namespace sfumato::analysis
