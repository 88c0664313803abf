// Bare arrays: NumPy's .npy (a row a point, or records with names).
#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>

#include "core/lower_case.h"
#include "io/columns.h"
#include "core/counted.h"
#include "io/file.h"
#include "io/format.h"
#include "io/npy_array.h"
#include "io/text_columns.h"

namespace sfumato::io {
namespace {

constexpr std::uint64_t most_numbers_a_record = 512, most_in_a_row = 256,
                        most_coordinates = 16;  ///< of a point that does not lie in a row of its own

struct Array {
  std::vector<Column> columns;
  std::uint64_t begin = 0, rows = 0, record = 0;  ///< bytes, points, bytes a point
  bool big_endian = false, by_column = false, has_names = false;
};

/// The whole numbers in the text of a tuple.
std::vector<std::uint64_t> sizes_in(std::string_view text) {
  std::vector<std::uint64_t> sizes;
  while (!text.empty()) {
    std::uint64_t size = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), size);
    if (error == std::errc()) sizes.push_back(size);
    text.remove_prefix(error == std::errc() ? std::size_t(end - text.data()) : 1);
  }
  return sizes;
}

std::optional<StoredType> numpy_type(std::string_view text) {
  static const std::pair<std::string_view, StoredType> types[] = {
      {"f4", StoredType::float32}, {"f8", StoredType::float64}, {"u1", StoredType::uint8},
      {"i1", StoredType::int8},    {"u2", StoredType::uint16},  {"i2", StoredType::int16},
      {"u4", StoredType::uint32},  {"i4", StoredType::int32},   {"u8", StoredType::uint64},
      {"i8", StoredType::int64},   {"b1", StoredType::uint8}};
  for (const auto& [name, type] : types)
    if (text == name) return type;
  return std::nullopt;
}

/// The header of an NPY file: a Python dictionary with descr, fortran_order and shape.
class NpyHeader {
 public:
  /// `is_cloud`: x, y and z are wanted; otherwise any numbers, also a list of them.
  NpyHeader(const File& file, const ReadOptions& options, bool is_cloud = true)
      : file_(file), options_(options), is_cloud_(is_cloud) {}

