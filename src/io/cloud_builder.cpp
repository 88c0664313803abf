#include <algorithm>
#include <cmath>
#include <cstring>
#include <tuple>
#include <type_traits>
#include <utility>

#include "core/counted.h"
#include "core/order.h"
#include "io/color_depth.h"
#include "io/columns.h"
#include "io/large_vector.h"

namespace sfumato::io {
namespace {

constexpr std::size_t batch_size = 512;  // every scratch array of a batch stays in the first-level cache

template <class T>
T swapped(T value) {
  std::byte bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  std::reverse(bytes, bytes + sizeof(T));
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

template <class In, class Out>
void load_as(const std::byte* from, std::size_t stride, std::size_t count, bool swap, Out* out) {
  for (std::size_t i = 0; i < count; ++i) {
    In value;
    std::memcpy(&value, from + i * stride, sizeof value);
    out[i] = Out(swap ? swapped(value) : value);
  }
}

template <class Out>
void load(const Column& column, const std::byte* from, std::size_t count, bool swap, Out* out) {
  const std::size_t stride = column.stride;
  switch (column.layout) {
    case StoredType::uint8: return load_as<std::uint8_t>(from, stride, count, false, out);
    case StoredType::int8: return load_as<std::int8_t>(from, stride, count, false, out);
    case StoredType::uint16: return load_as<std::uint16_t>(from, stride, count, swap, out);
    case StoredType::int16: return load_as<std::int16_t>(from, stride, count, swap, out);
    case StoredType::uint32: return load_as<std::uint32_t>(from, stride, count, swap, out);
    case StoredType::int32: return load_as<std::int32_t>(from, stride, count, swap, out);
    case StoredType::uint64: return load_as<std::uint64_t>(from, stride, count, swap, out);
    case StoredType::int64: return load_as<std::int64_t>(from, stride, count, swap, out);
    case StoredType::float64: return load_as<double>(from, stride, count, swap, out);
    case StoredType::float32:
      if (swap) return load_as<float>(from, stride, count, true, out);
      return load_as<float>(from, stride, count, false, out);
  }
}

/// The differences of coordinates are floats, whatever the file holds: beyond this they would be infinite.
bool is_coordinate(double value) { return std::abs(value) <= 1e37; }

/// Adds the finite values to `stats`; false when some were not finite. Eight independent lanes, so that the
/// compiler can use vector registers.
template <class T>
bool accumulate(const T* values, std::size_t count, Stats& stats) {
  using Sum = std::conditional_t<std::is_integral_v<T>, std::uint32_t, double>;
  constexpr std::size_t lanes = 8;
  T low[lanes], high[lanes];
  Sum sum[lanes] = {};
  std::fill_n(low, lanes, std::numeric_limits<T>::max());
  std::fill_n(high, lanes, std::numeric_limits<T>::lowest());
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes)
    for (std::size_t k = 0; k < lanes; ++k) {
      const T value = values[i + k];
      low[k] = value < low[k] ? value : low[k];
      high[k] = value > high[k] ? value : high[k];
      sum[k] += Sum(value);
    }
  for (; i < count; ++i) {
    low[0] = values[i] < low[0] ? values[i] : low[0];
    high[0] = values[i] > high[0] ? values[i] : high[0];
    sum[0] += Sum(values[i]);
  }
  double total = 0;
  for (Sum part : sum) total += double(part);
  if (count == 0) return true;
  if (std::isfinite(total)) {
    stats.merge({double(*std::min_element(low, low + lanes)), double(*std::max_element(high, high + lanes)),
                 total, count});
    return true;
  }
  bool all = true;
  for (i = 0; i < count; ++i) {
    const double value = double(values[i]);
    if (std::isfinite(value))
      stats.merge({value, value, value, 1});
    else
      all = false;
  }
  return all;
}

}  // namespace

/// Up to `batch_size` records in memory, and which of them stay.
struct CloudBuilder::Batch {
  const std::byte* block = nullptr;
  std::size_t first = 0, count = 0, kept = 0;
  std::uint16_t keep[batch_size];

