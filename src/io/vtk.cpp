// VTK's legacy files, ascii and binary: points of poly data, unstructured and structured grids; polygons.
#include "io/vtk.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <optional>

#include "core/lower_case.h"
#include "core/number_in.h"
#include "io/faces.h"
#include "io/file.h"
#include "io/npy_array.h"

namespace sfumato::io {
namespace {

std::optional<StoredType> legacy_type(const std::string& word) {
  static const std::pair<const char*, StoredType> types[] = {{"float", StoredType::float32},
                                                             {"double", StoredType::float64},
                                                             {"unsigned_char", StoredType::uint8},
                                                             {"char", StoredType::int8},
                                                             {"signed_char", StoredType::int8},
                                                             {"unsigned_short", StoredType::uint16},
                                                             {"short", StoredType::int16},
                                                             {"unsigned_int", StoredType::uint32},
                                                             {"int", StoredType::int32},
                                                             {"vtkidtype", StoredType::int32},
                                                             {"unsigned_long", StoredType::uint64},
                                                             {"long", StoredType::int64},
                                                             {"vtktypeint64", StoredType::int64},
                                                             {"vtktypeuint64", StoredType::uint64},
                                                             {"vtktypeint32", StoredType::int32},
                                                             {"vtktypeuint32", StoredType::uint32}};
  for (const auto& [name, type] : types)
    if (lower_case(word) == name) return type;
  return std::nullopt;
}

class LegacyReader {
 public:
  LegacyReader(const std::filesystem::path& path, const ReadOptions& options, Progress& progress)
      : path_(path), options_(options), progress_(progress), out_(path), text_(text_of(path)) {}

