// Clouds as binary records: PLY, PCD 0.7, and NPY as a structured array (numpy.load gives one field for each
// number).
#include <algorithm>
#include <cctype>

#include "io/atomic_writer.h"
#include "io/format.h"
#include "io/record.h"

namespace sfumato::io {
namespace {

/// 'F', 'I' or 'U', and the bytes of a value.
std::pair<char, int> kind_of(StoredType type) {
  switch (type) {
    case StoredType::uint8: return {'U', 1};
    case StoredType::int8: return {'I', 1};
    case StoredType::uint16: return {'U', 2};
    case StoredType::int16: return {'I', 2};
    case StoredType::uint32: return {'U', 4};
    case StoredType::int32: return {'I', 4};
    case StoredType::float32: return {'F', 4};
    default: return {'F', 8};
  }
}

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

std::string header_text(std::string text, std::string_view unwanted, char instead = '_') {
  for (char& c : text)
    if (unwanted.find(c) != std::string_view::npos) c = instead;
  return text;
}

/// `packed_color`: the column in whose place the whole colour is written, in four bytes; or null.
void write_records(AtomicWriter& out, const PointCloud& cloud, const std::vector<OutColumn>& columns,
                   const OutColumn* packed_color, Progress& progress) {
  std::vector<std::byte> record;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (i % 65536 == 0) {
      progress.check();
      progress.update(double(i) / double(cloud.size()), "writing");
    }
    record.clear();
    for (const OutColumn& column : columns) {
      if (&column == packed_color) {
        const Rgba8 c = cloud.colors[i];
        for (std::uint8_t byte : {c.b, c.g, c.r, c.a}) put_as(record, StoredType::uint8, byte);
      } else {
        put_as(record, column.type, column.value(cloud, i));
      }
    }
    out.write(record);
  }
}

}  // namespace

WriteReport write_ply(const std::filesystem::path& file, const PointCloud& cloud, Progress& progress) {
  const std::vector<OutColumn> columns = columns_to_write(cloud);
  // What nobody said is no more certain afterwards: whoever draws the file looks for it in the points.
  std::string header = std::string("ply\nformat binary_little_endian 1.0\ncomment ") +
                       (cloud.up_is_known ? "up " : "usual_up ") + to_string(cloud.up) + "\n";
  if (!cloud.crs.empty()) header += "comment crs " + header_text(cloud.crs, "\r\n", ' ') + "\n";
  header += "element vertex " + std::to_string(cloud.size()) + "\n";
  for (const OutColumn& column : columns)
    header +=
        std::string("property ") + ply_name(column.type) + " " + header_text(column.name, " \t\r\n") + "\n";
  AtomicWriter out(file);
  out.write(header + "end_header\n");
  write_records(out, cloud, columns, nullptr, progress);
  out.commit();
  return {};
}

WriteReport write_pcd(const std::filesystem::path& file, const PointCloud& cloud, Progress& progress) {
  std::vector<OutColumn> columns = columns_to_write(cloud);
  const auto place_of = [&](std::string_view component) {
    return std::find_if(columns.begin(), columns.end(),
                        [&](const OutColumn& column) { return column.is(component); });
  };
  // The colour is one float that is four bytes: what every reader of PCD knows.
  const bool alpha = place_of("alpha") != columns.end();
  std::erase_if(columns, [](const OutColumn& column) {
    return column.is("green") || column.is("blue") || column.is("alpha");
  });
  const auto red = place_of("red");
  std::string names, sizes, types, counts;
  for (const OutColumn& column : columns) {
    auto [type, size] = kind_of(column.type);
    std::string name = header_text(column.name, " \t\r\n");
    if (column.is("nx") || column.is("ny") || column.is("nz")) name = "normal_" + name.substr(1);
    if (column.is("red")) name = alpha ? "rgba" : "rgb", type = alpha ? 'U' : 'F', size = 4;
    names += " " + name;
    sizes += " " + std::to_string(size);
    types += std::string(" ") + type;
    counts += " 1";
  }
  const std::string points = std::to_string(cloud.size());
  AtomicWriter out(file);
  out.write("# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS" + names + "\nSIZE" + sizes +
            "\nTYPE" + types + "\nCOUNT" + counts + "\nWIDTH " + points +
            "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + points + "\nDATA binary\n");
  write_records(out, cloud, columns, red == columns.end() ? nullptr : &*red, progress);
  out.commit();
  return {};
}

WriteReport write_npy_cloud(const std::filesystem::path& file, const PointCloud& cloud, Progress& progress) {
  const std::vector<OutColumn> columns = columns_to_write(cloud);
  std::string header = "{'descr': [";
  for (const OutColumn& column : columns) {
    const auto [type, size] = kind_of(column.type);
    header += "('" + header_text(column.name, "'\\\r\n") + "', '" + (size == 1 ? "|" : "<") +
              std::string(1, char(std::tolower(type))) + std::to_string(size) + "'), ";
  }
  header += "], 'fortran_order': False, 'shape': (" + std::to_string(cloud.size()) + ",), }";
  // Magic, version 2.0 (four bytes of length: many long names fit), header: together a multiple of 64 bytes.
  const std::size_t preamble = 12;
  header.append(63 - (preamble + header.size()) % 64, ' ');
  header += '\n';
  AtomicWriter out(file);
  out.write(std::string_view("\x93NUMPY\x02\x00", 8));
  std::string length;
  for (int k = 0; k < 4; ++k) length += char(header.size() >> (8 * k) & 255);
  out.write(length);
  out.write(header);
  write_records(out, cloud, columns, nullptr, progress);
  out.commit();
  return {};
}

}  // namespace sfumato::io