  const std::byte* at(const Column& column) const { return block + column.offset + first * column.stride; }
  bool all() const { return kept == count; }
  template <class T>
  void compact(T* values) const {
    if (!all())
      for (std::size_t i = 0; i < kept; ++i) values[i] = values[keep[i]];
  }
};

CloudBuilder::CloudBuilder(std::vector<Column> columns, std::size_t rows, bool big_endian, bool keep_places)
    : columns_(std::move(columns)), swap_(big_endian), keep_places_(keep_places) {
  const Role roles[] = {Role::x,  Role::y,   Role::z,     Role::nx,  Role::ny,
                        Role::nz, Role::red, Role::green, Role::blue};
  for (int k = 0; k < 3; ++k) {
    xyz_[k] = column_of(columns_, roles[k]);
    normal_[k] = column_of(columns_, roles[3 + k]);
    color_[k] = column_of(columns_, roles[6 + k]);
    wide_positions_ = wide_positions_ || is_wide(columns_[std::size_t(xyz_[k])].stored);
  }
  alpha_ = column_of(columns_, Role::alpha);
  if (wide_positions_)
    allocate(world_, rows);
  else
    allocate(positions_, rows);
  if (normal_[0] >= 0) allocate(normals_, rows);
  if (color_[0] >= 0) {
    byte_colors_ = true;
    for (int column : {color_[0], color_[1], color_[2], alpha_ < 0 ? color_[0] : alpha_})
      byte_colors_ = byte_colors_ && columns_[std::size_t(column)].layout == StoredType::uint8;
    if (byte_colors_)
      allocate(colors_, rows);
    else
      allocate(raw_colors_, rows);
  }
  if (keep_places_) allocate(places_, rows);
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const bool is_radius = columns_[i].role == Role::radius;
    if (columns_[i].role != Role::scalar && !is_radius) continue;
    Field& field = fields_.emplace_back(Field{i, is_radius ? &PointCloud::radii : nullptr});
    if (is_wide(columns_[i].stored) && !field.attribute)
      allocate(field.wide, rows);
    else
      allocate(field.narrow, rows);
  }
}

CloudBuilder::Cursor CloudBuilder::cursor(std::size_t begin, std::size_t end) const {
  return {begin, begin, end, 0, 0, std::vector<Stats>(columns_.size())};
}

void CloudBuilder::decode(Cursor& cursor, const std::byte* block, std::size_t first, std::size_t count,
                          std::uint64_t place) {
  for (std::size_t done = 0; done < count; done += batch_size) {
    Batch batch;
    batch.block = block;
    batch.first = first + done;
    batch.count = std::min(batch_size, count - done);
    decode_batch(cursor, batch, place + done);
  }
}

void CloudBuilder::decode_batch(Cursor& cursor, Batch& batch, std::uint64_t place) {
  if (wide_positions_)
    decode_positions<double>(cursor, batch, world_);
  else
    decode_positions<float>(cursor, batch, positions_);
  if (normal_[0] >= 0) decode_normals(cursor, batch);
  if (color_[0] >= 0) decode_colors(cursor, batch);
  for (Field& field : fields_) {
    if (field.wide.empty())
      decode_values(cursor, batch, field.column, field.narrow);
    else
      decode_values(cursor, batch, field.column, field.wide);
  }
  if (keep_places_)
    for (std::size_t i = 0; i < batch.kept; ++i)
      places_[cursor.at + i] = std::uint32_t(place + (batch.all() ? i : batch.keep[i]));
  cursor.at += batch.kept;
  cursor.records += batch.count;
}

