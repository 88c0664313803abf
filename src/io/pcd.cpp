// Point Cloud Library PCD v0.5 to 0.7: ascii, binary, and binary_compressed (LZF, field after field).
#include <lzf.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstring>
#include <functional>
#include <limits>
#include <sstream>

#include "io/columns.h"
#include "core/counted.h"
#include "core/lower_case.h"
#include "core/number_in.h"
#include "io/file.h"
#include "io/format.h"
#include "io/parallel.h"
#include "io/text_rows.h"

namespace sfumato::io {
namespace {

constexpr std::size_t most_numbers = 4096;

struct PcdField {
  std::string name;
  std::size_t size = 4, count = 1;
  char type = 'F';
  bool is_padding() const { return name == "_"; }
  bool is_packed_color() const { return (name == "rgb" || name == "rgba") && size == 4 && count == 1; }
};

struct PcdHeader {
  std::vector<PcdField> fields;
  std::uint64_t width = 0, height = 1, points = 0;
  bool has_points = false;
  dvec3 viewpoint{0};
  std::string data;  ///< ascii, binary or binary_compressed
  std::uint64_t data_begin = 0, lines = 0;
  std::size_t record_size() const {
    std::size_t size = 0;
    for (const PcdField& field : fields) size += field.size * field.count;
    return size;
  }
};

class HeaderParser {
 public:
  explicit HeaderParser(const File& file) : file_(file), text_(file.read_text(0, 1 << 16)) {}

  PcdHeader parse() {
    while (header_.data.empty()) {
      const std::size_t end = text_.find('\n', at_);
      ++header_.lines;
      if (end == std::string::npos)
        fail("the header has no DATA line; the file is cut short, fetch it again");
      std::istringstream words(text_.substr(at_, end - at_));
      at_ = end + 1;
      parse_line(words);
    }
    header_.data_begin = at_;
    check();
    return header_;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    bad_input(file_.path(), "line " + std::to_string(header_.lines), what);
  }

  void parse_line(std::istringstream& words) {
    std::string key;
    words >> key;
    if (key == "FIELDS" || key == "COLUMNS") {
      for (std::string name; words >> name;) header_.fields.push_back({name});
    } else if (key == "SIZE") {
      for (PcdField& field : header_.fields) field.size = std::size_t(number(words, "SIZE", 8));
    } else if (key == "TYPE") {
      for (PcdField& field : header_.fields) words >> field.type;
    } else if (key == "COUNT") {
      for (PcdField& field : header_.fields) field.count = std::size_t(number(words, "COUNT", 65536));
    } else if (key == "WIDTH") {
      header_.width = number(words, "WIDTH", std::numeric_limits<std::uint32_t>::max());
    } else if (key == "HEIGHT") {
      header_.height = number(words, "HEIGHT", std::numeric_limits<std::uint32_t>::max());
    } else if (key == "POINTS") {
      header_.points = number(words, "POINTS", std::uint64_t(1) << 48);
      header_.has_points = true;
    } else if (key == "VIEWPOINT") {
      if (!(words >> header_.viewpoint.x >> header_.viewpoint.y >> header_.viewpoint.z))
        fail("found no position, expected 'VIEWPOINT tx ty tz qw qx qy qz'; export it again");
    } else if (key == "DATA") {
      words >> header_.data;
      // Written without the end of the line: the first point follows at once.
      if (header_.data.starts_with("ascii") &&
          header_.data.find_first_of("+-.0123456789") == std::string_view("ascii").size()) {
        at_ = text_.rfind(header_.data, at_) + std::string_view("ascii").size();
        header_.data = "ascii";
        --header_.lines;
      }
      header_.data = lower_case(header_.data);  // as PCL reads it
      if (header_.data != "ascii" && header_.data != "binary" && header_.data != "binary_compressed")
        fail("found DATA '" + header_.data.substr(0, 20) + "', expected ascii, binary or binary_compressed");
    } else if (!key.empty() && key[0] != '#' && key != "VERSION") {
      fail("found '" + key.substr(0, 20) + "', expected a line of a PCD header; export it again");
    }
  }

