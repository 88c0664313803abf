#include "io/las_layout.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <set>

#include "core/counted.h"
#include "core/typed_attributes.h"

namespace sfumato::io::las {
namespace {

constexpr double int32_reach = 2147483647.0;

std::string text_of(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", number);
  return text;
}

/// Of the values that are numbers.
struct Range {
  double low = 0, high = 0;
  bool is_whole = true;
  std::size_t missing = 0;  ///< those that are none
};

Range range_of(const Source& source, const PointCloud& cloud) {
  Range range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double value = source.value(cloud, i);
    if (std::isnan(value)) {
      ++range.missing;
      continue;
    }
    range.is_whole &= value == std::trunc(value);
    range.low = std::min(range.low, value);
    range.high = std::max(range.high, value);
  }
  if (range.missing == cloud.size()) range.low = range.high = 0;
  return range;
}

// Least and largest value of an integer type; floats reach everywhere.
std::pair<double, double> limits_of(const Field& field) {
  if (field.bits) return {0, double((1 << field.bits) - 1)};
  switch (field.type) {
    case StoredType::uint8: return {0, 255};
    case StoredType::int8: return {-128, 127};
    case StoredType::uint16: return {0, 65535};
    case StoredType::int16: return {-32768, 32767};
    case StoredType::uint32: return {0, 4294967295.0};
    case StoredType::int32: return {-2147483648.0, int32_reach};
    // Beyond 2^53 a double skips whole numbers.
    case StoredType::uint64: return {0, 9007199254740992.0};
    case StoredType::int64: return {-9007199254740992.0, 9007199254740992.0};
    default: return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  }
}

bool is_float(StoredType type) { return type == StoredType::float32 || type == StoredType::float64; }

/// What is no number fits as well: a standard dimension has a number for it (Source::missing).
bool fits(const Range& range, const Field& field) {
  if (is_float(field.type)) return true;
  const auto [low, high] = limits_of(field);
  const bool is_stepped = field.scale != 1;  // the scan angle of formats 6 to 10, in 0.006 degrees
  return (is_stepped || range.is_whole) && range.low >= low * field.scale && range.high <= high * field.scale;
}

bool is_rank(const Range& range) { return range.is_whole && range.low >= -128 && range.high <= 127; }

// Wave packets are not kept: their formats become the same ones without them.
int without_waves(int format) {
  switch (format) {
    case 4: return 1;
    case 5: return 3;
    case 9: return 6;
    case 10: return 8;
    default: return format;
  }
}

const Field* find(const std::vector<Field>& fields, const std::string& name) {
  for (const Field& field : fields)
    if (field.name == name) return &field;
  return nullptr;
}

// The format with the fewest bytes that has what the cloud needs: of formats 0 to 3, or of 6 to 8.
int least_format(bool is_extended, bool gps_time, bool color, bool nir) {
  if (is_extended) return nir ? 8 : color ? 7 : 6;
  return (gps_time ? 1 : 0) + (color ? 2 : 0);
}

template <class T>
T clamped(double value) {
  if (!std::isfinite(value)) return 0;
  return T(std::clamp(std::round(value), double(std::numeric_limits<T>::min()),
                      double(std::numeric_limits<T>::max())));
}

void put_value(const Field& field, double value, std::uint8_t* record) {
  std::uint8_t* at = record + field.byte;
  if (field.bits) {
    *at = std::uint8_t(*at | (unsigned(clamped<std::uint8_t>(value)) & ((1u << field.bits) - 1))
                                 << field.shift);
    return;
  }
  if (std::isnan(value) && field.no_data)
    value = *field.no_data;
  else if (field.is_scaled())
    value = (value - field.offset) / field.scale;
  switch (field.type) {
    case StoredType::uint8: return put(at, clamped<std::uint8_t>(value));
    case StoredType::int8: return put(at, clamped<std::int8_t>(value));
    case StoredType::uint16: return put(at, clamped<std::uint16_t>(value));
    case StoredType::int16: return put(at, clamped<std::int16_t>(value));
    case StoredType::uint32: return put(at, clamped<std::uint32_t>(value));
    case StoredType::int32: return put(at, clamped<std::int32_t>(value));
    case StoredType::uint64: return put(at, std::uint64_t(std::max(0.0, std::round(value))));
    case StoredType::int64: return put(at, std::int64_t(std::round(value)));
    case StoredType::float32: return put(at, float(value));
    case StoredType::float64: return put(at, value);
  }
}

// The cloud's own scaling when it reaches all points; else powers of ten near a float's precision.
void choose_scaling(const PointCloud& cloud, WriteLayout& layout) {
  const Bounds box = bounds(cloud);
  if (cloud.las) {
    layout.scale = cloud.las->scale;
    layout.offset = cloud.las->offset;
    bool reaches = true;
    for (int axis = 0; axis < 3; ++axis)
      reaches &= layout.scale[axis] != 0 && std::max(std::abs(box.min[axis] - layout.offset[axis]),
                                                     std::abs(box.max[axis] - layout.offset[axis])) <
                                                std::abs(layout.scale[axis]) * (int32_reach - 1);
    if (reaches) return;
  }
  // 2^23 steps over the cloud: a float relative to its centre is no finer. The cloud is where most points
  // are: one that strays far off makes the step only as coarse as 2^32 steps over everything must be, and on
  // its own axis.
  const Bounds most = robust_bounds(cloud);
  const auto extent_of = [](const Bounds& b) { return std::max({b.size().x, b.size().y, b.size().z}); };
  const double extent = extent_of(most) > 0 ? extent_of(most) : std::max(extent_of(box), 1e-9);
  const double wanted = std::pow(10, std::floor(std::log10(extent / 8388608.0)));
  for (int axis = 0; axis < 3; ++axis) {
    const double needed = box.size()[axis] / (2 * (int32_reach - 2));
    double& scale = layout.scale[axis];
    scale = needed > wanted ? std::pow(10, std::ceil(std::log10(needed))) : wanted;
    layout.offset[axis] = std::round(box.center()[axis] / scale) * scale;
    if (!(scale * 2147483648.0 + std::abs(layout.offset[axis]) < largest_coordinate))
      throw Error(ErrorCode::usage, "the cloud reaches " + text_of(box.max[axis]) +
                                        ", and LAS coordinates end at 1e15; "
                                        "crop the cloud or write .ply");
    if (scale > extent / 1024)
      throw Error(ErrorCode::usage, "outliers reach " + text_of(box.size()[axis]) + " along " + "xyz"[axis] +
                                        ", so that LAS would need steps of " + text_of(scale) +
                                        " for a cloud of " + text_of(extent) +
                                        "; crop the cloud or write .ply");
  }
  const double step = std::max({layout.scale.x, layout.scale.y, layout.scale.z});
  layout.notes.push_back(
      "coordinates are written in steps of " + text_of(step) +
      (step > wanted ? ", because of far outliers: points move by up to half of that" : ""));
}

std::vector<Source> sources_of(const PointCloud& cloud) {
  std::vector<Source> sources;
  auto residual_of = [&](const std::string& name) { return cloud.scalar(name + residual_suffix); };
  for (const ScalarField& scalar : cloud.scalars) {
    const std::string& name = scalar.name;
    const bool is_residual =
        name == rgb_low_name || (name.ends_with(residual_suffix) &&
                                 cloud.scalar(name.substr(0, name.size() - residual_suffix.size())));
    if (is_residual && !(name == rgb_low_name && cloud.colors.empty())) continue;
    sources.push_back({Field{name, scalar.type}, &scalar, residual_of(name)});
  }
  for_each_attribute([&](const auto& each) {
    if (each.stored != StoredType::float32 || each.of(cloud).empty()) return;  // colours have fields of LAS
    for (std::size_t k = 0; k < each.width; ++k)
      sources.push_back({Field{each.components[k], each.stored}, nullptr, nullptr, each.number, k});
  });
  return sources;
}

// The step of the scalar's file when all values still lie on it: a hundredth is more than a float's rounding
// of 16 bits, or two floats' of 32, makes of it.
std::optional<LasStep> step_of(const Source& source, const PointCloud& cloud) {
  if (!cloud.las || !source.scalar) return std::nullopt;
  for (const LasStep& step : cloud.las->steps) {
    if (step.name != source.scalar->name) continue;
    const auto [low, high] = limits_of(Field{step.name, step.type});
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const double number = (source.value(cloud, i) - step.offset) / step.scale;
      if (is_float(step.type) || (step.no_data && std::isnan(number))) continue;
      if (!(std::abs(number - std::round(number)) < 0.01 && std::round(number) >= low &&
            std::round(number) <= high))
        return std::nullopt;
    }
    return step;
  }
  return std::nullopt;
}

