// VTK's XML files (.vtp, .vtu), their points and polygons: ascii, base64 and appended arrays, plain or
// compressed by zlib.
#include <zlib.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <pugixml.hpp>
#include <utility>

#include "io/vtk.h"

namespace sfumato::io {
namespace {

std::optional<StoredType> xml_type(std::string_view word) {
  static const std::pair<const char*, StoredType> types[] = {
      {"Float32", StoredType::float32}, {"Float64", StoredType::float64}, {"UInt8", StoredType::uint8},
      {"Int8", StoredType::int8},       {"UInt16", StoredType::uint16},   {"Int16", StoredType::int16},
      {"UInt32", StoredType::uint32},   {"Int32", StoredType::int32},     {"UInt64", StoredType::uint64},
      {"Int64", StoredType::int64}};
  for (const auto& [name, type] : types)
    if (word == name) return type;
  return std::nullopt;
}

int sextet(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : c == '/' ? 63 : -1;
}

/// Bytes of an array as it lies in the file: base64 (pieces that each end with their padding) or raw.
class ByteReader {
 public:
  ByteReader(std::string_view text, bool is_base64) : text_(text), is_base64_(is_base64) {}

  /// `count` bytes, or fewer at the end.
  std::string take(std::size_t count) {
    if (!is_base64_) {
      const std::string_view part = text_.substr(std::min(at_, text_.size()), count);
      at_ += part.size();
      return std::string(part);
    }
    while (held_.size() < count && at_ < text_.size()) {
      int bits[4] = {-1, -1, -1, -1}, n = 0;
      for (; n < 4 && at_ < text_.size(); ++at_) {
        const char c = text_[at_];
        if (std::isspace(static_cast<unsigned char>(c))) continue;
        if (c != '=' && sextet(c) < 0) return std::exchange(held_, {});
        bits[n++] = c == '=' ? -1 : sextet(c);
      }
      if (n < 4 || bits[0] < 0 || bits[1] < 0) break;
      held_ += char(bits[0] << 2 | bits[1] >> 4);
      if (bits[2] >= 0) held_ += char(bits[1] << 4 | bits[2] >> 2);
      if (bits[3] >= 0) held_ += char(bits[2] << 6 | bits[3]);
    }
    std::string taken = held_.substr(0, count);
    held_.erase(0, taken.size());
    return taken;
  }

 private:
  std::string_view text_;
  bool is_base64_;
  std::size_t at_ = 0;
  std::string held_;
};

class XmlReader {
 public:
  XmlReader(const std::filesystem::path& path, const ReadOptions& options, Progress& progress)
      : path_(path), options_(options), progress_(progress), out_(path), text_(text_of(path)) {}