  std::uint64_t number(std::istringstream& words, const char* key, std::uint64_t limit) {
    std::string word;
    words >> word;
    word.resize(
        std::min(word.find('#'), word.size()));  // what recorders hold a place with, for PCL a comment
    const std::optional<std::uint64_t> value = number_in<std::uint64_t>(word);
    if (!value || *value > limit)
      fail("found " + std::string(key) + " '" + word.substr(0, 20) + "', expected a number up to " +
           std::to_string(limit) + " for each field; export it again");
    return *value;
  }

  void check() {
    if (header_.fields.empty()) fail("the header names no FIELDS; export it again");
    for (const PcdField& field : header_.fields) {
      const bool known = field.type == 'F' ? field.size == 4 || field.size == 8
                                           : (field.type == 'I' || field.type == 'U') && field.size <= 8 &&
                                                 std::has_single_bit(field.size);
      if (!known && !field.is_padding())
        fail("found field '" + field.name + "' of type " + field.type + std::to_string(field.size) +
             ", expected F4 F8 or I and U of 1 2 4 8 bytes; export it again");
    }
    std::size_t numbers = 0;
    for (const PcdField& field : header_.fields) numbers += field.count;
    if (numbers > most_numbers)
      fail("found " + std::to_string(numbers) + " numbers a point, expected at most " +
           std::to_string(most_numbers));
    // v0.5 has none, and some programs write 0.
    if (header_.has_points && (header_.width == 0 || header_.height == 0))
      header_.width = header_.points, header_.height = 1;
    const std::uint64_t cells = header_.width * header_.height;
    if (!header_.has_points) header_.points = cells;
    if (header_.points != cells)
      fail("found POINTS " + std::to_string(header_.points) +
           ", expected WIDTH x HEIGHT = " + std::to_string(cells) + "; export it again");
    if (header_.height > 1 && header_.points > std::numeric_limits<std::uint32_t>::max())
      fail("found an organised cloud of " + std::to_string(header_.points) +
           " points, expected at most 2^32 - 1");
  }

  const File& file_;
  std::string text_;
  std::size_t at_ = 0;
  PcdHeader header_;
};

StoredType type_of(const PcdField& field) {
  if (field.type == 'F') return field.size == 4 ? StoredType::float32 : StoredType::float64;
  switch (field.size) {
    case 1: return field.type == 'U' ? StoredType::uint8 : StoredType::int8;
    case 2: return field.type == 'U' ? StoredType::uint16 : StoredType::int16;
    case 4: return field.type == 'U' ? StoredType::uint32 : StoredType::int32;
    default: return field.type == 'U' ? StoredType::uint64 : StoredType::int64;
  }
}

/// Columns of binary data, records together (`points` = 0) or each field's values together. A packed colour
/// is 0x00RRGGBB in little-endian bytes; its fourth byte is often unset and means nothing here.
std::vector<Column> binary_columns(const PcdHeader& header, std::uint64_t points) {
  std::vector<Column> columns;
  std::size_t offset = 0;
  const std::size_t record = header.record_size();
  for (const PcdField& field : header.fields) {
    const std::size_t size = field.size * field.count, stride = points > 0 ? size : record;
    const StoredType type = type_of(field);
    if (field.is_packed_color()) {
      const char* names[] = {"red", "green", "blue"};
      for (std::size_t k = 0; k < 3; ++k)
        columns.push_back({names[k], StoredType::uint8, StoredType::uint8, offset + 2 - k, stride});
    } else if (!field.is_padding()) {
      for (std::size_t k = 0; k < field.count; ++k)
        columns.push_back({field.count > 1 ? field.name + "_" + std::to_string(k) : field.name, type, type,
                           offset + k * field.size, stride});
    }
    offset += points > 0 ? size * std::size_t(points) : size;
  }
  return columns;
}

class FieldLines final : public LineGrammar {
 public:
  explicit FieldLines(const PcdHeader& header) : header_(header) {}
  bool counts(std::string_view line) const override { return LineGrammar::counts(line) && line[0] != '#'; }
  bool parse(std::string_view line, double* row) const override {
    const char *at = line.data(), *end = at + line.size();
    for (const PcdField& field : header_.fields)
      for (std::size_t k = 0; k < field.count; ++k) {
        const double value = next_value(at, end, field);
        if (field.is_packed_color()) {
          const std::uint32_t rgb = bits(field, value);
          *row++ = rgb >> 16 & 255, *row++ = rgb >> 8 & 255, *row++ = rgb & 255;
        } else if (!field.is_padding()) {
          *row++ = value;
        }
      }
    return true;
  }

