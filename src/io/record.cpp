#include "io/record.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

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

}  // namespace

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

template void put(std::vector<std::byte>&, vec3);
template void put(std::vector<std::byte>&, dvec3);
template void put(std::vector<std::byte>&, float);
template void put(std::vector<std::byte>&, std::uint8_t);

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

double OutColumn::value(const PointCloud& cloud, std::size_t i) const {
  switch (source) {
    case Source::x:
    case Source::y:
    case Source::z: return cloud.world(i)[int(source)];
    case Source::nx:
    case Source::ny:
    case Source::nz: return cloud.normals[i][int(source) - int(Source::nx)];
    case Source::red: return cloud.colors[i].r;
    case Source::green: return cloud.colors[i].g;
    case Source::blue: return cloud.colors[i].b;
    case Source::alpha: return cloud.colors[i].a;
    case Source::radius: return cloud.radii[i];
    case Source::scalar: return cloud.scalars[scalar].value(i);
  }
  return 0;
}

void OutColumn::print(const PointCloud& cloud, std::size_t i, std::string& text) const {
  if (int(source) <= int(Source::z))
    return print_sum(cloud.origin[int(source)], cloud.positions[i][int(source)], text);
  if (source == Source::scalar)
    return print_sum(cloud.scalars[scalar].offset, cloud.scalars[scalar].values[i], text);
  print_sum(0, float(value(cloud, i)), text);
}

std::vector<OutColumn> columns_to_write(const PointCloud& cloud) {
  using Source = OutColumn::Source;
  std::vector<OutColumn> columns;
  const StoredType position = positions_fit_floats(cloud) ? StoredType::float32 : StoredType::float64;
  const auto add = [&](std::initializer_list<const char*> names, Source first, StoredType type) {
    int k = 0;
    for (const char* name : names) columns.push_back({name, type, Source(int(first) + k++)});
  };
  add({"x", "y", "z"}, Source::x, position);
  if (!cloud.normals.empty()) add({"nx", "ny", "nz"}, Source::nx, StoredType::float32);
  if (!cloud.colors.empty()) add({"red", "green", "blue"}, Source::red, StoredType::uint8);
  if (std::any_of(cloud.colors.begin(), cloud.colors.end(), [](const Rgba8& c) { return c.a != 255; }))
    add({"alpha"}, Source::alpha, StoredType::uint8);
  if (!cloud.radii.empty()) add({"radius"}, Source::radius, StoredType::float32);
  for (std::size_t k = 0; k < cloud.scalars.size(); ++k)
    columns.push_back(
        {cloud.scalars[k].name, smallest_type(cloud.scalars[k], cloud.size()), Source::scalar, k});
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
