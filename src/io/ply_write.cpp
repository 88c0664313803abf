// Binary little-endian PLY with everything a cloud has.
#include "io/atomic_writer.h"
#include "io/format.h"
#include "io/record.h"

namespace sfumato::io {
namespace {

const char* ply_name(StoredType type) {
  switch (type) {
    case StoredType::uint8: return "uchar";
    case StoredType::int8: return "char";
    case StoredType::uint16: return "ushort";
    case StoredType::int16: return "short";
    case StoredType::uint32: return "uint";
    case StoredType::int32: return "int";
    case StoredType::float32: return "float";
    default: return "double";  // PLY has no 64-bit integers
  }
}

/// Header words end at blanks and lines at line ends, so names and texts must not hold them.
std::string header_text(std::string text, std::string_view unwanted) {
  for (char& c : text)
    if (unwanted.find(c) != std::string_view::npos) c = unwanted.size() > 2 ? '_' : ' ';
  return text;
}

}  // namespace

WriteReport write_ply(const std::filesystem::path& file, const PointCloud& cloud, Progress& progress) {
  const bool floats = positions_fit_floats(cloud);
  bool alpha = false;
  for (const Rgba8& c : cloud.colors) alpha = alpha || c.a != 255;
  std::vector<StoredType> types;
  for (const ScalarField& field : cloud.scalars) types.push_back(smallest_type(field, cloud.size()));

  // What nobody said is no more certain afterwards: whoever draws the file looks for it in the points.
  std::string header = std::string("ply\nformat binary_little_endian 1.0\ncomment ") +
                       (cloud.up_is_known ? "up " : "usual_up ") + to_string(cloud.up) + "\n";
  if (!cloud.crs.empty()) header += "comment crs " + header_text(cloud.crs, "\r\n") + "\n";
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
    property(ply_name(types[k]), header_text(cloud.scalars[k].name, " \t\r\n"));
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
  return {};
}

}  // namespace sfumato::io