template <class T, class V>
void CloudBuilder::decode_positions(Cursor& cursor, Batch& batch, std::vector<V>& out) {
  T axis[3][batch_size];
  Stats stats[3];
  bool finite = true;
  for (int k = 0; k < 3; ++k) {
    const Column& column = columns_[std::size_t(xyz_[k])];
    load(column, batch.at(column), batch.count, swap_, axis[k]);
    finite = accumulate(axis[k], batch.count, stats[k]) && finite;
    finite = finite && (stats[k].count == 0 || (is_coordinate(stats[k].min) && is_coordinate(stats[k].max)));
  }
  batch.kept = batch.count;
  if (!finite) {
    batch.kept = 0;
    for (std::size_t i = 0; i < batch.count; ++i)
      if (is_coordinate(axis[0][i]) && is_coordinate(axis[1][i]) && is_coordinate(axis[2][i]))
        batch.keep[batch.kept++] = std::uint16_t(i);
    for (int k = 0; k < 3; ++k) {
      batch.compact(axis[k]);
      stats[k] = {};
      accumulate(axis[k], batch.kept, stats[k]);
    }
  }
  for (int k = 0; k < 3; ++k) cursor.stats[std::size_t(xyz_[k])].merge(stats[k]);
  V* to = out.data() + cursor.at;
  for (std::size_t i = 0; i < batch.kept; ++i) to[i] = V(axis[0][i], axis[1][i], axis[2][i]);
}

template <class T>
void CloudBuilder::load_counted(Cursor& cursor, const Batch& batch, std::size_t index, T* out) const {
  const Column& column = columns_[index];
  if (std::is_same_v<T, float> && column.stored == StoredType::float64) {
    double values[batch_size];  // statistics tell what the file holds, not what float keeps of it
    load(column, batch.at(column), batch.count, swap_, values);
    accumulate(values, batch.count, cursor.stats[index]);
    std::copy(values, values + batch.count, out);
  } else {
    load(column, batch.at(column), batch.count, swap_, out);
    accumulate(out, batch.count, cursor.stats[index]);
  }
  batch.compact(out);
}

void CloudBuilder::decode_normals(Cursor& cursor, const Batch& batch) {
  float axis[3][batch_size], off[batch_size];
  for (int k = 0; k < 3; ++k) {
    load_counted(cursor, batch, std::size_t(normal_[k]), axis[k]);
  }
  vec3* to = normals_.data() + cursor.at;
  float worst = 0;
  for (std::size_t i = 0; i < batch.kept; ++i) {
    to[i] = vec3(axis[0][i], axis[1][i], axis[2][i]);
    off[i] = std::abs(axis[0][i] * axis[0][i] + axis[1][i] * axis[1][i] + axis[2][i] * axis[2][i] - 1);
  }
  for (std::size_t i = 0; i < batch.kept; ++i) worst = off[i] <= worst ? worst : off[i];  // NaN stays
  // Unit vectors as written by other programs stay bit for bit; only the others are worked on.
  constexpr float unit = 1e-5f;
  if (worst <= unit) return;
  for (std::size_t i = 0; i < batch.kept; ++i) {
    if (off[i] <= unit) continue;
    const double length = glm::length(dvec3(to[i]));
    if (length > 0 && std::isfinite(length)) {
      to[i] = vec3(dvec3(to[i]) / length);
    } else {
      to[i] = vec3(0);
      ++cursor.normals_dropped;
    }
  }
}

void CloudBuilder::decode_colors(Cursor& cursor, const Batch& batch) {
  const auto channels = [&](auto(&values)[4][batch_size]) {
    for (int k = 0; k < 4; ++k) {
      const int index = k < 3 ? color_[k] : alpha_;
      if (index < 0) continue;
      load_counted(cursor, batch, std::size_t(index), values[k]);
    }
  };
  if (byte_colors_) {
    std::uint8_t values[4][batch_size];
    if (alpha_ < 0) std::memset(values[3], 255, sizeof values[3]);
    channels(values);
    Rgba8* to = colors_.data() + cursor.at;
    for (std::size_t i = 0; i < batch.kept; ++i)
      to[i] = {values[0][i], values[1][i], values[2][i], values[3][i]};
  } else {
    float values[4][batch_size] = {};
    channels(values);
    vec4* to = raw_colors_.data() + cursor.at;
    for (std::size_t i = 0; i < batch.kept; ++i)
      to[i] = {values[0][i], values[1][i], values[2][i], values[3][i]};
  }
}

