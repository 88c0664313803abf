#include "io/las_points.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/order.h"
#include "core/typed_attributes.h"
#include "io/color_depth.h"
#include "io/columns.h"
#include "io/large_vector.h"

namespace sfumato::io::las {
namespace {

// Records handled at a time: the columns walk them one after the other, so that they should stay in cache.
constexpr std::size_t cached_records = 4096;
// Points per task of the passes over the whole cloud.
constexpr std::size_t pass_size = 1 << 18;

double raw_value(const Field& field, const std::uint8_t* record) {
  const std::uint8_t* at = record + field.byte;
  switch (field.type) {
    case StoredType::uint8: return *at;
    case StoredType::int8: return get<std::int8_t>(at);
    case StoredType::uint16: return get<std::uint16_t>(at);
    case StoredType::int16: return get<std::int16_t>(at);
    case StoredType::uint32: return get<std::uint32_t>(at);
    case StoredType::int32: return get<std::int32_t>(at);
    case StoredType::uint64: return double(get<std::uint64_t>(at));
    case StoredType::int64: return double(get<std::int64_t>(at));
    case StoredType::float32: return get<float>(at);
    case StoredType::float64: return get<double>(at);
  }
  return 0;
}

// A round number near the middle of the box: the grid of the origin is ten times finer than the box.
double round_center(double low, double high) {
  const double extent = high - low, center = 0.5 * (low + high);
  if (extent <= 0) return center;
  const double step = std::pow(10, std::floor(std::log10(extent)) - 1);
  return std::round(center / step) * step;
}

// A float holds 2^24 steps of a file's coordinates.
constexpr double most_exact_steps = 15e6;

}  // namespace

dvec3 origin_of(const Header& header, const ReadResult& sample, const std::optional<Bounds>& said) {
  Bounds box{sample.report.bounds_min, sample.report.bounds_max};
  // What a file says is the place of all points, unless it is wrong.
  const dvec3 scale = glm::abs(header.scale);
  const auto is_inside = [&] {
    return glm::all(glm::lessThanEqual(said->min - scale, box.min)) &&
           glm::all(glm::lessThanEqual(box.max, said->max + scale));
  };
  if (said && (sample.cloud.empty() || is_inside())) box = *said;
  dvec3 origin(0);
  for (int axis = 0; axis < 3; ++axis)
    origin[axis] = box.size()[axis] > most_exact_steps * scale[axis]
                       ? sample.cloud.origin[axis]
                       : round_center(box.min[axis], box.max[axis]);
  return origin;
}

PointCollector::PointCollector(const Header& header, const WholeFile& whole)
    : PointCollector(header, whole.first_record) {
  whole_ = whole;
}

PointCollector::PointCollector(const Header& header, const std::vector<std::uint8_t>& first_record)
    : header_(header) {
  std::vector<Field> fields = standard_fields(header.format);
  const std::vector<Field> extra = extra_fields(header, notes_);
  fields.insert(fields.end(), extra.begin(), extra.end());
  for (Field& field : fields) {
    Column column{field};
    if (field.is_color())
      color_columns_[field.name == "red" ? 0 : field.name == "green" ? 1 : 2] = int(columns_.size());
    if (field.is_scaled()) {
      column.base = field.offset;
    } else if (field.needs_residual() && !first_record.empty()) {
      const double value = std::trunc(raw_value(field, first_record.data()));
      if (std::abs(value) >= 65536 && std::abs(value) < 1e15) column.base = value;
    }
    // Those that the cloud does not get when they are zero everywhere.
    column.may_be_absent =
        column.base == 0 && field.offset == 0 && !field.is_color() && field.is_left_out_as_zero();
    columns_.push_back(std::move(column));
  }
}

std::size_t PointCollector::bytes_per_point() const {
  std::size_t bytes = sizeof(vec3) + 6;
  for (const Column& column : columns_) bytes += column.field.needs_residual() ? 8 : 4;
  return bytes;
}

void PointCollector::resize(std::size_t points) {
  // Fresh memory is cleared page by page, a tenth of the time of decoding: the columns share the threads.
  points_ = points;
  parallel_tasks(columns_.size() + 1, no_progress(), "", [&](std::size_t task) {
    if (task == columns_.size()) {
      enlarge(positions_, points);
      if (color_columns_[0] >= 0) enlarge(colors_, points);
      return;
    }
    Column& column = columns_[task];
    if (column.field.is_color()) return;
    if (!column.may_be_absent || *column.values_at) {
      enlarge(column.values, points);
      *column.values_at = column.values.data();
    }
    if (*column.residuals_at) {
      enlarge(column.residuals, points);
      *column.residuals_at = column.residuals.data();
    }
  });
}

float* PointCollector::numbers(std::vector<float>& values, std::atomic<float*>& at) {
  if (float* made = at.load(std::memory_order_acquire)) return made;
  const std::lock_guard lock(making_);
  if (!at) {
    allocate(values, points_);
    at.store(values.data(), std::memory_order_release);
  }
  return at;
}

PointCollector::Stats PointCollector::empty_stats() const {
  Stats stats;
  stats.low.fill(std::numeric_limits<std::int32_t>::max());
  stats.high.fill(std::numeric_limits<std::int32_t>::min());
  stats.fields.resize(columns_.size());
  return stats;
}

namespace {

/// Which bits some record has set, byte by byte.
void gather_bits(const std::uint8_t* records, std::size_t count, std::size_t length,
                 std::vector<std::uint8_t>& seen) {
  constexpr std::size_t word = 8;
  seen.assign((length + word - 1) / word * word, 0);
  for (std::size_t at = 0; at < length; at += word) {
    const std::size_t from = std::min(at, length - word);  // records are 20 bytes long and more
    std::uint64_t bits = 0;
    const std::uint8_t* record = records + from;
    for (std::size_t i = 0; i < count; ++i, record += length) bits |= get<std::uint64_t>(record);
    for (std::size_t b = 0; b < word; ++b) seen[from + b] |= std::uint8_t(bits >> (8 * b));
  }
}

bool is_zero(const Field& field, const std::vector<std::uint8_t>& seen) {
  if (field.bits) return (seen[field.byte] >> field.shift & ((1u << field.bits) - 1)) == 0;
  for (std::size_t b = 0; b < size_of(field.type); ++b)
    if (seen[field.byte + b]) return false;
  return true;
}

}  // namespace

template <class T>
void PointCollector::unpack_values(Column& column, std::size_t first, const std::uint8_t* records,
                                   std::size_t count, const std::vector<std::uint8_t>& seen,
                                   FieldStats& stats) {
  const Field& field = column.field;
  const std::size_t stride = header_.record_length;
  const std::uint8_t* at = records + field.byte;
  // Zeros are there already, or need not be.
  if (column.base == 0 && field.offset == 0 && field.no_data != 0 && is_zero(field, seen)) {
    stats.min = std::min(stats.min, 0.0);
    stats.max = std::max(stats.max, 0.0);
    stats.count += count;
    return;
  }
  float* out = numbers(column.values, *column.values_at) + first;
  if (field.bits) {
    const unsigned mask = (1u << field.bits) - 1;
    unsigned low = mask, high = 0;
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < count; ++i, at += stride) {
      const unsigned value = (unsigned(*at) >> field.shift) & mask;
      low = std::min(low, value);
      high = std::max(high, value);
      sum += value;
      out[i] = float(value);
    }
    stats.min = std::min(stats.min, double(low));
    stats.max = std::max(stats.max, double(high));
    stats.sum += double(sum);
    stats.count += count;
    return;
  }
  const bool has_residual = field.needs_residual();
  float* residual = has_residual && *column.residuals_at ? column.residuals_at->load() + first : nullptr;
  double low = stats.min, high = stats.max, sum = 0;
  std::uint64_t finite = 0;
  const bool is_always_finite = std::is_integral_v<T> && !field.no_data;
  const T no_data = field.no_data ? T(*field.no_data) : T();
  for (std::size_t i = 0; i < count; ++i, at += stride) {
    const T raw = get<T>(at);
    const double value = field.no_data && raw == no_data ? std::numeric_limits<double>::quiet_NaN()
                                                         : double(raw) * field.scale + field.offset;
    if (is_always_finite || std::isfinite(value)) {
      low = std::min(low, value);
      high = std::max(high, value);
      sum += value;
      ++finite;
    }
    const double delta = value - column.base;
    out[i] = float(delta);
    if (!has_residual) continue;
    float rest = float(delta - double(out[i]));
    if (!std::isfinite(rest)) rest = 0;
    if (rest != 0 && !residual) residual = numbers(column.residuals, *column.residuals_at) + first;
    if (residual) residual[i] = rest;
    stats.has_residual |= rest != 0;
    stats.is_inexact |= std::isfinite(value) && column.base + (double(out[i]) + double(rest)) != value;
  }
  stats.min = low;
  stats.max = high;
  stats.sum += sum;
  stats.count += finite;
}

