// Binary little-endian PLY with everything a cloud has.
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "io/atomic_writer.h"
#include "io/format.h"

namespace sfumato::io {
namespace {

static_assert(std::endian::native == std::endian::little, "records are copied as they lie in memory");

const char* ply_name(StoredType type) {
  switch (type) {
    case StoredType::uint8:
      return "uchar";
    case StoredType::int8:
      return "char";
    case StoredType::uint16:
      return "ushort";
    case StoredType::int16:
      return "short";
    case StoredType::uint32:
      return "uint";
    case StoredType::int32:
      return "int";
    case StoredType::float32:
      return "float";
    default:
      return "double";  // PLY has no 64-bit integers
  }
}

/// The type that holds every value of the field: as stored in its file if that still does.
StoredType type_of(const ScalarField& field, std::size_t count) {
  if (field.type == StoredType::float32) return field.offset == 0 ? field.type : StoredType::float64;
  if (field.type == StoredType::float64 || field.type == StoredType::uint64 ||
      field.type == StoredType::int64)
    return StoredType::float64;
  const auto fits = [&](double low, double high) {
    for (std::size_t i = 0; i < count; ++i) {
      const double value = field.value(i);
      if (!(value >= low && value <= high) || value != std::floor(value)) return false;
    }
    return true;
  };
  const auto fits_type = [&](auto limits) { return fits(double(limits.lowest()), double(limits.max())); };
  bool ok = false;
  switch (field.type) {
    case StoredType::uint8:
      ok = fits_type(std::numeric_limits<std::uint8_t>());
      break;
    case StoredType::int8:
      ok = fits_type(std::numeric_limits<std::int8_t>());
      break;
    case StoredType::uint16:
      ok = fits_type(std::numeric_limits<std::uint16_t>());
      break;
    case StoredType::int16:
      ok = fits_type(std::numeric_limits<std::int16_t>());
      break;
    case StoredType::uint32:
      ok = fits_type(std::numeric_limits<std::uint32_t>());
      break;
    case StoredType::int32:
      ok = fits_type(std::numeric_limits<std::int32_t>());
      break;
    default:
      break;
  }
  return ok ? field.type : StoredType::float64;
}

template <class T>
void put(std::vector<std::byte>& record, T value) {
  const std::size_t at = record.size();
  record.resize(at + sizeof value);
  std::memcpy(record.data() + at, &value, sizeof value);
}

void put_as(std::vector<std::byte>& record, StoredType type, double value) {
  switch (type) {
    case StoredType::uint8:
      return put(record, std::uint8_t(value));
    case StoredType::int8:
      return put(record, std::int8_t(value));
    case StoredType::uint16:
      return put(record, std::uint16_t(value));
    case StoredType::int16:
      return put(record, std::int16_t(value));
    case StoredType::uint32:
      return put(record, std::uint32_t(value));
    case StoredType::int32:
      return put(record, std::int32_t(value));
    case StoredType::float32:
      return put(record, float(value));
    default:
      return put(record, value);
  }
}

/// Header words end at blanks and lines at line ends, so names and texts must not hold them.
std::string without(std::string text, std::string_view unwanted) {
  for (char& c : text)
    if (unwanted.find(c) != std::string_view::npos) c = unwanted.size() > 2 ? '_' : ' ';
  return text;
}

bool all_exact_as_float(const PointCloud& cloud) {
  if (cloud.origin == dvec3(0)) return true;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const dvec3 p = cloud.world(i);
    if (dvec3(vec3(p)) != p) return false;
  }
  return true;
}

}  // namespace

void write_ply(const std::filesystem::path& file, const PointCloud& cloud, Progress& progress) {
  const bool floats = all_exact_as_float(cloud);
  bool alpha = false;
  for (const Rgba8& c : cloud.colors) alpha = alpha || c.a != 255;
  std::vector<StoredType> types;
  for (const ScalarField& field : cloud.scalars) types.push_back(type_of(field, cloud.size()));

  std::string header = "ply\nformat binary_little_endian 1.0\ncomment up " + to_string(cloud.up) + "\n";
  if (!cloud.crs.empty()) header += "comment crs " + without(cloud.crs, "\r\n") + "\n";
  header += "element vertex " + std::to_string(cloud.size()) + "\n";
  const auto property = [&](const std::string& type, const std::string& name) {
    header += "property " + type + " " + name + "\n";
  };
  for (const char* name : {"x", "y", "z"}) property(floats ? "float" : "double", name);
  if (!cloud.normals.empty())
    for (const char* name : {"nx", "ny", "nz"}) property("float", name);
  if (!cloud.colors.empty())
    for (const char* name : {"red", "green", "blue"}) property("uchar", name);
  if (alpha) property("uchar", "alpha");
  if (!cloud.radii.empty()) property("float", "radius");
  for (std::size_t k = 0; k < types.size(); ++k)
    property(ply_name(types[k]), without(cloud.scalars[k].name, " \t\r\n"));
  header += "end_header\n";

  AtomicWriter out(file);
  out.write(header);
  std::vector<std::byte> record;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (i % 65536 == 0) {
      progress.check();
      progress.update(double(i) / double(cloud.size()), "writing");
    }
    record.clear();
    if (floats)
      put(record, vec3(cloud.world(i)));
    else
      put(record, cloud.world(i));
    if (!cloud.normals.empty()) put(record, cloud.normals[i]);
    if (!cloud.colors.empty()) {
      const Rgba8 c = cloud.colors[i];
      put(record, c.r), put(record, c.g), put(record, c.b);
      if (alpha) put(record, c.a);
    }
    if (!cloud.radii.empty()) put(record, cloud.radii[i]);
    for (std::size_t k = 0; k < types.size(); ++k) put_as(record, types[k], cloud.scalars[k].value(i));
    out.write(record);
  }
  out.commit();
}

}  // namespace sfumato::io
