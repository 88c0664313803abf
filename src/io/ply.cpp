// Stanford PLY (Turk 1994). Any property order and type; lists are walked over; ascii and both byte orders.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>

#include "io/columns.h"
#include "core/counted.h"
#include "io/faces.h"
#include "io/file.h"
#include "io/format.h"
#include "io/parallel.h"
#include "io/ply_header.h"
#include "io/splats.h"
#include "io/text_rows.h"

namespace sfumato::io {
namespace {

constexpr std::size_t bytes_at_once = 1 << 20;

/// The scalar properties of a vertex as columns, laid out as in a binary record without lists.
std::vector<Column> vertex_columns(const File& file, const PlyElement& vertex) {
  std::vector<Column> columns;
  std::size_t offset = 0;
  for (const PlyProperty& property : vertex.properties) {
    if (property.is_list) continue;
    columns.push_back({property.name, property.type, property.type, offset, 0, Role::scalar});
    offset += size_of(property.type);
  }
  for (Column& column : columns) column.stride = offset;
  if (!assign_roles(columns))
    bad_input(file.path(), "header",
              "the vertex element has no properties x, y and z; export it with positions");
  use_usual_names(columns);
  return columns;
}

std::string count_of(const PlyElement& vertex) {
  return std::to_string(vertex.count) + (vertex.count == 1 ? " vertex" : " vertices");
}

/// Points of fixed-size records: each thread reads its share of the file in big blocks.
void read_records(const File& file, const PlyHeader& header, std::uint64_t begin, bool keep_places,
                  Progress& progress, ReadResult& result) {
  const PlyElement& vertex = header.elements[header.vertex];
  std::vector<Column> columns = vertex_columns(file, vertex);
  const std::size_t size = vertex.record_size();
  const std::uint64_t room = file.size() - std::min(begin, file.size());
  const auto count = std::size_t(
      held_points(file, "byte " + std::to_string(file.size()), room / size, vertex.count, result.report));
  CloudBuilder builder(std::move(columns), count, header.big_endian, keep_places);
  const std::size_t threads = count < 20000 ? 1 : thread_count();
  std::vector<CloudBuilder::Cursor> cursors;
  for (std::size_t t = 0; t < threads; ++t)
    cursors.push_back(builder.cursor(count * t / threads, count * (t + 1) / threads));
  std::atomic<std::size_t> done{0};
  in_parallel(threads, [&](std::size_t t) {
    CloudBuilder::Cursor& cursor = cursors[t];
    const std::size_t block = std::max<std::size_t>(1, bytes_at_once / size);
    std::vector<std::byte> bytes(std::min(block, cursor.end - cursor.begin) * size);
    for (std::size_t i = cursor.begin; i < cursor.end; i += block) {
      progress.check();
      const std::size_t n = std::min(block, cursor.end - i);
      file.read(begin + std::uint64_t(i) * size, std::span(bytes).first(n * size));
      builder.decode(cursor, bytes.data(), 0, n, i);
      progress.update(double(done += n) / double(count), "reading");
    }
  });
  builder.finish(cursors, result);
}

/// Points whose records hold lists: one after the other, the lists left out.
void read_walked(const File& file, const PlyHeader& header, std::uint64_t begin, bool keep_places,
                 Progress& progress, ReadResult& result) {
  const PlyElement& vertex = header.elements[header.vertex];
  std::vector<Column> columns = vertex_columns(file, vertex);
  std::size_t least = 0;  // a list takes at least its length
  for (const PlyProperty& property : vertex.properties)
    least += size_of(property.is_list ? property.count_type : property.type);
  const std::uint64_t room = file.size() - std::min(begin, file.size());
  if (vertex.count > room / least)
    bad_input(file.path(), "byte " + std::to_string(file.size()),
              "the file has room for at most " + counted(room / least, "point") + ", expected " +
                  count_of(vertex) + "; it is cut short, fetch it again");
  const std::size_t width = columns.size();
  lay_out_as_doubles(columns);
  CloudBuilder builder(columns, std::size_t(vertex.count), false, keep_places);
  std::vector<CloudBuilder::Cursor> cursors = {builder.cursor(0, std::size_t(vertex.count))};
  PlyWalker walker(file, header.big_endian, begin);
  constexpr std::size_t rows = 512;
  std::vector<double> block(rows * width);
  for (std::uint64_t i = 0; i < vertex.count; i += rows) {
    progress.check();
    progress.update(double(i) / double(vertex.count), "reading");
    const std::size_t n = std::size_t(std::min<std::uint64_t>(rows, vertex.count - i));
    auto to = block.begin();
    for (std::size_t row = 0; row < n; ++row)
      for (const PlyProperty& property : vertex.properties) {
        if (property.is_list)
          walker.skip(walker.list_length(property) * size_of(property.type));
        else
          *to++ = walker.number(property.type);
      }
    builder.decode(cursors[0], reinterpret_cast<const std::byte*>(block.data()), 0, n, i);
  }
  builder.finish(cursors, result);
}

/// One vertex a line; the numbers of lists are passed over.
class ElementLines final : public LineGrammar {
 public:
  explicit ElementLines(const PlyElement& vertex) : vertex_(vertex) {}
  bool parse(std::string_view line, double* row) const override {
    const char *at = line.data(), *end = at + line.size();
    for (const PlyProperty& property : vertex_.properties) {
      const double value = next_number(at, end, property.name);
      if (!property.is_list) {
        *row++ = value;
        continue;
      }
      if (!(value >= 0 && value <= double(line.size())))
        throw LineError("the list '" + property.name + "' is too long");
      for (int i = 0; i < int(value); ++i) next_number(at, end, property.name);
    }
    return true;
  }

