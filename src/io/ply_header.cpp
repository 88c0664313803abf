#include "io/ply_header.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <sstream>

#include "core/number_in.h"
#include "io/format.h"
#include "io/text_rows.h"

namespace sfumato::io {
namespace {

constexpr std::size_t header_limit = 1 << 20;
constexpr std::size_t most_properties = 4096;

std::optional<StoredType> parse_type(const std::string& word) {
  static const std::pair<const char*, StoredType> names[] = {
      {"char", StoredType::int8},       {"int8", StoredType::int8},       {"uchar", StoredType::uint8},
      {"uint8", StoredType::uint8},     {"short", StoredType::int16},     {"int16", StoredType::int16},
      {"ushort", StoredType::uint16},   {"uint16", StoredType::uint16},   {"int", StoredType::int32},
      {"int32", StoredType::int32},     {"uint", StoredType::uint32},     {"uint32", StoredType::uint32},
      {"float", StoredType::float32},   {"float32", StoredType::float32}, {"double", StoredType::float64},
      {"float64", StoredType::float64}, {"int64", StoredType::int64},     {"uint64", StoredType::uint64}};
  for (const auto& [name, type] : names)
    if (word == name) return type;
  return std::nullopt;
}

/// One line of the header after the other, with its number for messages.
class HeaderLines {
 public:
  explicit HeaderLines(const File& file) : file_(file), text_(file.read_text(0, header_limit)) {}

  std::istringstream next() {
    const std::size_t end = text_.find('\n', at_);
    ++line;
    if (end == std::string::npos)
      fail("the header has no end_header line; the file is cut short, fetch it again");
    std::string words = text_.substr(at_, end - at_);
    at_ = end + 1;
    if (!words.empty() && words.back() == '\r') words.pop_back();
    return std::istringstream(words);
  }
  [[noreturn]] void fail(const std::string& what) const {
    bad_input(file_.path(), "line " + std::to_string(line), what);
  }
  std::size_t position() const { return at_; }
  std::size_t line = 0;

