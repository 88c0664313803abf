// Geomview's OFF, as CGAL, ModelNet and others write: counts, vertices, faces; with normals (N), colours (C)
// and texture coordinates (ST, passed over) of vertices, and colours of faces.
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/counted.h"
#include "io/faces.h"
#include "io/file.h"
#include "io/format.h"
#include "io/text_rows.h"

namespace sfumato::io {
namespace {

/// Blank lines and comments are no rows.
bool holds_numbers(std::string_view line) {
  const char *end = line.data() + line.size(), *at = skip_blanks(line.data(), end);
  return at < end && *at != '#';
}

/// Up to a comment.
std::vector<double> numbers_in(std::string_view line) {
  line = line.substr(0, line.find('#'));
  std::vector<double> numbers;
  const char *at = line.data(), *end = at + line.size();
  while ((at = skip_blanks(at, end)) < end) numbers.push_back(next_number(at, end, "a number"));
  return numbers;
}

/// The letters before OFF; nothing where the line is no first line of such a file.
std::optional<std::string_view> off_kind(std::string_view line) {
  line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
  const std::size_t name = line.find("OFF");
  if (name == std::string_view::npos || line.substr(0, name).find_first_not_of("STCN4n") < name)
    return std::nullopt;
  const std::string_view behind = line.substr(name + 3);
  const bool ends = behind.empty() || is_blank(behind[0]) || (behind[0] >= '0' && behind[0] <= '9');
  return ends ? std::optional(line.substr(0, name)) : std::nullopt;
}

struct OffHeader {
  std::uint64_t rows = 0;  ///< before the vertices
  std::uint64_t vertices = 0, faces = 0;
  bool has_normals = false, has_colors = false;
  std::size_t width = 0;  ///< numbers of the first vertex
};

OffHeader read_off_header(const File& file) {
  LineReader lines(file, 0, 1);
  std::string_view line;
  const auto next = [&](const char* expected) {
    while (lines.next(line))
      if (holds_numbers(line)) return;
    bad_input(file.path(), "line " + std::to_string(lines.line_number()),
              std::string("the file ends before ") + expected + "; it is cut short, fetch it again");
  };
  OffHeader header;
  try {
    next("its first line");
    const std::optional<std::string_view> kind = off_kind(line);
    if (!kind) throw LineError("found no line OFF");
    header.has_normals = kind->find('N') != std::string_view::npos;
    header.has_colors = kind->find('C') != std::string_view::npos;
    if (kind->find_first_of("4n") != std::string_view::npos)
      throw LineError("found other than three coordinates; export three");
    std::string_view counts = line.substr(line.find("OFF") + 3);
    if (counts.find("BINARY") != std::string_view::npos)
      throw LineError("found binary OFF; export it as text");
    header.rows = 1;
    if (!holds_numbers(counts)) next("its counts"), counts = line, ++header.rows;
    const std::vector<double> numbers = numbers_in(counts);
    const auto is_count = [](double number) {
      return number >= 0 && number < 1e15 && number == std::floor(number);
    };
    if (numbers.size() < 2 || !is_count(numbers[0]) || !is_count(numbers[1]))
      throw LineError("expected the numbers of vertices, faces and edges");
    header.vertices = std::uint64_t(numbers[0]), header.faces = std::uint64_t(numbers[1]);
    if (header.vertices == 0) throw LineError("found no vertices");
    next("its first vertex");
    header.width = numbers_in(line).size();
  } catch (const LineError& error) {
    bad_input(file.path(), "line " + std::to_string(lines.line_number()), error.what());
  }
  // Programs that write colours without saying so: three numbers more, or four.
  const std::size_t before_colors = header.has_normals ? 6 : 3;
  if (header.width < before_colors + 3)
    header.has_colors = false;
  else if (header.width - before_colors <= 4)
    header.has_colors = true;
  return header;
}

class OffVertices final : public LineGrammar {
 public:
  explicit OffVertices(std::size_t columns) : columns_(columns) {}
  bool counts(std::string_view line) const override { return holds_numbers(line); }
  bool parse(std::string_view line, double* row) const override {
    const char *at = line.data(), *end = at + line.size();
    for (std::size_t k = 0; k < columns_; ++k) *row++ = next_number(at, end, "a number of a vertex");
    return true;
  }