  ReadResult read() {
    // Raw bytes behind <AppendedData ...>_ are no XML.
    std::string_view xml = text_;
    std::string closed;
    if (const std::size_t tag = text_.find("<AppendedData"); tag != std::string::npos) {
      const std::size_t end = text_.find('>', tag), start = text_.find('_', std::min(end, text_.size()));
      if (start == std::string::npos) fail("found no _ behind <AppendedData>; the file is cut short");
      appended_ = std::string_view(text_).substr(start + 1);
      is_appended_base64_ = text_.substr(tag, end - tag).find("base64") != std::string::npos;
      closed = text_.substr(0, end + 1) + "</AppendedData></VTKFile>";
      xml = closed;
    }
    pugi::xml_document document;
    const pugi::xml_parse_result parsed = document.load_buffer(xml.data(), xml.size());
    if (!parsed)
      fail(std::string("found no XML (") + parsed.description() + "); the file is cut short or damaged");
    const pugi::xml_node root = document.child("VTKFile");
    const std::string kind = root.attribute("type").value(),
                      compressor = root.attribute("compressor").value();
    if (kind != "PolyData" && kind != "UnstructuredGrid" && kind != "StructuredGrid")
      fail("found " + (kind.empty() ? std::string("no type") : kind) +
           ", expected PolyData, UnstructuredGrid or StructuredGrid; write poly data");
    if (!compressor.empty() && compressor != "vtkZLibDataCompressor")
      fail("found arrays compressed by " + compressor + ", which are not read; write them by zlib, or plain");
    is_compressed_ = !compressor.empty();
    is_big_ = std::string_view(root.attribute("byte_order").value()) == "BigEndian";
    head_size_ = std::string_view(root.attribute("header_type").value()) == "UInt64" ? 8 : 4;
    for (const pugi::xml_node piece : root.child(kind.c_str()).children("Piece")) {
      progress_.check();
      const pugi::xml_node points = piece.child("Points").child("DataArray");
      if (!points) continue;
      const std::size_t before = out_.rows();
      out_.add_points(values_of(points), type_of(points));
      const std::size_t count = out_.rows() - before;
      for (const pugi::xml_node array : piece.child("PointData").children("DataArray")) {
        const std::size_t width = array.attribute("NumberOfComponents").as_uint(1);
        if (width < 1 || width > 256) continue;
        const bool normals = std::string_view(piece.child("PointData").attribute("Normals").value()) ==
                                 array.attribute("Name").value() &&
                             width == 3;
        out_.add(normals ? "normals" : array.attribute("Name").value(), type_of(array), width,
                 values_of(array), count);
      }
      if (options_.faces) add_polygons(piece);
    }
    if (out_.rows() == 0) fail("found no points; write poly data or an unstructured grid");
    return out_.build(options_, progress_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { bad_input(path_, "XML", what); }

  void add_polygons(const pugi::xml_node& piece) {
    try {
      take_polygons(piece);
    } catch (const Error& error) {
      if (!options_.samples_faces || error.code() != ErrorCode::bad_input) throw;
      out_.drop_polygons(error);
    }
  }
  void take_polygons(const pugi::xml_node& piece) {
    for (const char* kind : {"Polys", "Strips"}) {
      const auto values = [&](const char* name) {
        const pugi::xml_node array = piece.child(kind).find_child_by_attribute("DataArray", "Name", name);
        return array ? values_of(array) : std::vector<double>();
      };
      VtkArrays::Polygons found{values("connectivity"), values("offsets"), kind[0] == 'S'};
      if (!found.ends.empty()) out_.add_polygons(std::move(found));
    }
  }

  StoredType type_of(const pugi::xml_node& array) const {
    const auto type = xml_type(array.attribute("type").value());
    if (!type)
      fail(std::string("found numbers of type '") + array.attribute("type").value() + "'; write floats");
    return *type;
  }

  std::uint64_t number_in(const std::string& bytes, std::size_t index) const {
    std::uint64_t value = 0;
    for (std::size_t b = 0; b < head_size_; ++b) {
      const auto byte = std::uint64_t(static_cast<unsigned char>(bytes[index * head_size_ + b]));
      value |= byte << 8 * (is_big_ ? head_size_ - 1 - b : b);
    }
    return value;
  }

  std::string bytes_of(ByteReader reader, const std::string& name) const {
    const auto cut = [&]() {
      fail("the array '" + name + "' ends before its size; the file is cut short or damaged");
    };
    const auto take = [&](std::uint64_t count) {
      if (count > text_.size()) cut();
      std::string bytes = reader.take(std::size_t(count));
      if (bytes.size() != count) cut();
      return bytes;
    };
    if (!is_compressed_) return take(number_in(take(head_size_), 0));
    const std::string head = take(3 * head_size_);
    const std::uint64_t blocks = number_in(head, 0), size = number_in(head, 1), last = number_in(head, 2);
    if (blocks > text_.size() || size > (1u << 30) || last > size) cut();
    const std::string sizes = take(blocks * head_size_);
    std::string all;
    for (std::uint64_t b = 0; b < blocks; ++b) {
      progress_.check();
      const std::string packed = take(number_in(sizes, b));
      auto length = uLongf(b + 1 == blocks && last > 0 ? last : size);
      if (length > 1100 * packed.size() + 64) cut();
      const std::size_t begin = all.size();
      all.resize(begin + length);
      if (::uncompress(reinterpret_cast<Bytef*>(all.data() + begin), &length,
                       reinterpret_cast<const Bytef*>(packed.data()), uLong(packed.size())) != Z_OK ||
          begin + length != all.size())
        fail("found an impossible zlib stream in '" + name + "'; the file is damaged");
    }
    return all;
  }

  std::vector<double> values_of(const pugi::xml_node& array) const {
    const StoredType type = type_of(array);
    const std::string format = array.attribute("format").value(), name = array.attribute("Name").value();
    std::vector<double> values;
    if (format == "ascii") {
      const char* at = array.child_value();
      for (char* end = nullptr;; at = end) {
        const double value = std::strtod(at, &end);
        if (end == at) break;
        values.push_back(value);
      }
      while (std::isspace(static_cast<unsigned char>(*at))) ++at;
      if (*at) fail("found no number in '" + name + "'; the file is damaged");
      return values;
    }
    std::string bytes;
    if (format == "appended") {
      const std::uint64_t offset = array.attribute("offset").as_ullong();
      if (offset >= appended_.size()) fail("found '" + name + "' outside the file; it is cut short");
      bytes = bytes_of({appended_.substr(std::size_t(offset)), is_appended_base64_}, name);
    } else {
      bytes = bytes_of({array.child_value(), true}, name);
    }
    const std::size_t size = size_of(type);
    values.resize(bytes.size() / size);
    for (std::size_t i = 0; i < values.size(); ++i) {
      std::byte number[8];
      for (std::size_t b = 0; b < size; ++b)
        number[b] = std::byte(bytes[i * size + (is_big_ ? size - 1 - b : b)]);
      values[i] = number_of(type, number);
    }
    return values;
  }

  std::filesystem::path path_;
  const ReadOptions& options_;
  Progress& progress_;
  VtkArrays out_;
  std::string text_;
  std::string_view appended_;
  bool is_appended_base64_ = false, is_compressed_ = false, is_big_ = false;
  std::size_t head_size_ = 4;
};

}  // namespace

bool is_vtk_xml(std::string_view head) { return head.find("<VTKFile") != std::string_view::npos; }

ReadResult read_vtk_xml(const std::filesystem::path& file, const ReadOptions& options, Progress& progress) {
  return XmlReader(file, options, progress).read();
}

}  // namespace sfumato::io