 private:
  const File& file_;
  std::string text_;
  std::size_t at_ = 0;
};

PlyElement parse_element(HeaderLines& lines, std::istringstream& words) {
  PlyElement element;
  std::string word;
  words >> element.name >> word;
  const std::optional<std::uint64_t> count = number_in<std::uint64_t>(word);
  if (!count)
    lines.fail("found 'element " + element.name + " " + word +
               "', expected 'element NAME COUNT'; export it again");
  element.count = *count;
  return element;
}

PlyProperty parse_property(HeaderLines& lines, std::istringstream& words) {
  PlyProperty property;
  std::string word, number = "uchar";
  words >> word;
  property.is_list = word == "list";
  if (property.is_list) words >> number >> word;
  const std::optional<StoredType> type = parse_type(word), count_type = parse_type(number);
  words >> property.name;
  if (!type || !count_type || property.name.empty())
    lines.fail("found property type '" + (type ? number : word) +
               "', expected char uchar short ushort int uint float double and a name; export it again");
  property.type = *type;
  property.count_type = *count_type;
  return property;
}

/// Programs that have Z up, and name themselves in a comment; of 3D Slicer's axes the third is superior.
bool has_z_up(std::string_view comment) {
  constexpr std::string_view programs[] = {"Blender", "CloudCompare", "PCL generated", "SPACE=LPS",
                                           "SPACE=RAS"};
  return std::any_of(std::begin(programs), std::end(programs),
                     [&](std::string_view program) { return comment.find(program) != comment.npos; });
}

/// RealSense's viewer turns y and z of its cameras around.
bool is_of_realsense(std::string_view comment) {
  return comment.find("Realsense Viewer") != comment.npos || comment.find("RealSense Viewer") != comment.npos;
}

/// OpenMVS writes its lists so, after floats of this name, in points and in meshes, in the axes of the
/// structure from motion: those of a camera.
constexpr std::string_view first_of_openmvs = "property float32 x";
bool is_list_of_openmvs(const std::string& line) {
  return line == "property list uint8 uint32 view_indices" ||
         line == "property list uint8 uint32 vertex_indices";
}

void parse_comment(std::istringstream& words, PlyHeader& header) {
  std::string key, value;
  words >> key >> std::ws;
  std::getline(words, value);
  if (key == "up" || key == "usual_up")
    if (const std::optional<UpAxis> up = parse_up_axis(value)) {
      header.up = *up;
      header.says_up = key == "up", header.names_up = true;
    }
  if (key == "crs") header.crs = value;
  if (key == "TextureFile") {
    if (header.texture.empty()) header.texture = value;
  } else if (!header.names_up && has_z_up(key + " " + value)) {
    header.up = UpAxis::pos_z;
  } else if (!header.names_up && is_of_realsense(key + " " + value)) {
    header.up = UpAxis::pos_y, header.says_up = header.names_up = true;
  }
}

/// By the first of them: so many lines hold a number for each property.
std::size_t lines_of_vertex(const File& file, const PlyHeader& header) {
  const PlyElement& vertex = header.elements[header.vertex];
  if (header.vertex != 0 || vertex.has_list()) return 1;
  LineReader lines(file, header.data_begin, header.lines + 1);
  std::size_t count = 0, numbers = 0;
  for (std::string_view line; numbers < vertex.properties.size() && lines.next(line);) {
    const std::size_t words = count_words(line);
    numbers += words, count += words > 0;
  }
  return numbers == vertex.properties.size() ? std::max<std::size_t>(count, 1) : 1;
}

}  // namespace

bool PlyElement::has_list() const {
  return std::any_of(properties.begin(), properties.end(), [](const PlyProperty& p) { return p.is_list; });
}

std::size_t PlyElement::record_size() const {
  std::size_t size = 0;
  for (const PlyProperty& property : properties) size += size_of(property.type);
  return size;
}

PlyHeader read_ply_header(const File& file) {
  PlyHeader header;
  HeaderLines lines(file);
  std::string word;
  lines.next() >> word;
  if (word != "ply") lines.fail("found '" + word.substr(0, 20) + "', expected 'ply'; this is no PLY file");
  bool has_format = false, has_sized_floats = false;
  for (;;) {
    std::istringstream words = lines.next();
    word.clear();
    words >> word;
    if (word == "end_header") break;
    if (word == "format") {
      words >> word;
      header.ascii = word == "ascii";
      header.big_endian = word == "binary_big_endian";
      if (!header.ascii && !header.big_endian && word != "binary_little_endian")
        lines.fail("found format '" + word +
                   "', expected ascii or binary_little_endian or binary_big_endian");
      has_format = true;
    } else if (word == "element") {
      header.elements.push_back(parse_element(lines, words));
    } else if (word == "property") {
      if (header.elements.empty()) lines.fail("found a property before any element; export it again");
      has_sized_floats = has_sized_floats || words.str() == first_of_openmvs;
      if (has_sized_floats && !header.names_up && header.up == UpAxis::pos_y &&
          is_list_of_openmvs(words.str()))
        header.up = UpAxis::neg_y;
      header.elements.back().properties.push_back(parse_property(lines, words));
      if (header.elements.back().properties.size() > most_properties)
        lines.fail("found more than " + std::to_string(most_properties) + " properties of one element");
    } else if (word == "comment") {
      parse_comment(words, header);
    } else if (!word.empty() && word != "obj_info" && !header.elements.empty()) {
      // What stands before the elements describes nothing of the data.
      lines.fail("found '" + word.substr(0, 20) + "', expected element, property, comment or end_header");
    }
  }
  if (!has_format) lines.fail("the header has no format line; export it again");
  header.data_begin = lines.position();
  header.lines = lines.line;
  const auto vertex =
      std::find_if(header.elements.begin(), header.elements.end(), [](const PlyElement& element) {
        return element.name == "vertex" || element.name == "vertices" || element.name == "point";
      });
  if (vertex == header.elements.end())
    lines.fail("the header has no 'element vertex'; the file holds no points");
  header.vertex = std::size_t(vertex - header.elements.begin());
  if (header.ascii) header.vertex_lines = lines_of_vertex(file, header);
  return header;
}

PlyWalker::PlyWalker(const File& file, bool big_endian, std::uint64_t begin)
    : file_(file), big_endian_(big_endian), base_(begin) {}

const std::byte* PlyWalker::take(std::size_t bytes) {
  if (at_ + bytes > buffer_.size()) {
    const std::uint64_t from = position();
    if (from > file_.size() || file_.size() - from < bytes)
      bad_input(file_.path(), "byte " + std::to_string(file_.size()),
                "the file ends inside its data; it is cut short, fetch it again");
    buffer_.resize(std::size_t(std::min<std::uint64_t>(1 << 20, file_.size() - from)));
    base_ = from;
    at_ = 0;
    file_.read(base_, buffer_);
  }
  const std::byte* found = buffer_.data() + at_;
  at_ += bytes;
  return found;
}

double PlyWalker::number(StoredType type) {
  std::byte bytes[8];
  const std::size_t size = size_of(type);
  std::memcpy(bytes, take(size), size);
  if (big_endian_) std::reverse(bytes, bytes + size);
  return number_of(type, bytes);
}

void PlyWalker::skip(std::uint64_t bytes) {
  const std::uint64_t from = position();
  if (from > file_.size() || file_.size() - from < bytes)
    bad_input(file_.path(), "byte " + std::to_string(file_.size()),
              "the file ends inside its data; it is cut short, fetch it again");
  if (bytes <= buffer_.size() - at_) {
    at_ += std::size_t(bytes);
  } else {
    base_ = from + bytes;
    at_ = 0;
    buffer_.clear();
  }
}

std::uint64_t PlyWalker::list_length(const PlyProperty& property) {
  const std::uint64_t at = position();
  const double length = number(property.count_type);
  const double room = double(file_.size() - position());
  if (!(length >= 0) || length != std::floor(length) || length * double(size_of(property.type)) > room)
    bad_input(file_.path(), "byte " + std::to_string(at),
              "found a list '" + property.name + "' of " + std::to_string(length) +
                  " numbers, expected at most " +
                  std::to_string(std::uint64_t(room / double(size_of(property.type)))) +
                  "; the file is damaged, fetch it again");
  return std::uint64_t(length);
}

void PlyWalker::skip_element(const PlyElement& element, Progress& progress) {
  if (!element.has_list()) {
    const std::size_t size = element.record_size();
    if (size > 0 && element.count > (file_.size() - std::min(file_.size(), position())) / size)
      skip(file_.size() + 1);
    return skip(element.count * size);
  }
  for (std::uint64_t i = 0; i < element.count; ++i) {
    if (i % 65536 == 0) progress.check();
    for (const PlyProperty& property : element.properties)
      skip(property.is_list ? list_length(property) * size_of(property.type) : size_of(property.type));
  }
}

}  // namespace sfumato::io