void PointCollector::unpack_column(Column& column, std::size_t first, const std::uint8_t* records,
                                   std::size_t count, const std::vector<std::uint8_t>& seen,
                                   FieldStats& stats) {
  switch (column.field.type) {
    case StoredType::uint8: return unpack_values<std::uint8_t>(column, first, records, count, seen, stats);
    case StoredType::int8: return unpack_values<std::int8_t>(column, first, records, count, seen, stats);
    case StoredType::uint16: return unpack_values<std::uint16_t>(column, first, records, count, seen, stats);
    case StoredType::int16: return unpack_values<std::int16_t>(column, first, records, count, seen, stats);
    case StoredType::uint32: return unpack_values<std::uint32_t>(column, first, records, count, seen, stats);
    case StoredType::int32: return unpack_values<std::int32_t>(column, first, records, count, seen, stats);
    case StoredType::uint64: return unpack_values<std::uint64_t>(column, first, records, count, seen, stats);
    case StoredType::int64: return unpack_values<std::int64_t>(column, first, records, count, seen, stats);
    case StoredType::float32: return unpack_values<float>(column, first, records, count, seen, stats);
    case StoredType::float64: return unpack_values<double>(column, first, records, count, seen, stats);
  }
}

void PointCollector::unpack(std::size_t first, const std::uint8_t* records, std::size_t count, Stats& stats) {
  const std::size_t stride = header_.record_length;
  std::vector<std::uint8_t> seen;
  for (std::size_t begin = 0; begin < count; begin += cached_records) {
    const std::size_t n = std::min(cached_records, count - begin);
    const std::uint8_t* block = records + begin * stride;
    for (std::size_t i = 0; i < n; ++i) {
      vec3& position = positions_[first + begin + i];
      for (int axis = 0; axis < 3; ++axis) {
        const std::int32_t value = get<std::int32_t>(block + i * stride + 4 * std::size_t(axis));
        stats.low[std::size_t(axis)] = std::min(stats.low[std::size_t(axis)], value);
        stats.high[std::size_t(axis)] = std::max(stats.high[std::size_t(axis)], value);
        std::memcpy(&position[axis], &value, sizeof value);
      }
    }
    gather_bits(block, n, stride, seen);
    for (std::size_t c = 0; c < columns_.size(); ++c)
      if (!columns_[c].field.is_color())
        unpack_column(columns_[c], first + begin, block, n, seen, stats.fields[c]);
    for (std::size_t channel = 0; channel < 3 && color_columns_[channel] >= 0; ++channel) {
      const std::size_t c = std::size_t(color_columns_[channel]);
      FieldStats& s = stats.fields[c];
      const std::uint8_t* at = block + columns_[c].field.byte;
      std::uint16_t low = 0xFFFF, high = 0;
      std::uint64_t sum = 0;
      for (std::size_t i = 0; i < n; ++i, at += stride) {
        const std::uint16_t value = get<std::uint16_t>(at);
        colors_[first + begin + i][channel] = value;
        low = std::min(low, value);
        high = std::max(high, value);
        sum += value;
      }
      s.min = std::min(s.min, double(low));
      s.max = std::max(s.max, double(high));
      s.sum += double(sum);
      s.count += n;
    }
  }
}