// A type that holds the values: the one of the scalar's file, else a float, of 64 bits when the value is a
// sum.
StoredType extra_type(const Source& source, const Range& range) {
  if (range.missing == 0 && !is_float(source.field.type) && fits(range, source.field))
    return source.field.type;
  if (source.residual || (source.scalar && source.scalar->offset != 0)) return StoredType::float64;
  return source.field.type == StoredType::float64 ? StoredType::float64 : StoredType::float32;
}

}  // namespace

double Source::value(const PointCloud& cloud, std::size_t i) const {
  if (number) return number(cloud, i, component);
  if (!residual) return scalar->value(i);
  const double rest = residual->value(i);
  // The two parts first: their sum is exact, and only then meets the large offset.
  return std::isfinite(rest) ? scalar->offset + (double(scalar->values[i]) + rest) : scalar->value(i);
}

WriteLayout choose_layout(const PointCloud& cloud) {
  WriteLayout layout;
  choose_scaling(cloud, layout);
  if (cloud.las) {
    layout.colors_shifted = cloud.las->colors_shifted;
    layout.color_bits = cloud.las->color_bits;
  }
  std::vector<Source> sources = sources_of(cloud);
  std::vector<Range> ranges;
  for (const Source& source : sources) ranges.push_back(range_of(source, cloud));

  // Formats 0 to 5 have no room for classes above 31, more than 7 returns, fractions of degrees, ...
  const std::vector<Field> old_fields = standard_fields(3), new_fields = standard_fields(8);
  bool needs_extended = cloud.las && cloud.las->point_format >= 6, gps_time = false, nir = false;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const std::string& name = sources[i].field.name;
    gps_time |= name == "gps_time";
    nir |= name == "nir" && fits(ranges[i], *find(new_fields, name));
    const Field *old_field = find(old_fields, name), *new_field = find(new_fields, name);
    if (!new_field || !fits(ranges[i], *new_field)) continue;
    needs_extended |= name == "scan_angle" ? !is_rank(ranges[i]) : !old_field || !fits(ranges[i], *old_field);
  }
  layout.format = least_format(needs_extended, gps_time, !cloud.colors.empty(), nir);
  if (cloud.las && cloud.las->point_format >= 0) {
    const int own = without_waves(cloud.las->point_format);
    const bool has_all = has_gps_time(own) >= gps_time && has_color(own) >= !cloud.colors.empty() &&
                         (own == 8) >= nir && (own >= 6) >= needs_extended;
    if (has_all) layout.format = own;
  }

  const std::vector<Field> standard = standard_fields(layout.format);
  std::size_t byte = min_record_length[std::size_t(layout.format)];
  std::set<std::string> names;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    Source& source = sources[i];
    const Field* field = find(standard, source.field.name);
    if (field && !field->is_color() && fits(ranges[i], *field)) {
      source.field = *field;
      if (!is_float(field->type)) {
        source.missing = field->name == "return_number" || field->name == "number_of_returns";
        if (ranges[i].missing > 0)
          layout.notes.push_back(counted(ranges[i].missing, "point") +
                                 (ranges[i].missing == 1 ? " has no " : " have no ") + field->name +
                                 ": it is written as " + text_of(source.missing));
      }
    } else {
      if (const std::optional<LasStep> step = step_of(source, cloud)) {
        source.field.type = step->type;
        source.field.scale = step->scale;
        source.field.offset = step->offset;
        source.field.no_data = step->no_data;
      } else {
        source.field.type = extra_type(source, ranges[i]);
      }
      source.field.is_extra = true;
      source.field.byte = std::uint16_t(byte);
      // A LAS name has 32 bytes; shortened ones must stay different.
      std::string name = source.field.name.substr(0, 32);
      for (int k = 2; !names.insert(name).second; ++k)
        name = source.field.name.substr(0, 28) + "_" + std::to_string(k);
      source.field.name = name;
      byte += size_of(source.field.type);
      layout.extra.push_back(source.field);
    }
    if (byte > 65535)
      throw Error(ErrorCode::usage, "the cloud has " + std::to_string(sources.size()) +
                                        " attributes, more than a LAS record holds; write .ply instead");
    layout.sources.push_back(source);
  }
  layout.record_length = std::uint16_t(byte);
  return layout;
}