 private:
  const PlyElement& vertex_;
};

void read_lines(const File& file, const PlyHeader& header, bool keep_places, Progress& progress,
                ReadResult& result) {
  const PlyElement& vertex = header.elements[header.vertex];
  std::vector<Column> columns = vertex_columns(file, vertex);
  const ElementLines grammar(vertex);
  const TextBlocks text = cut_lines(file, header.data_begin, header.lines + 1, grammar, progress);
  std::uint64_t before = 0;
  for (std::size_t i = 0; i < header.vertex; ++i) before += std::min(header.elements[i].count, text.rows);
  const std::uint64_t left = text.rows - std::min(text.rows, before);
  const std::uint64_t held =
      held_points(file, "line " + std::to_string(text.lines),
                  left < vertex.count ? whole_lines(file, left) : left, vertex.count, result.report);
  read_rows(file, text, before, before + held, grammar, std::move(columns), keep_places, progress, result);
}

/// Vertices that take several lines each, as the viewer of RealSense writes them: numbers wherever lines end.
void read_numbers(const File& file, const PlyHeader& header, bool keep_places, Progress& progress,
                  ReadResult& result) {
  const PlyElement& vertex = header.elements[header.vertex];
  std::vector<Column> columns = vertex_columns(file, vertex);
  const std::size_t width = columns.size();
  lay_out_as_doubles(columns);
  // A number and what parts it from the next take two bytes: no more points than so is memory asked for.
  const std::uint64_t room = std::min<std::uint64_t>(vertex.count, file.size() / (2 * width) + 1);
  CloudBuilder builder(columns, std::size_t(room), false, keep_places);
  std::vector<CloudBuilder::Cursor> cursors = {builder.cursor(0, std::size_t(room))};
  LineReader lines(file, header.data_begin, header.lines + 1);
  std::string_view line;
  const char *at = nullptr, *end = nullptr;
  std::vector<double> row(width);
  const auto is_at_end = [&] {
    while ((at = skip_blanks(at, end)) == end) {
      if (!lines.next(line)) return true;
      at = line.data(), end = at + line.size();
    }
    return false;
  };
  std::uint64_t held = vertex.count;
  for (std::uint64_t i = 0; i < held; ++i) {
    if (i % 65536 == 0) progress.check(), progress.update(double(i) / double(vertex.count), "reading");
    for (std::size_t k = 0; k < width; ++k) {
      if (is_at_end()) {
        held =
            held_points(file, "line " + std::to_string(lines.line_number()), i, vertex.count, result.report);
        break;
      }
      try {
        row[k] = next_number(at, end, vertex.properties[k].name);
      } catch (const LineError& error) {
        bad_input(file.path(), "line " + std::to_string(lines.line_number()),
                  std::string(error.what()) + "; the file is damaged, fetch it again");
      }
    }
    if (i < held) builder.decode(cursors[0], reinterpret_cast<const std::byte*>(row.data()), 0, 1, i);
  }
  builder.finish(cursors, result);
}

}  // namespace

ReadResult read_ply_vertices(const File& file, const PlyHeader& header, bool keep_places,
                             Progress& progress) {
  if (are_packed_splats(header)) return read_packed_splats(file, header, progress);
  ReadResult result;
  result.cloud.up = header.up;
  result.cloud.up_is_known = header.says_up;
  result.cloud.crs = result.report.crs = header.crs;
  if (header.ascii) {
    const auto read = header.vertex_lines > 1 ? read_numbers : read_lines;
    read(file, header, keep_places, progress, result);
    color_by_harmonics(result);
    return result;
  }
  PlyWalker walker(file, header.big_endian, header.data_begin);
  for (std::size_t i = 0; i < header.vertex; ++i) walker.skip_element(header.elements[i], progress);
  if (header.elements[header.vertex].has_list())
    read_walked(file, header, walker.position(), keep_places, progress, result);
  else
    read_records(file, header, walker.position(), keep_places, progress, result);
  color_by_harmonics(result);
  return result;
}

bool is_ply(std::string_view head) { return head.starts_with("ply\n") || head.starts_with("ply\r"); }

ReadResult read_ply(const std::filesystem::path& path, const ReadOptions& options, Progress& progress) {
  const File file(path);
  const PlyHeader header = read_ply_header(file);
  const bool declares_faces = has_ply_faces(header), has_faces = options.faces && declares_faces;
  ReadResult result = read_ply_vertices(file, header, has_faces, progress);
  // As trainers of splats store what COLMAP found, in the axes of a camera: with normals, all of them zero.
  const ReadReport& report = result.report;
  if (header.up == UpAxis::pos_y && !header.says_up && !has_faces && !result.cloud.colors.empty() &&
      report.points_finite > 0 && report.normals_dropped == report.points_finite)
    result.cloud.up = UpAxis::neg_y;
  if (has_faces && report.points_missing > 0)
    result.cloud.grid_index.clear();  // the faces lie behind what is missing
  else if (has_faces)
    take_faces(file, options, result, [&] { return read_ply_faces(file, header, result, progress); });
  result.has_faces = declares_faces;
  return result;
}

}  // namespace sfumato::io