  ReadResult read() {
    line(), line();  // version and title
    const std::string kind = lower_case(word());
    is_binary_ = kind == "binary";
    if (!is_binary_ && kind != "ascii") fail("found '" + kind + "', expected ASCII or BINARY");
    while (true) {
      progress_.check();
      const std::string keyword = lower_case(word());
      if (keyword.empty()) break;
      part(keyword);
    }
    if (out_.rows() == 0) fail("found no POINTS; write poly data or an unstructured grid");
    return out_.build(options_, progress_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    bad_input(path_, "byte " + std::to_string(at_), what);
  }

  std::string line() {
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    std::string found = text_.substr(at_, end - at_);
    at_ = std::min(end + 1, text_.size());
    return found;
  }
  std::string word() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
    const std::size_t begin = at_;
    while (at_ < text_.size() && !std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
    return text_.substr(begin, std::min<std::size_t>(at_ - begin, 256));
  }
  std::size_t count() {
    const std::string text = word();
    const std::optional<std::size_t> value = number_in<std::size_t>(text);
    if (!value || *value > text_.size())
      fail("found '" + text + "', expected a number that the file can hold; it is cut short or damaged");
    return *value;
  }
  StoredType type() {
    const std::string text = word();
    const auto found = legacy_type(text);
    if (!found) fail("found numbers of type '" + text + "', which are not read; write floats");
    return *found;
  }

  std::vector<double> numbers(std::size_t number, StoredType type, bool wanted = true) {
    const std::size_t size = size_of(type), left = text_.size() - at_;
    if (number > left / (is_binary_ ? size : 1))
      fail("the file ends before " + std::to_string(number) + " numbers; it is cut short, fetch it again");
    std::vector<double> values(wanted ? number : 0);
    if (is_binary_) {
      line();  // the rest of the head's
      if (number > (text_.size() - at_) / size)
        fail("the file ends in its numbers; it is cut short, fetch it again");
      for (std::size_t i = 0; i < values.size(); ++i) {
        std::byte bytes[8];
        for (std::size_t b = 0; b < size; ++b) bytes[b] = std::byte(text_[at_ + i * size + size - 1 - b]);
        values[i] = number_of(type, bytes);
      }
      at_ += number * size;
      return values;
    }
    for (std::size_t i = 0; i < number; ++i) {
      const std::string text = word();
      char* end = nullptr;
      const double value = std::strtod(text.c_str(), &end);
      if (text.empty() || *end) fail("found '" + text + "', expected a number; the file is damaged");
      if (wanted) values[i] = value;
    }
    return values;
  }

  void part(const std::string& keyword) {
    if (keyword == "dataset") {
      const std::string kind = lower_case(word());
      if (kind != "polydata" && kind != "unstructured_grid" && kind != "structured_grid")
        fail("found " + kind + ", which has no points of its own; write poly data");
    } else if (keyword == "dimensions") {
      word(), word(), word();
    } else if (keyword == "points") {
      const std::size_t n = count();
      const StoredType stored = type();
      if (n > text_.size()) fail("found more points than the file can hold");
      out_.add_points(numbers(3 * n, stored), stored);
    } else if (keyword == "vertices" || keyword == "lines" || keyword == "polygons" ||
               keyword == "triangle_strips" || keyword == "cells") {
      const std::size_t offsets = count(), size = count(), before = at_;
      const bool are_strips = keyword == "triangle_strips";
      const bool wanted = options_.faces && (are_strips || keyword == "polygons");
      VtkArrays::Polygons found;
      found.are_strips = are_strips;
      if (lower_case(word()) != "offsets") {
        at_ = before;
        found.corners = numbers(size, StoredType::int32, wanted);
      } else {
        found.ends = numbers(offsets, type(), wanted);
        if (!found.ends.empty()) found.ends.erase(found.ends.begin());  // the first is 0
        word();                                                         // CONNECTIVITY
        found.corners = numbers(size, type(), wanted);
      }
      if (wanted) out_.add_polygons(std::move(found));
    } else if (keyword == "cell_types") {
      numbers(count(), StoredType::int32, false);
    } else if (keyword == "point_data" || keyword == "cell_data") {
      tuples_ = count(), is_of_points_ = keyword == "point_data";
    } else if (keyword == "metadata") {
      while (at_ < text_.size() && line().find_first_not_of(" \r") != std::string::npos) {
      }
      while (at_ < text_.size() && line().find_first_not_of(" \r") != std::string::npos) {
      }
    } else if (keyword == "lookup_table") {
      word();
      numbers(4 * count(), is_binary_ ? StoredType::uint8 : StoredType::float32, false);
    } else if (keyword == "field") {
      word();
      for (std::size_t n = count(); n > 0; --n) {
        std::string name = word();
        if (lower_case(name) == "metadata") {
          part("metadata"), ++n;
          continue;
        }
        const std::size_t width = count(), tuples = count();
        array(name, width, tuples, type());
      }
    } else if (keyword == "scalars") {
      const std::string name = word();
      const StoredType stored = type();
      std::string rest = line();
      rest.erase(std::remove_if(rest.begin(), rest.end(), [](unsigned char c) { return std::isspace(c); }),
                 rest.end());
      const std::size_t width = rest.empty() ? 1 : std::size_t(std::strtoul(rest.c_str(), nullptr, 10)),
                        before = at_;
      if (lower_case(word()) == "lookup_table")
        word();
      else
        at_ = before - 1;  // at the line's end
      array(name, width, tuples_, stored);
    } else if (keyword == "color_scalars") {
      word();
      const std::size_t width = count();
      array("rgb", width, tuples_, is_binary_ ? StoredType::uint8 : StoredType::float32);
    } else if (keyword == "vectors" || keyword == "normals") {
      const std::string name = word();
      array(keyword == "normals" ? keyword : name, 3, tuples_, type());
    } else if (keyword == "texture_coordinates") {
      const std::string name = word();
      const std::size_t width = count();
      array(name, width, tuples_, type());
    } else if (keyword == "tensors" || keyword == "tensors6") {
      const std::string name = word();
      array(name, keyword == "tensors" ? 9 : 6, tuples_, type());
    } else {
      fail("found '" + keyword + "', which this reader does not know; write poly data");
    }
  }

  void array(const std::string& name, std::size_t width, std::size_t tuples, StoredType stored) {
    if (width < 1 || width > 256)
      fail("found " + std::to_string(width) + " numbers a point in '" + name + "'");
    const bool wanted = is_of_points_ && tuples == out_.rows();
    const std::vector<double> values = numbers(width * tuples, stored, wanted);
    if (wanted) out_.add(name, stored, width, values, tuples);
  }

  std::filesystem::path path_;
  const ReadOptions& options_;
  Progress& progress_;
  VtkArrays out_;
  std::string text_;
  std::size_t at_ = 0, tuples_ = 0;
  bool is_binary_ = false, is_of_points_ = false;
};

}  // namespace

std::string text_of(const std::filesystem::path& path) {
  const File file(path);
  return file.read_text(0, std::size_t(file.size()));
}

VtkArrays::Named& VtkArrays::named(const std::string& name, StoredType type) {
  for (Named& one : columns_)
    if (one.column.name == name) return one;
  columns_.push_back({{name, type}, {}});
  return columns_.back();
}

void VtkArrays::add_points(const std::vector<double>& xyz, StoredType type) {
  const std::size_t more = xyz.size() / 3;
  for (std::size_t k = 0; k < 3; ++k) {
    std::vector<double>& values = named(std::string(1, char('x' + k)), type).values;
    for (std::size_t i = 0; i < more; ++i) values.push_back(xyz[3 * i + k]);
  }
  first_point_ = rows_, rows_ += more;
}

void VtkArrays::add_polygons(Polygons polygons) {
  polygons.first_point = first_point_;
  polygons_.push_back(std::move(polygons));
}

Faces VtkArrays::faces_over(const ReadResult& result, Progress& progress) const {
  FaceBuilder builder(result.cloud, kept_vertices(result.cloud, rows_));
  Polygon polygon;
  const auto add = [&] {
    builder.add(polygon, [&] { return "polygon " + std::to_string(builder.faces.count); });
    if (builder.faces.count % 65'536 == 0) progress.check();
  };
  for (const Polygons& all : polygons_) {
    const auto corner = [&](std::size_t k) {
      const double value = all.corners[k];
      return value >= 0 && value < 0x1p32 ? std::int64_t(value) + std::int64_t(all.first_point) : -1;
    };
    const auto take = [&](double first, double end) {
      if (!(first >= 0 && first <= end && end <= double(all.corners.size())))
        bad_input(path_, "polygons", "found one of more corners than there are; the file is damaged");
      polygon.clear();
      for (auto k = std::size_t(first); k < std::size_t(end); ++k) {
        if (!all.are_strips) {
          polygon.vertices.push_back(corner(k));
        } else if (k >= std::size_t(first) + 2) {
          const bool is_turned = (k - std::size_t(first)) % 2 != 0;
          polygon.vertices = {corner(k - 2), corner(k - !is_turned), corner(k - is_turned)};
          add();
        }
      }
      if (!all.are_strips) add();
    };
    double first = 0;
    for (const double end : all.ends) take(first, end), first = end;
    for (std::size_t at = 0; all.ends.empty() && at < all.corners.size();) {
      take(double(at) + 1, double(at) + 1 + all.corners[at]);
      at += 1 + std::size_t(all.corners[at]);
    }
  }
  return std::move(builder.faces);
}

void VtkArrays::add(const std::string& name, StoredType type, std::size_t width,
                    const std::vector<double>& values, std::size_t count) {
  if (count > rows_ || values.size() < count * width) return;
  std::string plain;  // %20 and the like, as VTK writes blanks
  for (std::size_t i = 0; i < name.size(); ++i) {
    unsigned code = 0;
    if (name[i] == '%' && i + 2 < name.size() &&
        std::from_chars(name.data() + i + 1, name.data() + i + 3, code, 16).ptr == name.data() + i + 3)
      plain += code < ' ' ? '?' : char(code), i += 2;
    else
      plain += name[i];
  }
  std::vector<std::string> names = columns_named(plain, width);
  if (plain == "x" || plain == "y" || plain == "z" || names[0] == "x") return;  // those are the points
  // Three bytes a point are colours, whatever they are called.
  if (names[0] != "red" && type == StoredType::uint8 && (width == 3 || width == 4))
    names = columns_named("rgb", width);
  for (std::size_t k = 0; k < width; ++k) {
    std::vector<double>& to = named(names[k], type).values;
    to.resize(rows_ - count, std::nan(""));
    for (std::size_t i = 0; i < count; ++i) to.push_back(values[i * width + k]);
  }
}

ReadResult VtkArrays::build(const ReadOptions& options, Progress& progress) {
  std::vector<Column> columns;
  for (Named& one : columns_) one.values.resize(rows_, std::nan("")), columns.push_back(one.column);
  use_usual_names(columns);
  if (!assign_roles(columns))
    bad_input(path_, "points", "found none; write poly data or an unstructured grid");
  Table table(std::move(columns), rows_);
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    std::copy(columns_[i].values.begin(), columns_[i].values.end(), table.column(i).begin());
    columns_[i].values = {};
  }
  ReadResult result;
  const bool has_faces = options.faces && !polygons_.empty() && !why_dropped_;
  table.build(has_faces, progress, result);
  if (why_dropped_) result.report.notes.push_back(vertices_alone(File(path_), *why_dropped_));
  if (has_faces) take_faces(File(path_), options, result, [&] { return faces_over(result, progress); });
  return result;
}

bool is_vtk(std::string_view head) { return head.starts_with("# vtk DataFile Version"); }

ReadResult read_vtk(const std::filesystem::path& file, const ReadOptions& options, Progress& progress) {
  return LegacyReader(file, options, progress).read();
}

}  // namespace sfumato::io