ReadResult PointCollector::finish(const std::vector<Stats>& parts, Progress& progress) {
  Stats total = empty_stats();
  for (const Stats& part : parts) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      total.low[axis] = std::min(total.low[axis], part.low[axis]);
      total.high[axis] = std::max(total.high[axis], part.high[axis]);
    }
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      FieldStats& sum = total.fields[c];
      const FieldStats& add = part.fields[c];
      sum.min = std::min(sum.min, add.min);
      sum.max = std::max(sum.max, add.max);
      sum.sum += add.sum;
      sum.count += add.count;
      sum.has_residual |= add.has_residual;
      sum.is_inexact |= add.is_inexact;
    }
  }
  ReadResult result;
  result.report.points = result.report.points_finite = positions_.size();
  result.report.notes = notes_;
  result.report.crs = result.cloud.crs = read_crs(header_);
  result.cloud.up = UpAxis::pos_z;
  result.cloud.las = LasScaling{header_.scale, header_.offset};
  result.cloud.las->point_format = header_.format;
  result.cloud.las->time_and_returns = header_.global_encoding & (1 | 8);
  if (header_.format == 4 || header_.format == 5 || header_.format >= 9)
    result.report.notes.emplace_back("wave packets are not read");
  place_points(result, total, progress);
  place_colors(result, progress);
  place_scalars(result, total);
  place_attributes(result);
  return result;
}