std::array<std::int32_t, 3> WriteLayout::steps(const PointCloud& cloud, std::size_t i) const {
  std::array<std::int32_t, 3> result;
  const dvec3 world = cloud.world(i);
  for (int axis = 0; axis < 3; ++axis)
    result[std::size_t(axis)] = clamped<std::int32_t>((world[axis] - offset[axis]) / scale[axis]);
  return result;
}

void WriteLayout::pack(const PointCloud& cloud, std::size_t first, std::size_t count,
                       std::uint8_t* records) const {
  const ScalarField* low = cloud.scalar(rgb_low_name);
  const std::size_t color = !cloud.colors.empty() ? find(standard_fields(format), "red")->byte : 0;
  // A scan without return numbers has one return a point.
  const bool has_number = cloud.scalar("return_number"), has_total = cloud.scalar("number_of_returns");
  for (std::size_t i = first; i < first + count; ++i) {
    std::uint8_t* record = records + (i - first) * record_length;
    const std::array<std::int32_t, 3> xyz = steps(cloud, i);
    std::memcpy(record, xyz.data(), sizeof xyz);
    if (!has_number) record[14] = 1;
    if (!has_total) record[14] = std::uint8_t(record[14] | 1 << (format >= 6 ? 4 : 3));
    for (const Source& source : sources) {
      const double value = source.value(cloud, i);
      put_value(source.field, std::isnan(value) ? source.missing : value, record);
    }
    if (cloud.colors.empty()) continue;
    const Rgba8& rgba = cloud.colors[i];
    const bool is_absent = rgba == no_color;  // written as white: LAS has no other word for it
    const double packed = low ? low->value(i) : 0;
    const bool has_low = low && std::isfinite(packed) && !is_absent;
    const auto low_bytes = std::uint32_t(has_low ? packed : 0);
    const std::uint8_t channels[3] = {rgba.r, rgba.g, rgba.b};
    for (unsigned c = 0; c < 3; ++c) {
      const unsigned high = channels[c];
      const unsigned rest = has_low                        ? (low_bytes >> (16 - 8 * c)) & 255
                            : colors_shifted && !is_absent ? 0
                                                           : high;
      put<std::uint16_t>(record + color + 2 * c, std::uint16_t((high << 8 | rest) >> (16 - color_bits)));
    }
  }
}

}  // namespace sfumato::io::las
