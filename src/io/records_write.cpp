// Clouds as binary records: PCD 0.7, and NPY as a structured array (numpy.load gives one field for each
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

std::string column_name(std::string text, std::string_view unwanted) {
  for (char& c : text)
    if (unwanted.find(c) != std::string_view::npos) c = '_';
  return text;
}

void write_records(AtomicWriter& out, const PointCloud& cloud, const std::vector<OutColumn>& columns,
                   bool packed_color, Progress& progress) {
  using Source = OutColumn::Source;
  std::vector<std::byte> record;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (i % 65536 == 0) {
      progress.check();
      progress.update(double(i) / double(cloud.size()), "writing");
    }
    record.clear();
    for (const OutColumn& column : columns) {
      if (packed_color && column.source == Source::red) {
        const Rgba8 c = cloud.colors[i];
        for (std::uint8_t byte : {c.b, c.g, c.r, c.a}) put_as(record, StoredType::uint8, byte);
      } else if (packed_color && int(column.source) >= int(Source::green) &&
                 int(column.source) <= int(Source::alpha)) {
        continue;
      } else {
        put_as(record, column.type, column.value(cloud, i));
      }
    }
    out.write(record);
  }
}

}  // namespace

WriteReport write_pcd(const std::filesystem::path& file, const PointCloud& cloud, Progress& progress) {
  using Source = OutColumn::Source;
  const std::vector<OutColumn> columns = columns_to_write(cloud);
  const bool alpha = std::any_of(columns.begin(), columns.end(),
                                 [](const OutColumn& column) { return column.source == Source::alpha; });
  std::string names, sizes, types, counts;
  for (const OutColumn& column : columns) {
    auto [type, size] = kind_of(column.type);
    std::string name = column_name(column.name, " \t\r\n");
    if (column.source == Source::nx || column.source == Source::ny || column.source == Source::nz)
      name = "normal_" + name.substr(1);
    if (column.source == Source::red) {  // one float that is four bytes: what every reader of PCD knows
      name = alpha ? "rgba" : "rgb";
      type = alpha ? 'U' : 'F';
      size = 4;
    } else if (int(column.source) > int(Source::red) && int(column.source) <= int(Source::alpha)) {
      continue;
    }
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
  write_records(out, cloud, columns, true, progress);
  out.commit();
  return {};
}

WriteReport write_npy_cloud(const std::filesystem::path& file, const PointCloud& cloud, Progress& progress) {
  const std::vector<OutColumn> columns = columns_to_write(cloud);
  std::string header = "{'descr': [";
  for (const OutColumn& column : columns) {
    const auto [type, size] = kind_of(column.type);
    header += "('" + column_name(column.name, "'\\\r\n") + "', '" + (size == 1 ? "|" : "<") +
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
  write_records(out, cloud, columns, false, progress);
  out.commit();
  return {};
}

}  // namespace sfumato::io