 private:
  std::size_t columns_;
};

/// `17`, a place in a colour map, tells none; 3 or 4 numbers are of 255 where they are whole, else of 1.
std::optional<Rgba8> face_color(std::string_view text) {
  const std::vector<double> numbers = numbers_in(text);
  if (numbers.size() < 3) return std::nullopt;
  const double scale = text.find('.') == std::string_view::npos ? 1 : 255;
  const auto byte = [&](double value) {
    return std::uint8_t(std::min(std::max(0.0, value * scale), 255.0) + 0.5);
  };
  return Rgba8{byte(numbers[0]), byte(numbers[1]), byte(numbers[2]), 255};
}

Faces read_off_faces(const File& file, const OffHeader& header, const ReadResult& vertices,
                     Progress& progress) {
  FaceBuilder builder(vertices.cloud, kept_vertices(vertices.cloud, header.vertices));
  Faces& faces = builder.faces;
  LineReader lines(file, 0, 1);
  std::string_view line;
  Polygon polygon;
  std::uint64_t row = 0;
  while (faces.count < header.faces && lines.next(line)) {
    if (lines.line_number() % 65536 == 0) progress.check();
    if (!holds_numbers(line) || ++row <= header.rows + header.vertices) continue;
    const std::string place = "line " + std::to_string(lines.line_number());
    try {
      polygon.clear();
      const char *at = line.data(), *end = at + line.size();
      const double corners = next_number(at, end, "the number of corners");
      for (double k = 0; k < corners; ++k) {
        const double vertex = next_number(at, end, "a corner");
        polygon.vertices.push_back(vertex >= 0 && vertex < 1e15 ? std::int64_t(vertex) : -1);
      }
      const std::optional<Rgba8> color = face_color({at, std::size_t(end - at)});
      builder.add(polygon, [&] { return place; });
      builder.set_color(color);
    } catch (const LineError& error) {
      bad_input(file.path(), place, std::string(error.what()) + "; the file is damaged, export it again");
    }
  }
  if (faces.count < header.faces)
    bad_input(file.path(), "line " + std::to_string(lines.line_number()),
              "the file ends after " + counted(faces.count, "face") + ", expected " +
                  std::to_string(header.faces) + "; it is cut short, fetch it again");
  builder.forget_one_color();
  return std::move(faces);
}

}  // namespace

bool is_off(std::string_view head) {
  while (!head.empty()) {
    const std::size_t end = std::min(head.find('\n'), head.size());
    const std::string_view line = head.substr(0, end);
    if (holds_numbers(line)) return off_kind(line).has_value();
    head.remove_prefix(std::min(head.size(), end + 1));
  }
  return false;
}

ReadResult read_off(const std::filesystem::path& path, const ReadOptions& options, Progress& progress) {
  const File file(path);
  const OffHeader header = read_off_header(file);
  std::vector<Column> columns;
  for (const char* name : {"x", "y", "z"}) columns.push_back({name, StoredType::float64});
  if (header.has_normals)
    for (const char* name : {"nx", "ny", "nz"}) columns.push_back({name, StoredType::float32});
  if (header.has_colors)
    for (const char* name : {"red", "green", "blue"}) columns.push_back({name, StoredType::float32});
  assign_roles(columns);
  const OffVertices grammar(columns.size());
  const TextBlocks text = cut_lines(file, 0, 1, grammar, progress);
  if (text.rows < header.rows + header.vertices)
    bad_input(path, "line " + std::to_string(text.lines),
              "the file ends after " + counted(text.rows - header.rows, "line") + ", expected " +
                  std::to_string(header.vertices) + " vertices; it is cut short, fetch it again");
  ReadResult result;
  if (header.faces > 0) result.cloud.provenance = Provenance::model;
  read_rows(file, text, header.rows, header.rows + header.vertices, grammar, std::move(columns),
            options.faces != nullptr, progress, result);
  if (options.faces)
    take_faces(file, options, result, [&] { return read_off_faces(file, header, result, progress); });
  return result;
}

}  // namespace sfumato::io
