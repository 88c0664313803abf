#include "io/record.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "core/typed_attributes.h"

namespace sfumato::io {
namespace {

static_assert(std::endian::native == std::endian::little, "records are copied as they lie in memory");

template <class T>
bool all_fit(const ScalarField& field, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const double value = field.value(i);
    if (!(value >= double(std::numeric_limits<T>::lowest()) &&
          value <= double(std::numeric_limits<T>::max())) ||
        value != std::floor(value))
      return false;
  }
  return true;
}

/// The type that holds every value of the field: as stored in its file if that still does.
StoredType smallest_type(const ScalarField& field, std::size_t count) {
  bool fits = false;
  switch (field.type) {
    case StoredType::float32: fits = field.offset == 0; break;
    case StoredType::uint8: fits = all_fit<std::uint8_t>(field, count); break;
    case StoredType::int8: fits = all_fit<std::int8_t>(field, count); break;
    case StoredType::uint16: fits = all_fit<std::uint16_t>(field, count); break;
    case StoredType::int16: fits = all_fit<std::int16_t>(field, count); break;
    case StoredType::uint32: fits = all_fit<std::uint32_t>(field, count); break;
    case StoredType::int32: fits = all_fit<std::int32_t>(field, count); break;
    default: break;  // 64 bits are more than our numbers have
  }
  return fits ? field.type : StoredType::float64;
}

/// World coordinates are exact as floats.
bool positions_fit_floats(const PointCloud& cloud) {
  if (cloud.origin == dvec3(0)) return true;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const dvec3 p = cloud.world(i);
    if (dvec3(vec3(p)) != p) return false;
  }
  return true;
}

template <class T>
void put(std::vector<std::byte>& record, T value) {
  const std::size_t at = record.size();
  record.resize(at + sizeof value);
  std::memcpy(record.data() + at, &value, sizeof value);
}

}  // namespace

void put_as(std::vector<std::byte>& record, StoredType type, double value) {
  switch (type) {
    case StoredType::uint8: return put(record, std::uint8_t(value));
    case StoredType::int8: return put(record, std::int8_t(value));
    case StoredType::uint16: return put(record, std::uint16_t(value));
    case StoredType::int16: return put(record, std::int16_t(value));
    case StoredType::uint32: return put(record, std::uint32_t(value));
    case StoredType::int32: return put(record, std::int32_t(value));
    case StoredType::float32: return put(record, float(value));
    default: return put(record, value);
  }
}

void OutColumn::print(const PointCloud& cloud, std::size_t i, std::string& text) const {
  if (kind == Kind::position)
    return print_sum(cloud.origin[int(index)], cloud.positions[i][int(index)], text);
  if (kind == Kind::scalar)
    return print_sum(cloud.scalars[index].offset, cloud.scalars[index].values[i], text);
  print_sum(0, float(value(cloud, i)), text);
}

std::vector<OutColumn> columns_to_write(const PointCloud& cloud) {
  using Kind = OutColumn::Kind;
  std::vector<OutColumn> columns;
  const StoredType position = positions_fit_floats(cloud) ? StoredType::float32 : StoredType::float64;
  for (std::size_t axis = 0; axis < 3; ++axis)
    columns.push_back({std::string(1, "xyz"[axis]), position, Kind::position, axis,
                       [](const PointCloud& c, std::size_t i, std::size_t k) { return c.world(i)[int(k)]; }});
  for_each_attribute([&](const auto& each) {
    for (std::size_t k = 0; k < each.width && !each.of(cloud).empty(); ++k)
      columns.push_back({each.components[k], each.stored, Kind::attribute, k, each.number});
  });
  if (std::all_of(cloud.colors.begin(), cloud.colors.end(), [](const Rgba8& c) { return c.a == 255; }))
    std::erase_if(columns, [](const OutColumn& column) { return column.is("alpha"); });
  for (std::size_t k = 0; k < cloud.scalars.size(); ++k)
    columns.push_back(
        {cloud.scalars[k].name, smallest_type(cloud.scalars[k], cloud.size()), Kind::scalar, k,
         [](const PointCloud& c, std::size_t i, std::size_t n) { return c.scalars[n].value(i); }});
  return columns;
}

void print_sum(double origin, float local, std::string& text) {
  char buffer[64];
  char* const end = buffer + sizeof buffer;
  const double sum = origin + double(local);
  if (origin == 0 || !std::isfinite(sum)) {
    text.append(buffer, std::to_chars(buffer, end, local).ptr);
    return;
  }
  double power = 1;
  for (int decimals = 0; decimals <= 12; ++decimals, power *= 10) {
    const double rounded = std::round(sum * power) / power;
    if (float(rounded - origin) != local) continue;
    text.append(buffer, std::to_chars(buffer, end, rounded, std::chars_format::fixed, decimals).ptr);
    return;
  }
  text.append(buffer, std::to_chars(buffer, end, sum).ptr);
}

}  // namespace sfumato::io