std::int32_t PointCollector::median_step(int axis) const {
  std::vector<std::int32_t> sample;
  for (std::size_t i = 0; i < positions_.size(); i += 1 + positions_.size() / 10'000)
    sample.push_back(std::bit_cast<std::int32_t>(positions_[i][axis]));
  return median(sample);
}

void PointCollector::place_points(ReadResult& result, const Stats& total, Progress& progress) {
  PointCloud& cloud = result.cloud;
  if (whole_) cloud.origin = whole_->origin;
  std::string rounded;
  double by = 0;
  if (!positions_.empty()) {
    for (int axis = 0; axis < 3; ++axis) {
      const double a = header_.scale[axis] * total.low[std::size_t(axis)] + header_.offset[axis];
      const double b = header_.scale[axis] * total.high[std::size_t(axis)] + header_.offset[axis];
      result.report.bounds_min[axis] = std::min(a, b);
      result.report.bounds_max[axis] = std::max(a, b);
      if (!whole_) cloud.origin[axis] = round_center(std::min(a, b), std::max(a, b));
      // Beyond that the file's last digits are lost, least where most points are.
      if (double(total.high[std::size_t(axis)]) - double(total.low[std::size_t(axis)]) > most_exact_steps) {
        if (!whole_) cloud.origin[axis] = header_.scale[axis] * median_step(axis) + header_.offset[axis];
        const double reach = std::max(std::abs(a - cloud.origin[axis]), std::abs(b - cloud.origin[axis]));
        rounded += (rounded.empty() ? "" : ", ") + std::string(1, "xyz"[axis]);
        by = std::max(by, std::exp2(std::floor(std::log2(reach)) - 24));
      }
    }
  }
  if (!rounded.empty())
    result.report.digits.push_back("the " + rounded +
                                   " coordinates have more digits than a float holds and are rounded, by " +
                                   short_text(by) + " at most");
  const dvec3 scale = header_.scale, shift = header_.offset, origin = cloud.origin;
  parallel_tasks((positions_.size() + pass_size - 1) / pass_size, progress, "placing points",
                 [&](std::size_t task) {
                   const std::size_t last = std::min(positions_.size(), (task + 1) * pass_size);
                   for (std::size_t i = task * pass_size; i < last; ++i)
                     for (int axis = 0; axis < 3; ++axis) {
                       std::int32_t steps;
                       std::memcpy(&steps, &positions_[i][axis], sizeof steps);
                       positions_[i][axis] = float(scale[axis] * steps + shift[axis] - origin[axis]);
                     }
                 });
  cloud.positions = std::move(positions_);
}

void PointCollector::place_colors(ReadResult& result, Progress& progress) {
  if (color_columns_[0] < 0 || (colors_.empty() && !whole_)) return;
  ColorDepth depth;
  for (const auto& [r, g, b] : colors_) depth.add(r, g, b);
  const int bits = whole_ ? whole_->color_bits : depth.bits();
  if (bits == 0) {  // none has a colour, and black is one
    colors_ = {};
    return;
  }
  const bool is_8bit = bits == 8;
  result.cloud.las->color_bits = bits;
  if (bits < 16)
    result.report.notes.push_back("the 16-bit colours hold 0 to " + std::to_string(largest_of(bits)) +
                                  " and are taken as " + std::to_string(bits) + "-bit");
  if (const std::uint64_t beyond = depth.beyond(bits))
    result.report.notes.push_back(beyond_bits(beyond, bits));
  const auto most = std::uint16_t(largest_of(bits));
  std::vector<Rgba8>& colors = result.cloud.colors;
  allocate(colors, colors_.size());
  std::vector<float> low;
  if (!is_8bit) allocate(low, colors_.size());
  const std::size_t tasks = (colors_.size() + pass_size - 1) / pass_size;
  // Which of the two usual ways from 8 to 16 bits the file used, if any: then the low bytes are known.
  std::vector<char> repeats(tasks, bits == 16 && !whole_), shifts(tasks, !whole_);
  parallel_tasks(tasks, progress, "placing colours", [&](std::size_t task) {
    const std::size_t last = std::min(colors_.size(), (task + 1) * pass_size);
    for (std::size_t i = task * pass_size; i < last; ++i) {
      std::array<std::uint16_t, 3> c = colors_[i];
      if (bits < 16)
        for (std::uint16_t& value : c)
          value = std::uint16_t(std::min(value, most) << (is_8bit ? 0 : 16 - bits));
      if (is_8bit) {
        colors[i] = {std::uint8_t(c[0]), std::uint8_t(c[1]), std::uint8_t(c[2]), 255};
        continue;
      }
      const auto& [r, g, b] = c;
      colors[i] = {std::uint8_t(r >> 8), std::uint8_t(g >> 8), std::uint8_t(b >> 8), 255};
      low[i] = float((r & 255) << 16 | (g & 255) << 8 | (b & 255));
      if ((r & 255) != r >> 8 || (g & 255) != g >> 8 || (b & 255) != b >> 8) repeats[task] = 0;
      if (low[i] != 0) shifts[task] = 0;
    }
  });
  colors_ = {};
  auto all = [](const std::vector<char>& flags) {
    return std::find(flags.begin(), flags.end(), 0) == flags.end();
  };
  result.cloud.las->colors_shifted = !is_8bit && !whole_ && all(shifts);
  if (!is_8bit && (whole_ || (!all(shifts) && !all(repeats))))
    result.cloud.set_scalar({rgb_low_name, 0, std::move(low), StoredType::uint32});
}

void PointCollector::place_scalars(ReadResult& result, const Stats& total) {
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    Column& column = columns_[c];
    const Field& field = column.field;
    const FieldStats& stats = total.fields[c];
    const bool is_zero = !whole_ && stats.count == result.cloud.size() && stats.min == 0 && stats.max == 0;
    if (field.optional && is_zero) continue;
    // An extra field may carry what its standard namesake cannot (an intensity of 0 to 1): it stands for it.
    const bool is_replaced = std::any_of(columns_.begin(), columns_.end(), [&](const Column& other) {
      return other.field.is_extra && !field.is_extra && other.field.name == field.name;
    });
    if (is_replaced) continue;
    const double n = double(std::max<std::uint64_t>(1, stats.count));
    result.report.attributes.push_back(stats.count
                                           ? AttributeStats{field.name, stats.min, stats.max, stats.sum / n}
                                           : AttributeStats{field.name});
    if (field.is_color()) continue;
    // Two bytes that are seldom used cost eight in the cloud: nothing is lost by leaving zeros out.
    if (is_zero && field.is_left_out_as_zero()) continue;
    StoredType type = field.type;
    if (field.is_scaled()) type = field.is_extra ? StoredType::float64 : StoredType::float32;
    if ((field.is_scaled() || field.no_data) && field.is_extra)
      result.cloud.las->steps.push_back({field.name, field.type, field.scale, field.offset, field.no_data});
    numbers(column.values, *column.values_at);  // none was other than zero in a cloud that is not all there
    result.cloud.set_scalar({field.name, column.base, std::move(column.values), type});
    const bool has_residual = whole_ ? field.needs_residual() : stats.has_residual;
    if (has_residual) {
      numbers(column.residuals, *column.residuals_at);
      result.cloud.set_scalar(
          {field.name + residual_suffix, 0, std::move(column.residuals), StoredType::float32});
    }
    if (stats.is_inexact && !field.is_scaled())
      result.report.digits.push_back(field.name +
                                     " has more digits than are kept (48 bits around its first value)");
    column.values = {};
    column.residuals = {};
  }
}