  Array parse() {
    const std::string head = file_.read_text(0, 12);
    if (head.size() < 12) fail("the file ends inside its header; it is cut short, fetch it again");
    const auto byte = [&](std::size_t i) { return std::uint64_t(static_cast<unsigned char>(head[i])); };
    const bool is_long = byte(6) >= 2;
    const std::uint64_t at = is_long ? 12 : 10;
    const std::uint64_t size = byte(8) | byte(9) << 8 | (is_long ? byte(10) << 16 | byte(11) << 24 : 0);
    array_.begin = at + size;
    if (size > (1 << 20) || array_.begin > file_.size())
      fail("found a header of " + std::to_string(size) + " bytes; the file is damaged");
    text_ = file_.read_text(at, std::size_t(size));
    array_.by_column = value_of("fortran_order").starts_with("True");
    read_shape();
    read_types();
    const std::uint64_t held = (file_.size() - array_.begin) / std::max<std::uint64_t>(1, array_.record);
    if (array_.rows > held)
      fail("the file ends after " + counted(held, "row") + ", expected " + std::to_string(array_.rows) +
           "; it is cut short, fetch it again");
    return array_;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { bad_input(file_.path(), "header", what); }

  std::string_view value_of(const std::string& key) const {
    std::size_t at = text_.find("'" + key + "'");
    if (at == std::string::npos) fail("the header lacks '" + key + "'; this is no NPY file");
    at = text_.find(':', at);
    if (at == std::string::npos) fail("the header is no dictionary; this is no NPY file");
    at = text_.find_first_not_of(' ', at + 1);
    return at == std::string::npos ? std::string_view() : std::string_view(text_).substr(at);
  }

  void read_shape() {
    const std::string_view text = value_of("shape");
    shape_ = sizes_in(text.substr(0, text.find(')')));
    if (!is_cloud_ && shape_.size() == 1) shape_.push_back(1), is_list_ = true;
    if (is_cloud_) make_rows_points();
    if (shape_.empty() || shape_.size() > 2 || shape_[0] > 0xFFFFFFFFull ||
        (shape_.size() == 2 && shape_[1] > most_in_a_row))
      fail("found an array of another shape than (points, columns); save the points as rows");
    array_.rows = shape_[0];
  }

  /// A point for each pixel of a depth camera, or each point of several clouds: (height, width, columns). Or
  /// a row for each coordinate: (columns, points).
  void make_rows_points() {
    const bool is_pixels = shape_.size() == 3 && shape_[2] >= 3 && shape_[2] <= most_coordinates;
    if (is_pixels && !array_.by_column && shape_[0] <= 0xFFFFFFFFull && shape_[1] <= 0xFFFFFFFFull)
      shape_ = {shape_[0] * shape_[1], shape_[2]};
    const bool is_wide = shape_.size() == 2 && shape_[0] >= 3 && shape_[0] <= most_coordinates;
    if (is_wide && shape_[1] > most_in_a_row)
      std::swap(shape_[0], shape_[1]), array_.by_column = !array_.by_column;
  }

  void read_types() {
    const std::string_view descr = value_of("descr");
    if (descr.starts_with('\'')) {
      const StoredType type = element(descr.substr(1, descr.find('\'', 1) - 1));
      if (shape_.size() != 2) fail("found a list of numbers, expected (points, columns)");
      std::vector<std::string> names;
      if (is_cloud_)
        names = names_of(std::size_t(shape_[1]), type);
      else
        names.resize(std::size_t(shape_[1]));
      const std::size_t size = size_of(type);
      for (std::size_t k = 0; k < names.size(); ++k)
        array_.columns.push_back({names[k], type, type,
                                  array_.by_column ? k * size * std::size_t(array_.rows) : k * size,
                                  array_.by_column ? size : size * names.size()});
      array_.record = size * names.size();
    } else {
      read_records(descr);
    }
    if (is_cloud_ && !assign_roles(array_.columns))
      fail("the columns lack x, y or z; name them with --columns");
  }

  void read_records(std::string_view descr) {
    if (shape_.size() != 1 && !is_list_) fail("found a grid of records, expected a list of them");
    // [('x', '<f4'), ('normal', '<f4', (3,)), ...]: a name, a type, and the shape of what is several numbers.
    descr = descr.substr(0, descr.find(']'));
    std::vector<std::string_view> parts;  // by turns between quotes and in them
    for (std::size_t at = 0; at < descr.size(); at += parts.back().size() + 1)
      parts.push_back(descr.substr(at, descr.find('\'', at) - at));
    for (std::size_t i = 1; i + 3 < parts.size(); i += 4) {
      const StoredType type = element(parts[i + 2]);
      std::uint64_t width = 1;
      for (const std::uint64_t size : sizes_in(parts[i + 3]))
        width = std::min(size, most_numbers_a_record + 1) * std::min(width, most_numbers_a_record + 1);
      if (array_.columns.size() + width > most_numbers_a_record)
        fail("found records of more than " + std::to_string(most_numbers_a_record) +
             " numbers, which are not read; save fewer");
      for (const std::string& name : columns_named(std::string(parts[i]), std::size_t(width))) {
        array_.columns.push_back({name, type, type, std::size_t(array_.record), 0});
        array_.record += size_of(type);
      }
    }
    for (Column& column : array_.columns) column.stride = std::size_t(array_.record);
    array_.by_column = false;
    array_.has_names = true;
    if (is_cloud_) name_records();
  }

  /// Where no names say x, y and z: as --columns has them, or what NumPy calls f0, f1, ... by their places.
  void name_records() {
    std::vector<Column>& columns = array_.columns;
    if (std::vector<Column> named = columns; assign_roles(named)) return;
    std::vector<std::string> names = given_names(columns.size());
    if (names.empty()) {
      for (std::size_t k = 0; k < columns.size(); ++k)
        if (columns[k].name != "f" + std::to_string(k)) return;
      names = {"x", "y", "z"};
    }
    for (std::size_t k = 0; k < std::min(names.size(), columns.size()); ++k) columns[k].name = names[k];
    array_.has_names = false;
  }

  StoredType element(std::string_view text) {
    if (text.empty()) fail("found no type of numbers; the file is damaged");
    const bool big = text[0] == '>';
    const auto type = numpy_type(text.substr(1));
    if (!type || (big && seen_little_))
      fail("found numbers of type '" + std::string(text.substr(0, 20)) +
           "', which are not read; save floats");
    seen_little_ = seen_little_ || (!big && size_of(*type) > 1);
    array_.big_endian = array_.big_endian || big;
    return *type;
  }

  /// Of --columns, one for each column, or none.
  const std::vector<std::string>& given_names(std::size_t width) const {
    const std::size_t given = options_.columns.size();
    if (given > 0 && given != width)
      throw Error(ErrorCode::usage, file_.path().string() + ": has " + std::to_string(width) +
                                        " columns, --columns names " + std::to_string(given));
    return options_.columns;
  }

  std::vector<std::string> names_of(std::size_t width, StoredType type) const {
    if (const std::vector<std::string>& given = given_names(width); !given.empty()) return given;
    if (width < 3) fail("found " + counted(width, "column") + ", expected x y z and more");
    // The same guess as for text, from the first rows.
    std::vector<std::vector<double>> rows;
    if (!array_.by_column && !array_.big_endian &&
        (type == StoredType::float32 || type == StoredType::float64)) {
      const std::size_t size = size_of(type);
      const std::string bytes = file_.read_text(array_.begin, 100 * size * width);
      for (std::size_t at = 0; at + size * width <= bytes.size(); at += size * width) {
        std::vector<double>& row = rows.emplace_back();
        for (std::size_t k = 0; k < width; ++k) {
          float narrow = 0;
          double wide = 0;
          std::memcpy(size == 4 ? static_cast<void*>(&narrow) : &wide, bytes.data() + at + k * size, size);
          row.push_back(size == 4 ? double(narrow) : wide);
        }
      }
    }
    return guess_columns(rows, width);
  }

  const File& file_;
  const ReadOptions& options_;
  std::string text_;
  std::vector<std::uint64_t> shape_;
  bool is_cloud_ = true, is_list_ = false, seen_little_ = false;
  Array array_;
};

ReadResult read_array(const File& file, const Array& array, Progress& progress) {
  const std::size_t rows = std::size_t(array.rows),
                    step = array.by_column ? std::max<std::size_t>(rows, 1) : 1 << 16;
  CloudBuilder builder(array.columns, rows, array.big_endian);
  std::vector<CloudBuilder::Cursor> cursors{builder.cursor(0, rows)};
  std::vector<std::byte> block;
  for (std::size_t first = 0; first < rows; first += step) {
    progress.check();
    const std::size_t count = std::min(step, rows - first);
    block.resize(count * std::size_t(array.record));
    file.read(array.begin + first * array.record, block);
    builder.decode(cursors[0], block.data(), 0, count, first);
    progress.update(double(first + count) / double(rows), "reading");
  }
  ReadResult result;
  builder.finish(cursors, result);
  return result;
}

}  // namespace

