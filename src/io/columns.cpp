#include "io/columns.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string_view>
#include <utility>
#include "core/lower_case.h"

namespace sfumato::io {
namespace {

/// The role that a column of this name plays, by the names common programs write.
Role role_of(std::string name) {
  name = lower_case(name);
  static const std::pair<Role, std::vector<std::string>> names[] = {
      {Role::x, {"x"}},
      {Role::y, {"y"}},
      {Role::z, {"z"}},
      {Role::nx, {"nx", "normal_x", "normalx", "nor:normalx"}},
      {Role::ny, {"ny", "normal_y", "normaly", "nor:normaly"}},
      {Role::nz, {"nz", "normal_z", "normalz", "nor:normalz"}},
      {Role::red, {"red", "r", "diffuse_red", "rf", "colorred", "rgb:0", "rgb_0"}},
      {Role::green, {"green", "g", "diffuse_green", "gf", "colorgreen", "rgb:1", "rgb_1"}},
      {Role::blue, {"blue", "b", "diffuse_blue", "bf", "colorblue", "rgb:2", "rgb_2"}},
      {Role::alpha, {"alpha", "a", "diffuse_alpha"}},
      {Role::radius, {"radius"}}};
  for (const auto& [role, words] : names)
    if (std::find(words.begin(), words.end(), name) != words.end()) return role;
  return Role::scalar;
}

}  // namespace

bool is_wide(StoredType type) {
  return type == StoredType::float64 || type == StoredType::int32 || type == StoredType::uint32 ||
         type == StoredType::int64 || type == StoredType::uint64;
}

bool is_integer(StoredType type) { return type != StoredType::float32 && type != StoredType::float64; }

int column_of(const std::vector<Column>& columns, Role role) {
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (columns[i].role == role) return int(i);
  return -1;
}

std::size_t size_of(StoredType type) {
  switch (type) {
    case StoredType::uint8:
    case StoredType::int8: return 1;
    case StoredType::uint16:
    case StoredType::int16: return 2;
    case StoredType::uint32:
    case StoredType::int32:
    case StoredType::float32: return 4;
    case StoredType::uint64:
    case StoredType::int64:
    case StoredType::float64: return 8;
  }
  return 0;
}

double number_of(StoredType type, const std::byte* bytes) {
  const auto as = [&]<class T>(T value) {
    std::memcpy(&value, bytes, sizeof value);
    return double(value);
  };
  switch (type) {
    case StoredType::uint8: return as(std::uint8_t());
    case StoredType::int8: return as(std::int8_t());
    case StoredType::uint16: return as(std::uint16_t());
    case StoredType::int16: return as(std::int16_t());
    case StoredType::uint32: return as(std::uint32_t());
    case StoredType::int32: return as(std::int32_t());
    case StoredType::uint64: return as(std::uint64_t());
    case StoredType::int64: return as(std::int64_t());
    case StoredType::float32: return as(float());
    case StoredType::float64: return as(double());
  }
  return 0;
}

void Stats::merge(const Stats& other) {
  min = std::min(min, other.min);
  max = std::max(max, other.max);
  sum += other.sum;
  count += other.count;
}

bool assign_roles(std::vector<Column>& columns) {
  for (Column& column : columns) {
    if (column.role == Role::skip) continue;
    column.role = Role::scalar;
    // Of two columns of one name the first counts, and of two spellings of one role as well.
    const Role role = role_of(column.name);
    if (column_of(columns, role) < 0 || role == Role::scalar) column.role = role;
  }
  const auto demote = [&](std::initializer_list<Role> group) {
    const bool complete =
        std::all_of(group.begin(), group.end(), [&](Role role) { return column_of(columns, role) >= 0; });
    for (Column& column : columns)
      if (!complete && std::find(group.begin(), group.end(), column.role) != group.end())
        column.role = Role::scalar;
    return complete;
  };
  demote({Role::nx, Role::ny, Role::nz});
  if (!demote({Role::red, Role::green, Role::blue}))
    demote({Role::red, Role::green, Role::blue, Role::alpha});
  return demote({Role::x, Role::y, Role::z});
}

void use_usual_names(std::vector<Column>& columns) {
  static const std::pair<std::string_view, std::string_view> usual[] = {
      {"intensity", "intensity"},
      {"classification", "classification"},
      {"class", "classification"},
      {"return_number", "return_number"},
      {"number_of_returns", "number_of_returns"},
      {"gps_time", "gps_time"},
      {"gpstime", "gps_time"},
      {"scan_angle", "scan_angle"},
      {"scan_angle_rank", "scan_angle"},
      {"scanner_channel", "scanner_channel"},
      {"scan_channel", "scanner_channel"},
      {"scanchannel", "scanner_channel"},  // of PDAL
      {"user_data", "user_data"},
      {"point_source_id", "point_source_id"}};
  for (Column& column : columns) {
    if (column.role != Role::scalar) continue;
    std::string plain = column.name;
    constexpr std::string_view prefix = "scalar_";
    if (plain.starts_with(prefix)) plain.erase(0, prefix.size());
    for (char& c : plain) c = c == ' ' || c == '-' ? '_' : char(std::tolower(static_cast<unsigned char>(c)));
    for (const auto& [theirs, ours] : usual) {
      if (plain != theirs) continue;
      const std::string_view name = ours;  // clang 14 captures no bindings
      const bool is_taken = std::any_of(columns.begin(), columns.end(),
                                        [&](const Column& other) { return other.name == name; });
      if (!is_taken) column.name = name;
    }
  }
}

void lay_out_as_doubles(std::vector<Column>& columns) {
  for (std::size_t k = 0; k < columns.size(); ++k) {
    columns[k].layout = StoredType::float64;
    columns[k].offset = k * sizeof(double);
    columns[k].stride = columns.size() * sizeof(double);
  }
}

dvec3 choose_origin(const dvec3& min, const dvec3& max, bool as_float) {
  const double widest = std::max({max.x - min.x, max.y - min.y, max.z - min.z});
  dvec3 origin(0);
  for (int k = 0; k < 3; ++k) {
    const double largest = std::max(std::abs(min[k]), std::abs(max[k])), own = max[k] - min[k];
    if (largest < 1e-30) continue;  // the steps below would be no numbers
    // Degrees beside metres: floats would leave fewer than a thousand steps of that axis alone.
    const bool is_finer = !as_float && own > 0 && own < largest * 1000 * 0x1p-23;
    const double extent = is_finer ? own : widest;
    // Floats at 16 times the extent still resolve a millionth of it.
    if (largest <= 16 * extent || (extent == 0 && double(float(min[k])) == min[k])) continue;
    // A multiple of a power of two no finer than float's step at these numbers: float - origin is then exact.
    const double step = std::exp2(std::max(std::floor(std::log2(std::max(extent / 8, largest * 0x1p-60))),
                                           std::floor(std::log2(largest)) - (as_float ? 23 : 52)));
    origin[k] = std::round(0.5 * (min[k] + max[k]) / step) * step;
  }
  return origin;
}

std::string short_text(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g", number);
  return text;
}

ScalarField make_scalar(std::string name, StoredType type, const std::vector<double>& values,
                        const Stats& stats, std::optional<double> offset) {
  ScalarField field{std::move(name), offset.value_or(0), {}, type};
  if (stats.count > 0 && !offset) {
    const double largest = std::max(std::abs(stats.min), std::abs(stats.max)), range = stats.max - stats.min;
    if (largest > 16 * range || (is_integer(type) && largest > 0x1p24)) {
      // Float holds what all values share? Then no offset is needed; else the middle, whole for whole
      // numbers.
      const bool exact = std::all_of(values.begin(), values.end(),
                                     [](double v) { return !std::isfinite(v) || double(float(v)) == v; });
      if (!exact)
        field.offset = is_integer(type) || range > 64 ? std::round(stats.min + 0.5 * range) : stats.min;
    }
  }
  field.values.resize(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) field.values[i] = float(values[i] - field.offset);
  return field;
}

}  // namespace sfumato::io