 private:
  /// Numbers of one byte are written as that character by some programs, such as streams of C++.
  static double next_value(const char*& at, const char* end, const PcdField& field) {
    const char* own = at < end && *at == ' ' ? at + 1 : at;
    const bool is_character = field.size == 1 && own < end && !is_blank(*own) && (*own < '0' || *own > '9') &&
                              (own + 1 == end || is_blank(own[1]));
    if (!is_character) return next_number(at, end, field.name);
    at = own + 1;
    return field.type == 'U' ? double(static_cast<unsigned char>(*own))
                             : double(static_cast<signed char>(*own));
  }
  /// Under type F programs write the float whose bits are the colour (tiny, or negative with alpha) or the
  /// colour as a whole number; no colour without alpha reaches 1 as a float.
  static std::uint32_t bits(const PcdField& field, double value) {
    if (field.type == 'F' && value < 1) {
      const float packed = float(value);
      std::uint32_t rgb;
      std::memcpy(&rgb, &packed, sizeof rgb);
      return rgb;
    }
    return value >= 0 && value < 0x1p32 ? std::uint32_t(value) : 0;  // NaN: black
  }
  const PcdHeader& header_;
};

void need_positions(const File& file, std::vector<Column>& columns) {
  if (!assign_roles(columns))
    bad_input(file.path(), "header", "FIELDS lacks x, y or z; export it with positions");
  use_usual_names(columns);
}

std::uint64_t held_points(const File& file, const PcdHeader& header, std::uint64_t held, ReadReport& report) {
  return held_points(file, "byte " + std::to_string(file.size()), held, header.points, report);
}

void decode_in_parallel(CloudBuilder& builder, std::size_t count, Progress& progress, ReadResult& result,
                        const std::function<void(CloudBuilder::Cursor&, std::size_t, std::size_t)>& decode) {
  const std::size_t threads = count < 20000 ? 1 : thread_count(), step = 32768;
  std::vector<CloudBuilder::Cursor> cursors;
  for (std::size_t t = 0; t < threads; ++t)
    cursors.push_back(builder.cursor(count * t / threads, count * (t + 1) / threads));
  std::atomic<std::size_t> done{0};
  in_parallel(threads, [&](std::size_t t) {
    for (std::size_t i = cursors[t].begin; i < cursors[t].end; i += step) {
      progress.check();
      const std::size_t n = std::min(step, cursors[t].end - i);
      decode(cursors[t], i, n);
      progress.update(double(done += n) / double(count), "reading");
    }
  });
  builder.finish(cursors, result);
}

void read_binary(const File& file, const PcdHeader& header, bool organised, Progress& progress,
                 ReadResult& result) {
  std::vector<Column> columns = binary_columns(header, 0);
  need_positions(file, columns);
  const std::size_t size = header.record_size();
  const auto held =
      std::size_t(held_points(file, header, (file.size() - header.data_begin) / size, result.report));
  CloudBuilder builder(std::move(columns), held, false, organised);
  decode_in_parallel(builder, held, progress, result,
                     [&](CloudBuilder::Cursor& cursor, std::size_t first, std::size_t count) {
                       std::vector<std::byte> bytes(count * size);
                       file.read(header.data_begin + std::uint64_t(first) * size, bytes);
                       builder.decode(cursor, bytes.data(), 0, count, first);
                     });
}

void read_compressed(const File& file, const PcdHeader& header, bool organised, Progress& progress,
                     ReadResult& result) {
  std::vector<Column> columns = binary_columns(header, std::max<std::uint64_t>(header.points, 1));
  need_positions(file, columns);
  if (header.points == 0) {
    CloudBuilder builder(std::move(columns), 0, false, organised);
    std::vector<CloudBuilder::Cursor> none;
    return builder.finish(none, result);
  }
  std::uint32_t sizes[2] = {0, 0};  // compressed, uncompressed
  if (file.size() - header.data_begin < sizeof sizes) held_points(file, header, 0, result.report);
  file.read(header.data_begin, std::as_writable_bytes(std::span(sizes)));
  const std::uint64_t begin = header.data_begin + sizeof sizes, room = file.size() - begin;
  const std::size_t record = header.record_size();
  if (sizes[0] > room)
    bad_input(file.path(), "byte " + std::to_string(file.size()),
              "the file ends after " + std::to_string(room) + " bytes of compressed points, expected " +
                  std::to_string(sizes[0]) + "; it is cut short, fetch it again");
  // One LZF reference of 3 bytes stands for at most 264: more than 88 times the input cannot come out. And
  // liblzf reads a first byte even when there is none.
  const bool as_promised = sizes[1] % header.points == 0 && sizes[1] / header.points == record;
  if (!as_promised || sizes[0] == 0 || sizes[1] / 88 > sizes[0])
    bad_input(file.path(), "byte " + std::to_string(header.data_begin + 4),
              "found " + std::to_string(sizes[1]) + " bytes of points packed in " + std::to_string(sizes[0]) +
                  ", expected " + std::to_string(header.points) + " points of " + std::to_string(record) +
                  " bytes; the file is damaged, fetch it again");
  std::vector<std::byte> packed(sizes[0]), points(sizes[1]);
  file.read(begin, packed);
  progress.check();
  if (lzf_decompress(packed.data(), sizes[0], points.data(), sizes[1]) != sizes[1])
    bad_input(file.path(), "byte " + std::to_string(begin),
              "the compressed points do not unpack to " + std::to_string(sizes[1]) +
                  " bytes; the file is damaged, fetch it again");
  packed = {};
  CloudBuilder builder(std::move(columns), std::size_t(header.points), false, organised);
  decode_in_parallel(builder, std::size_t(header.points), progress, result,
                     [&](CloudBuilder::Cursor& cursor, std::size_t first, std::size_t count) {
                       builder.decode(cursor, points.data(), first, count, first);
                     });
}

void read_ascii(const File& file, const PcdHeader& header, bool organised, Progress& progress,
                ReadResult& result) {
  std::vector<Column> columns = binary_columns(header, 0);
  need_positions(file, columns);
  const FieldLines grammar(header);
  const TextBlocks text = cut_lines(file, header.data_begin, header.lines + 1, grammar, progress);
  const std::uint64_t held = text.rows < header.points ? whole_lines(file, text.rows) : text.rows;
  read_rows(file, text, 0, held_points(file, header, held, result.report), grammar, std::move(columns),
            organised, progress, result);
}

}  // namespace

bool is_pcd(std::string_view head) {
  return head.starts_with("# .PCD") ||
         (head.find("FIELDS ") < 512 && head.find("DATA ") != std::string_view::npos &&
          head.find("POINTS ") != std::string_view::npos);
}

ReadResult read_pcd(const std::filesystem::path& path, const ReadOptions&, Progress& progress) {
  const File file(path);
  const PcdHeader header = HeaderParser(file).parse();
  const bool organised = header.height > 1;
  ReadResult result;
  if (header.data == "ascii")
    read_ascii(file, header, organised, progress, result);
  else if (header.data == "binary")
    read_binary(file, header, organised, progress, result);
  else
    read_compressed(file, header, organised, progress, result);
  PointCloud& cloud = result.cloud;
  if (organised)
    cloud.grids.push_back(
        {0, cloud.size(), std::uint32_t(header.width), std::uint32_t(header.height), header.viewpoint});
  // The default viewpoint of an unorganised cloud, 0 0 0, says nothing.
  if (organised || header.viewpoint != dvec3(0)) cloud.scanners.push_back(header.viewpoint);
  return result;
}

}  // namespace sfumato::io