template <class T>
void CloudBuilder::decode_values(Cursor& cursor, const Batch& batch, std::size_t column,
                                 std::vector<T>& out) {
  T values[batch_size];
  load_counted(cursor, batch, column, values);
  std::copy(values, values + batch.kept, out.begin() + std::ptrdiff_t(cursor.at));
}

void CloudBuilder::close_gaps(const std::vector<Cursor>& cursors) {
  const auto close = [&](auto& values) {
    if (values.empty()) return;
    auto to = values.begin();
    for (const Cursor& cursor : cursors) {
      const auto from = values.begin() + std::ptrdiff_t(cursor.begin);
      const auto last = values.begin() + std::ptrdiff_t(cursor.at);
      to = to == from ? last : std::copy(from, last, to);
    }
    values.erase(to, values.end());
  };
  close(positions_), close(world_), close(normals_), close(colors_), close(raw_colors_), close(places_);
  for (Field& field : fields_) close(field.narrow), close(field.wide);
}

namespace {

/// The quantiles 2 % and 98 % of a coordinate, from a sample.
std::pair<double, double> middle_of(const std::vector<dvec3>& points, int axis) {
  std::vector<double> sample;
  for (std::size_t i = 0; i < points.size(); i += 1 + points.size() / 10'000)
    sample.push_back(points[i][axis]);
  if (sample.empty()) return {0, 0};
  const std::size_t last = sample.size() - 1;
  return {nth_value(sample, last / 50), nth_value(sample, last - last / 50)};
}

}  // namespace

void CloudBuilder::finish_positions(const dvec3& min, const dvec3& max, const Choices* chosen,
                                    PointCloud& cloud) {
  cloud.origin = chosen ? chosen->origin : choose_origin(min, max, !wide_positions_);
  if (wide_positions_) {
    // A stray point far off must not take the digits of all others: then the origin is where most points are.
    dvec3 low = min, high = max;
    for (int k = 0; k < 3; ++k) std::tie(low[k], high[k]) = middle_of(world_, k);
    const auto extent = [](const dvec3& a, const dvec3& b) {
      return std::max({b.x - a.x, b.y - a.y, b.z - a.z});
    };
    if (!chosen && extent(min, max) > 1000 * extent(low, high))
      cloud.origin = choose_origin(low, high, false);
    allocate(cloud.positions, world_.size());
    for (std::size_t i = 0; i < world_.size(); ++i) cloud.positions[i] = vec3(world_[i] - cloud.origin);
    world_ = {};
    return;
  }
  cloud.positions = std::move(positions_);
  if (cloud.origin != dvec3(0))
    for (vec3& p : cloud.positions) p = vec3(dvec3(p) - cloud.origin);
}

namespace {

/// The distance between floats around `value`.
double float_step(double value) { return std::exp2(std::floor(std::log2(std::abs(value))) - 23); }

/// What is said of 32-bit coordinates so far from the origin that their steps show: from a quarter of the
/// spacing on, where the normal of 24 neighbours turns by some 2 degrees. Their spacing is that of a surface
/// as large as the two larger sides of the cloud, robustly. A grid whose own step is wider, as of heights at
/// whole metres, loses nothing.
std::string coarse_floats(const PointCloud& cloud) {
  if (cloud.size() < 2) return "";
  const std::size_t stride = 1 + cloud.size() / 10'000;
  dvec3 extent(0), step(0);
  for (int k = 0; k < 3; ++k) {
    std::vector<double> sample;
    for (std::size_t i = 0; i < cloud.size(); i += stride) sample.push_back(cloud.world(i)[k]);
    const std::size_t last = sample.size() - 1;
    const double low = nth_value(sample, last / 50), high = nth_value(sample, last - last / 50);
    extent[k] = high - low;
    const double largest = std::max(std::abs(low), std::abs(high));
    if (!(largest > 1e-30)) continue;
    const double own = float_step(largest);
    const bool on_wider_grid = std::all_of(sample.begin(), sample.end(), [&](double value) {
      return std::abs(value) < largest / 2 || std::fmod(value, 2 * own) == 0;
    });
    if (!on_wider_grid) step[k] = own;
  }
  const int coarsest = step.y > step.x ? (step.z > step.y ? 2 : 1) : (step.z > step.x ? 2 : 0);
  const double area = std::max({extent.x * extent.y, extent.y * extent.z, extent.z * extent.x});
  const double spacing = std::sqrt(area / double(cloud.size()));
  if (!(step[coarsest] > 0.25 * spacing)) return "";
  return "its coordinates are 32-bit floats, which are " + short_text(step[coarsest]) + " apart along " +
         "xyz"[coarsest] + " (its points: about " + short_text(spacing) +
         "): surfaces are in steps; export it with doubles, or with an origin near the scan";
}

}  // namespace

void CloudBuilder::finish_colors(const std::vector<Stats>& stats, const Choices* chosen, ReadReport& report) {
  choices_.has_colors = !colors_.empty();
  if (raw_colors_.empty()) return;
  const auto are_integers = [&](std::initializer_list<int> group) {
    return std::all_of(group.begin(), group.end(),
                       [&](int column) { return is_integer(columns_[std::size_t(column)].stored); });
  };
  // Fractions, bytes in a wider type, 12 or 16 bit: the file does not say, what most points have does.
  ColorDepth depth;
  const auto largest_in = [&](int column) { return stats[std::size_t(column)].max; };
  const bool fit_bytes =
      std::max({largest_in(color_[0]), largest_in(color_[1]), largest_in(color_[2])}) <= largest_of(8);
  std::uint64_t fractions = 0, others = 0, absent = 0;
  constexpr float largest_fraction = 1.01f;  // computed ones end a little above 1
  for (const vec4& c : raw_colors_) {
    const float largest = std::max({c.x, c.y, c.z});
    if (std::isnan(c.x + c.y + c.z)) {
      ++absent;
      continue;
    }
    if (largest > 0) ++(largest <= largest_fraction ? fractions : others);
    const auto whole = [](float value) { return std::uint32_t(std::clamp(value, 0.0f, 65535.0f)); };
    if (!fit_bytes) depth.add(whole(c.x), whole(c.y), whole(c.z));
  }
  if (absent == raw_colors_.size() && !chosen) {
    raw_colors_ = {};
    return;
  }
  const bool are_fractions = !are_integers({color_[0], color_[1], color_[2]}) && fractions >= 99 * others;
  const int bits = std::max(8, depth.bits());
  float color_factor = are_fractions ? 255.0f : float(std::exp2(8 - bits));
  float alpha_factor = 1;
  if (alpha_ >= 0) {
    const double largest = stats[std::size_t(alpha_)].max;
    alpha_factor = !are_integers({alpha_}) && largest <= largest_fraction ? 255.0f
                   : largest <= 255                                       ? 1.0f
                                                                          : 1 / 256.0f;
  }
  // A sample without colours is no reason to leave out those of a part.
  if (chosen && chosen->has_colors) color_factor = chosen->color_factor, alpha_factor = chosen->alpha_factor;
  if (chosen && !chosen->has_colors) color_factor = 1 / 256.0f;
  choices_.has_colors = true, choices_.color_factor = color_factor, choices_.alpha_factor = alpha_factor;
  const auto byte = [](float value, float scale) {
    const float scaled = scale < 1 ? value * scale : value * scale + 0.5f;  // 16 bit: >> 8, others rounded
    return scaled > 0 ? std::uint8_t(std::min(scaled, 255.0f)) : std::uint8_t(0);  // NaN: 0
  };
  allocate(colors_, raw_colors_.size());
  for (std::size_t i = 0; i < colors_.size(); ++i) {
    const vec4& c = raw_colors_[i];
    colors_[i] = std::isnan(c.x + c.y + c.z)
                     ? no_color
                     : Rgba8{byte(c.x, color_factor), byte(c.y, color_factor), byte(c.z, color_factor),
                             alpha_ < 0 ? std::uint8_t(255) : byte(c.w, alpha_factor)};
  }
  raw_colors_ = {};
  if (absent > 0)
    report.notes.push_back(counted(absent, "point") + (absent == 1 ? " has" : " have") +
                           " no colour beside those that have: white");
  if (!are_fractions && bits == 12)
    report.notes.emplace_back("the colours hold 0 to 4095 and are taken as 12-bit");
  if (const std::uint64_t beyond = depth.beyond(bits); !are_fractions && beyond > 0)
    report.notes.push_back(beyond_bits(beyond, bits));
}

void CloudBuilder::finish(std::vector<Cursor>& cursors, ReadResult& result, const Choices* chosen) {
  std::vector<Stats> stats(columns_.size());
  ReadReport& report = result.report;
  for (const Cursor& cursor : cursors) {
    for (std::size_t i = 0; i < stats.size(); ++i) stats[i].merge(cursor.stats[i]);
    report.points += cursor.records;
    report.points_finite += cursor.at - cursor.begin;
    report.normals_dropped += cursor.normals_dropped;
  }
  report.points_dropped = report.points - report.points_finite;
  report.points += report.points_missing;
  close_gaps(cursors);
  if (report.points_finite > 0)
    for (int k = 0; k < 3; ++k) {
      report.bounds_min[k] = stats[std::size_t(xyz_[k])].min;
      report.bounds_max[k] = stats[std::size_t(xyz_[k])].max;
    }
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const Role role = columns_[i].role;
    if (role == Role::skip || role == Role::x || role == Role::y || role == Role::z) continue;
    AttributeStats attribute{columns_[i].name};
    if (stats[i].count > 0)
      attribute = {columns_[i].name, stats[i].min, stats[i].max, stats[i].sum / double(stats[i].count)};
    report.attributes.push_back(attribute);
  }
  PointCloud& cloud = result.cloud;
  finish_positions(report.bounds_min, report.bounds_max, chosen, cloud);
  choices_.origin = cloud.origin;
  const bool of_floats = std::any_of(std::begin(xyz_), std::end(xyz_), [&](int column) {
    return columns_[std::size_t(column)].stored == StoredType::float32;
  });
  if (of_floats && !wide_positions_)
    if (std::string note = coarse_floats(cloud); !note.empty()) report.notes.push_back(std::move(note));
  finish_colors(stats, chosen, report);
  cloud.normals = std::move(normals_);
  cloud.colors = std::move(colors_);
  cloud.grid_index = std::move(places_);
  for (Field& field : fields_) {
    const Column& column = columns_[field.column];
    if (field.attribute) {
      cloud.*field.attribute = std::move(field.narrow);
    } else if (is_wide(column.stored)) {
      const std::size_t k = cloud.scalars.size();
      const auto offset = chosen ? std::optional(chosen->offsets[k]) : std::nullopt;
      cloud.scalars.push_back(
          make_scalar(column.name, column.stored, field.wide, stats[field.column], offset));
      field.wide = {};
    } else {
      cloud.scalars.push_back({column.name, 0, std::move(field.narrow), column.stored});
    }
  }
  for (const ScalarField& field : cloud.scalars) choices_.offsets.push_back(field.offset);
}

}  // namespace sfumato::io