void PointCollector::place_attributes(ReadResult& result) {
  PointCloud& cloud = result.cloud;
  const ScalarField *x = cloud.scalar("nx"), *y = cloud.scalar("ny"), *z = cloud.scalar("nz");
  if (x && y && z) {
    allocate(cloud.normals, cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const vec3 normal(float(x->value(i)), float(y->value(i)), float(z->value(i)));
      const float squared = glm::dot(normal, normal);
      if (!std::isfinite(squared) || squared == 0) ++result.report.normals_dropped;
      // Unit normals stay bit for bit: a float's rounding of the length is below 1e-5.
      else
        cloud.normals[i] = std::abs(squared - 1) < 1e-5f ? normal : normal / std::sqrt(squared);
    }
  }
  for_each_attribute([&](const auto& each) {
    auto& values = each.of(cloud);
    if constexpr (std::is_same_v<decltype(values), std::vector<float>&>)
      if (const ScalarField* field = cloud.scalar(each.components[0])) {
        values.resize(cloud.size());
        for (std::size_t i = 0; i < values.size(); ++i) values[i] = float(field->value(i));
      }
    if (values.empty() || each.stored != StoredType::float32) return;
    std::erase_if(cloud.scalars, [&](const ScalarField& field) {
      return std::find(each.components.begin(), each.components.end(), field.name) != each.components.end();
    });
  });
}

}  // namespace sfumato::io::las
