// Wavefront OBJ: vertices `v x y z [w] [r g b]`; faces for meshes. Everything else is passed over.
#include <charconv>

#include "io/file.h"
#include "io/format.h"
#include "io/text_rows.h"

namespace sfumato::io {
namespace {

constexpr std::size_t width_with_color = 6;

bool is_vertex(std::string_view line) {
  return line.size() >= 2 && line[0] == 'v' && (line[1] == ' ' || line[1] == '\t');
}

std::size_t count_words(std::string_view line) {
  std::size_t count = 0;
  const char *at = line.data(), *end = at + line.size();
  while ((at = skip_blanks(at, end)) < end) {
    ++count;
    while (at < end && !is_blank(*at)) ++at;
  }
  return count;
}

class VertexLines final : public LineGrammar {
 public:
  explicit VertexLines(bool colors) : colors_(colors) {}
  bool counts(std::string_view line) const override { return is_vertex(line); }
  bool parse(std::string_view line, double* row) const override {
    const char *at = line.data() + 2, *end = line.data() + line.size();
    for (const char* name : {"x", "y", "z"}) *row++ = next_number(at, end, name);
    if (!colors_) return true;
    for (const char* name : {"red", "green", "blue"}) *row++ = next_number(at, end, name);
    return true;
  }

 private:
  bool colors_;
};

ReadResult read_vertices(const File& file, bool keep_places, Progress& progress) {
  // The first vertex tells whether colours follow the coordinates: 3 or 4 numbers are a position alone.
  LineReader lines(file, 0, 1);
  std::string_view line;
  bool found = false;
  while (!found && lines.next(line)) {
    if (lines.line_number() % 65536 == 0) progress.check();
    found = is_vertex(line);
  }
  if (!found)
    bad_input(file.path(), "line " + std::to_string(lines.line_number()),
              "found no line 'v x y z' in the whole file; export it with vertices");
  const VertexLines grammar(count_words(line.substr(1)) >= width_with_color);
  std::vector<Column> columns;
  for (const char* name : {"x", "y", "z"}) columns.push_back({name, StoredType::float64});
  if (count_words(line.substr(1)) >= width_with_color)
    for (const char* name : {"red", "green", "blue"}) columns.push_back({name, StoredType::float32});
  assign_roles(columns);
  const TextBlocks text = cut_lines(file, 0, 1, grammar, progress);
  ReadResult result;
  result.cloud.up = UpAxis::pos_y;
  read_rows(file, text, 0, text.rows, grammar, std::move(columns), keep_places, progress, result);
  return result;
}

/// The vertex of a corner `17`, `17/3/5` or `-1` (counted from the latest); LineError when it is none of
/// these.
std::int64_t parse_corner(std::string_view word, std::uint64_t vertices_so_far) {
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error != std::errc() || number == 0 || (end < word.data() + word.size() && *end != '/'))
    throw LineError("found the corner '" + std::string(word.substr(0, 20)) + "', expected a vertex number");
  return number > 0 ? number - 1 : std::int64_t(vertices_so_far) + number;
}

}  // namespace

bool is_obj(std::string_view head) {
  while (!head.empty()) {
    const std::size_t end = std::min(head.find('\n'), head.size());
    const std::string_view line = head.substr(0, end);
    if (is_vertex(line) || line.starts_with("mtllib ")) return true;
    // Other statements may come first; anything that is no statement says that this is another format.
    const bool passed = line.empty() || line[0] == '#' || line[0] == '\r' || line.starts_with("o ") ||
                        line.starts_with("g ") || line.starts_with("s ");
    if (!passed) return false;
    head.remove_prefix(std::min(head.size(), end + 1));
  }
  return false;
}

ReadResult read_obj(const std::filesystem::path& path, const ReadOptions&, Progress& progress) {
  const File file(path);
  return read_vertices(file, false, progress);
}

Mesh read_obj_mesh(const std::filesystem::path& path, Progress& progress) {
  const File file(path);
  ReadResult vertices = read_vertices(file, true, progress);
  const std::vector<std::int64_t> vertex_of = kept_vertices(vertices.cloud, vertices.report.points);
  Mesh mesh;
  mesh.colors = std::move(vertices.cloud.colors);
  for (std::size_t i = 0; i < vertices.cloud.size(); ++i)
    mesh.positions.push_back(vec3(vertices.cloud.world(i)));
  LineReader lines(file, 0, 1);
  std::string_view line;
  std::uint64_t vertices_so_far = 0;
  std::vector<std::int64_t> polygon;
  while (lines.next(line)) {
    if (lines.line_number() % 65536 == 0) progress.check();
    vertices_so_far += is_vertex(line);
    if (line.size() < 2 || line[0] != 'f' || !is_blank(line[1])) continue;
    const std::string place = "line " + std::to_string(lines.line_number());
    polygon.clear();
    const char *at = line.data() + 1, *end = line.data() + line.size();
    try {
      while ((at = skip_blanks(at, end)) < end) {
        const char* word = at;
        while (at < end && !is_blank(*at)) ++at;
        polygon.push_back(parse_corner({word, std::size_t(at - word)}, vertices_so_far));
      }
    } catch (const LineError& error) {
      bad_input(file.path(), place, std::string(error.what()) + "; the file is damaged, export it again");
    }
    if (!add_fan(polygon, vertex_of, mesh))
      bad_input(file.path(), place,
                "found a corner outside the " + std::to_string(vertex_of.size()) +
                    " vertices; the file is damaged, export it again");
  }
  return mesh;
}

}  // namespace sfumato::io
