#include "core/point_cloud.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/order.h"
#include "core/subsample.h"
#include "core/typed_attributes.h"

namespace sfumato {

dvec3 up_vector(UpAxis up) {
  switch (up) {
    case UpAxis::pos_x: return {1, 0, 0};
    case UpAxis::neg_x: return {-1, 0, 0};
    case UpAxis::pos_y: return {0, 1, 0};
    case UpAxis::neg_y: return {0, -1, 0};
    case UpAxis::pos_z: return {0, 0, 1};
    case UpAxis::neg_z: return {0, 0, -1};
  }
  return {0, 0, 1};
}

std::optional<UpAxis> parse_up_axis(std::string_view text) {
  bool negative = false;
  if (!text.empty() && (text[0] == '+' || text[0] == '-')) {
    negative = text[0] == '-';
    text.remove_prefix(1);
  }
  if (text.size() != 1) return std::nullopt;
  switch (text[0]) {
    case 'x':
    case 'X': return negative ? UpAxis::neg_x : UpAxis::pos_x;
    case 'y':
    case 'Y': return negative ? UpAxis::neg_y : UpAxis::pos_y;
    case 'z':
    case 'Z': return negative ? UpAxis::neg_z : UpAxis::pos_z;
    default: return std::nullopt;
  }
}

std::string to_string(UpAxis up) {
  static const char* names[] = {"+X", "-X", "+Y", "-Y", "+Z", "-Z"};
  return names[int(up)];
}

const ScalarField* PointCloud::scalar(std::string_view name) const {
  for (const ScalarField& field : scalars)
    if (field.name == name) return &field;
  return nullptr;
}

ScalarField* PointCloud::scalar(std::string_view name) {
  return const_cast<ScalarField*>(std::as_const(*this).scalar(name));
}

ScalarField& PointCloud::set_scalar(ScalarField field) {
  if (ScalarField* old = scalar(field.name)) return *old = std::move(field);
  return scalars.emplace_back(std::move(field));
}

Bounds bounds(const PointCloud& cloud) {
  if (cloud.empty()) return {cloud.origin, cloud.origin};
  vec3 lo = cloud.positions[0], hi = lo;
  for (const vec3& p : cloud.positions) {
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
  return {cloud.origin + dvec3(lo), cloud.origin + dvec3(hi)};
}

Bounds robust_bounds(const PointCloud& cloud, double low, double high) {
  if (cloud.empty()) return bounds(cloud);
  // Odd, so that few rows of a grid are as long as many strides.
  constexpr std::size_t most_sampled = 250'000;
  const std::size_t stride = cloud.size() <= most_sampled ? 1 : cloud.size() / most_sampled | 1;
  Bounds box;
  std::vector<float> axis;
  for (int k = 0; k < 3; ++k) {
    axis.clear();
    for (std::size_t i = 0; i < cloud.size(); i += stride) axis.push_back(cloud.positions[i][k]);
    box.min[k] = cloud.origin[k] + double(value_at_share(axis, low));
    box.max[k] = cloud.origin[k] + double(value_at_share(axis, high));
  }
  return box;
}

namespace {

template <class T>
std::vector<T> gather(const std::vector<T>& values, const std::vector<std::uint32_t>& order) {
  std::vector<T> out;
  if (values.empty()) return out;
  out.reserve(order.size());
  for (std::uint32_t i : order) out.push_back(values[i]);
  return out;
}

template <class T>
void extend(std::vector<T>& a, std::size_t a_size, const std::vector<T>& b, std::size_t b_size, T missing) {
  if (a.empty() && b.empty()) return;
  a.resize(a_size, missing);
  a.insert(a.end(), b.begin(), b.end());
  a.resize(a_size + b_size, missing);
}

bool lacks_colors(const PointCloud& cloud) {
  return std::all_of(cloud.colors.begin(), cloud.colors.end(),
                     [](const Rgba8& c) { return c == no_color || (c.r == 0 && c.g == 0 && c.b == 0); });
}

/// Colours of LAS files side by side: those of more bits decide, and what 16-bit colours have beyond 8 bits
/// is spelled out where the files do it differently. Before the scalars are put together; `fill` is for those
/// of `other`.
struct LowBytes {
  static constexpr const char* name = "rgb_low_bytes";  // io/las_fields.h
  bool fills = false;

  LowBytes(PointCloud& cloud, const PointCloud& other, bool has_own, bool has_theirs) {
    if (!has_own || !has_theirs) {
      if (cloud.las && has_theirs && other.las)
        cloud.las->color_bits = other.las->color_bits, cloud.las->colors_shifted = other.las->colors_shifted;
      return;
    }
    const auto is_shifted = [](const PointCloud& c) { return c.las && c.las->colors_shifted; };
    const bool own = is_shifted(cloud), theirs = is_shifted(other);
    if (cloud.las)
      cloud.las->color_bits = std::max(cloud.las->color_bits, other.las ? other.las->color_bits : 8);
    if (own == theirs && !cloud.scalar(name) && !other.scalar(name)) return;
    if (own && !cloud.scalar(name))
      cloud.set_scalar({name, 0, std::vector<float>(cloud.size(), 0.0f), StoredType::uint32});
    if (cloud.las) cloud.las->colors_shifted = false;
    fills = theirs && !other.scalar(name);
  }
  void fill(PointCloud& cloud, std::size_t first) const {
    if (!fills) return;
    ScalarField* low = cloud.scalar(name);
    if (!low)
      low = &cloud.set_scalar({name, 0,
                               std::vector<float>(cloud.size(), std::numeric_limits<float>::quiet_NaN()),
                               StoredType::uint32});
    std::fill(low->values.begin() + std::ptrdiff_t(first), low->values.end(), float(-low->offset));
  }
};

/// The scalar `scanner`, or what it would be: the only scanner there is, or none that is known.
ScalarField scanner_numbers(const PointCloud& cloud) {
  if (const ScalarField* field = cloud.scalar("scanner")) return *field;
  const float number = cloud.scanners.size() == 1 ? 0 : std::numeric_limits<float>::quiet_NaN();
  return {"scanner", 0, std::vector<float>(cloud.size(), number)};
}

/// How many numbers a file gives to scanners without saying where any of them stood, as a table does that has
/// a column of that name: one more than the largest. What is larger than any count of scanners names none.
std::size_t numbers_without_places(const PointCloud& cloud) {
  constexpr double most = 65'535;
  const ScalarField* field =
      cloud.scalars.empty() || !cloud.scanners.empty() ? nullptr : cloud.scalar("scanner");
  double largest = -1;
  for (std::size_t i = 0; field && i < field->values.size(); ++i)
    if (const double number = std::round(field->value(i)); number <= most)
      largest = std::max(largest, number);
  return std::size_t(largest + 1);
}

/// The first `count` numbers are left to scanners of which nobody knows where they stood.
void leave_numbers(PointCloud& cloud, std::size_t count) {
  auto& all = cloud.scanners;
  const auto is_known = [](const dvec3& place) { return !std::isnan(place.x); };
  const std::size_t left = std::size_t(std::find_if(all.begin(), all.end(), is_known) - all.begin());
  if (left >= count) return;
  ScalarField field = scanner_numbers(cloud);
  for (std::size_t i = 0; i < field.values.size(); ++i)
    if (const double number = std::round(field.value(i));
        number >= double(left) && number < double(all.size()))
      field.values[i] += float(count - left);
  cloud.set_scalar(std::move(field));
  all.insert(all.begin(), count - left, dvec3(std::numeric_limits<double>::quiet_NaN()));
}

}  // namespace

PointCloud select(const PointCloud& cloud, const std::vector<std::uint32_t>& order) {
  PointCloud out;
  out.origin = cloud.origin;
  out.up = cloud.up, out.up_is_known = cloud.up_is_known, out.provenance = cloud.provenance;
  out.of_faces = cloud.of_faces, out.crs = cloud.crs;
  out.las = cloud.las;
  out.scanners = cloud.scanners;
  out.positions = gather(cloud.positions, order);
  for_each_attribute([&](const auto& each) { each.of(out) = gather(each.of(cloud), order); });
  for (const ScalarField& field : cloud.scalars)
    out.scalars.push_back({field.name, field.offset, gather(field.values, order), field.type});
  out.source_index = cloud.source_index.empty() ? order : gather(cloud.source_index, order);
  if (!cloud.grids.empty() && std::is_sorted(order.begin(), order.end())) {
    out.grid_index = gather(cloud.grid_index, order);
    for (Grid grid : cloud.grids) {
      const auto first = std::lower_bound(order.begin(), order.end(), grid.first);
      const auto last = std::lower_bound(order.begin(), order.end(), grid.first + grid.count);
      grid.first = std::size_t(first - order.begin());
      grid.count = std::size_t(last - first);
      out.grids.push_back(grid);
    }
  }
  return out;
}

void append(PointCloud& cloud, const PointCloud& other) {
  if (cloud.empty() && cloud.scalars.empty()) {
    cloud = other;
    return;
  }
  if (cloud.empty()) cloud.origin = other.origin;  // that of no points is anywhere
  cloud.of_faces = cloud.of_faces && other.of_faces;
  const bool has_scanners = !cloud.scanners.empty() || !other.scanners.empty();
  ScalarField their_scanners;
  if (has_scanners) {
    leave_numbers(cloud, numbers_without_places(other));
    cloud.scanners.resize(std::max(cloud.scanners.size(), numbers_without_places(cloud)),
                          dvec3(std::numeric_limits<double>::quiet_NaN()));
    cloud.set_scalar(scanner_numbers(cloud));
    their_scanners = scanner_numbers(other);
    if (!other.scanners.empty())
      their_scanners.offset += double(cloud.scanners.size());  // they come behind ours
  }
  const std::size_t n = cloud.size(), m = other.size();
  const dvec3 shift = other.origin - cloud.origin;
  cloud.positions.reserve(n + m);
  for (const vec3& p : other.positions) cloud.positions.push_back(vec3(dvec3(p) + shift));
  const bool has_own = !lacks_colors(cloud), has_theirs = !lacks_colors(other);
  const LowBytes low_bytes(cloud, other, has_own, has_theirs);
  if (!has_own && has_theirs) cloud.colors.clear();
  for_each_attribute([&](const auto& each) { extend(each.of(cloud), n, each.of(other), m, each.missing); });
  if (has_own && !has_theirs)
    std::fill(cloud.colors.begin() + std::ptrdiff_t(n), cloud.colors.end(), no_color);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (ScalarField& field : cloud.scalars) {
    const ScalarField* theirs =
        has_scanners && field.name == "scanner" ? &their_scanners : other.scalar(field.name);
    field.values.resize(n, nan);
    if (theirs) {
      const double delta = theirs->offset - field.offset;
      for (float v : theirs->values) field.values.push_back(float(double(v) + delta));
    }
    field.values.resize(n + m, nan);
  }
  for (const ScalarField& field : other.scalars) {
    if (cloud.scalar(field.name)) continue;
    ScalarField added{field.name, field.offset, std::vector<float>(n, nan), field.type};
    added.values.insert(added.values.end(), field.values.begin(), field.values.end());
    cloud.scalars.push_back(std::move(added));
  }
  low_bytes.fill(cloud, n);
  if (!cloud.source_index.empty() || !other.source_index.empty()) {
    // A scene's source index counts through its files in the order they were named.
    std::uint32_t base = std::uint32_t(n);
    if (cloud.source_index.empty())
      for (std::size_t i = 0; i < n; ++i) cloud.source_index.push_back(std::uint32_t(i));
    else
      base = *std::max_element(cloud.source_index.begin(), cloud.source_index.end()) + 1;
    for (std::size_t i = 0; i < m; ++i)
      cloud.source_index.push_back(base +
                                   (other.source_index.empty() ? std::uint32_t(i) : other.source_index[i]));
  }
  extend(cloud.grid_index, n, other.grid_index, m, 0u);
  for (Grid grid : other.grids) {
    grid.first += n;
    cloud.grids.push_back(grid);
  }
  cloud.scanners.insert(cloud.scanners.end(), other.scanners.begin(), other.scanners.end());
}

void transform(PointCloud& cloud, const dmat4& world_from_old) {
  const auto moved = [&](const dvec3& p) { return dvec3(world_from_old * glm::dvec4(p, 1)); };
  const glm::dmat3 turn(world_from_old), turn_normals = glm::transpose(glm::inverse(turn));
  const dvec3 origin = moved(cloud.origin);
  for (vec3& p : cloud.positions) p = vec3(turn * dvec3(p));
  for (vec3& n : cloud.normals) {
    const dvec3 turned = turn_normals * dvec3(n);
    const double length = glm::length(turned);
    n = length > 0 ? vec3(turned / length) : vec3(0);
  }
  const float scale = float(std::cbrt(std::abs(glm::determinant(turn))));
  for (float& radius : cloud.radii) radius *= scale;
  for (dvec3& scanner : cloud.scanners) scanner = moved(scanner);
  for (Grid& grid : cloud.grids)
    if (grid.viewpoint) grid.viewpoint = moved(*grid.viewpoint);
  // The steps of coordinates are those of the old ones; kinds of time and colours stay.
  if (cloud.las) cloud.las->scale = dvec3(0);
  const dvec3 up = turn * up_vector(cloud.up);
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(up[k]) > std::abs(up[axis])) axis = k;
  cloud.up = UpAxis(2 * axis + (up[axis] > 0 ? 0 : 1));
  cloud.origin = origin;
}

PointCloud subsample(const PointCloud& cloud, std::size_t max_points) {
  if (cloud.size() <= max_points) return cloud;
  const Subsample chosen(cloud.size(), max_points);
  std::vector<std::uint32_t> order;
  order.reserve(max_points);
  for (std::size_t k = 0; k < max_points; ++k) order.push_back(std::uint32_t(chosen.place(k)));
  return select(cloud, order);
}

}  // namespace sfumato