std::vector<std::string> columns_named(const std::string& name, std::size_t width) {
  const std::string low = lower_case(name);
  const auto is = [&](std::initializer_list<const char*> names) {
    return std::any_of(names.begin(), names.end(), [&](const char* one) { return low == one; });
  };
  if (is({"xyz", "points", "point", "positions", "position", "pos", "coords", "coord", "vertices", "pts",
          "arr_0"}) &&
      width >= 3) {
    std::vector<std::string> names{"x", "y", "z"};
    for (std::size_t k = 3; k < width; ++k) names.push_back(name + "_" + std::to_string(k));
    return names;
  }
  if (is({"rgb", "rgba", "colors", "color", "colours", "colour"}) && (width == 3 || width == 4)) {
    std::vector<std::string> names{"red", "green", "blue", "alpha"};
    names.resize(width);
    return names;
  }
  if (is({"normals", "normal"}) && width == 3) return {"nx", "ny", "nz"};
  if (width == 1) return {name};
  std::vector<std::string> names;
  for (std::size_t k = 0; k < width; ++k) names.push_back(name + "_" + std::to_string(k));
  return names;
}

NpyValues read_npy_values(const std::filesystem::path& path, Progress& progress) {
  const File file(path);
  const Array array = NpyHeader(file, {}, false).parse();
  NpyValues result;
  const auto rows = std::size_t(array.rows);
  if (rows > 0 && array.record == 0)
    bad_input(path, "header", "found records of no bytes; the file is damaged");
  const std::string bytes = file.read_text(array.begin, std::size_t(array.record) * rows);
  for (const Column& column : array.columns) {
    progress.check();
    if (!column.name.empty()) result.names.push_back(column.name);
    result.types.push_back(column.stored);
    std::vector<double>& values = result.columns.emplace_back(rows);
    const std::size_t size = size_of(column.stored);
    for (std::size_t i = 0; i < rows; ++i) {
      std::byte one[8];
      std::memcpy(one, bytes.data() + column.offset + i * column.stride, size);
      if (array.big_endian) std::reverse(one, one + size);
      values[i] = number_of(column.stored, one);
    }
  }
  if (result.names.size() != result.columns.size()) result.names.clear();
  return result;
}

bool is_npy(std::string_view head) { return head.starts_with("\x93NUMPY"); }

ReadResult read_npy_points(const std::filesystem::path& path, const ReadOptions& options,
                           Progress& progress) {
  const File file(path);
  const Array array = NpyHeader(file, options).parse();
  ReadResult result = read_array(file, array, progress);
  if (array.has_names && !options.columns.empty())
    result.report.notes.push_back("--columns has no effect: its records name their own columns");
  return result;
}

}  // namespace sfumato::io
