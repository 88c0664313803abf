// Wavefront OBJ: vertices `v x y z [w] [r g b]`; faces with normals, pictures and colours for those who want
// them. Everything else is passed over.
#include <algorithm>
#include <charconv>
#include <map>

#include "io/faces.h"
#include "io/file.h"
#include "io/format.h"
#include "io/text_rows.h"

namespace sfumato::io {
namespace {

constexpr std::size_t width_with_color = 6;

bool is_vertex(std::string_view line) {
  return line.size() >= 2 && line[0] == 'v' && (line[1] == ' ' || line[1] == '\t');
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
  result.cloud.up = UpAxis::pos_y, result.cloud.provenance = Provenance::model;
  read_rows(file, text, 0, text.rows, grammar, std::move(columns), keep_places, progress, result);
  return result;
}

/// Place of what a corner names, `17` or `-1` (counted from the latest of `so_far`); LineError when it is
/// neither.
std::int64_t parse_place(const char*& at, const char* end, std::uint64_t so_far) {
  std::int64_t number = 0;
  const auto [behind, error] = std::from_chars(at, end, number);
  if (error != std::errc() || number == 0)
    throw LineError("found the corner '" + std::string(at, std::min<std::size_t>(20, std::size_t(end - at))) +
                    "', expected a vertex number");
  at = behind;
  return number > 0 ? number - 1 : std::int64_t(so_far) + number;
}

/// Faces and what belongs to them, line after line.
class FaceLines {
 public:
  FaceLines(const File& file, const ReadResult& vertices)
      : file_(file), builder_(vertices.cloud, kept_vertices(vertices.cloud, vertices.report.points)) {}

  Faces read(Progress& progress) {
    LineReader lines(file_, 0, 1);
    std::string_view line;
    while (lines.next(line)) {
      if (lines.line_number() % 65536 == 0) progress.check();
      if (line.size() < 2) continue;
      try {
        take(line, lines.line_number());
      } catch (const LineError& error) {
        bad_input(file_.path(), "line " + std::to_string(lines.line_number()),
                  std::string(error.what()) + "; the file is damaged, export it again");
      }
    }
    builder_.forget_one_color();
    return std::move(builder_.faces);
  }

 private:
  void take(std::string_view line, std::uint64_t number) {
    const char *at = line.data(), *end = at + line.size();
    if (line[0] == 'f' && is_blank(line[1])) return take_face(at + 1, end, number);
    if (line[0] == 'v') {
      vertices_ += is_blank(line[1]);
      if (line.size() < 4 || !is_blank(line[2])) return;
      at += 2;
      if (line[1] == 't') {
        const double u = next_number(at, end, "u"), v = next_number(at, end, "v");
        builder_.faces.texture_places.emplace_back(u, v);
      } else if (line[1] == 'n') {
        vec3 normal;
        for (int k = 0; k < 3; ++k) normal[k] = float(next_number(at, end, "a normal"));
        const float length = glm::length(normal);
        builder_.faces.normals.push_back(length > 0 && std::isfinite(length) ? normal / length : vec3(0));
      }
    } else if (line.starts_with("mtllib ")) {
      take_library(line.substr(7));
    } else if (line.starts_with("usemtl ")) {
      take_material(line.substr(7));
    }
  }

  void take_face(const char* at, const char* end, std::uint64_t number) {
    Faces& faces = builder_.faces;
    polygon_.clear();
    while ((at = skip_blanks(at, end)) < end) {
      polygon_.vertices.push_back(parse_place(at, end, vertices_));
      for (const bool of_texture : {true, false}) {  // 17/3/5, 17/3, 17//5
        if (at == end || *at != '/') break;
        ++at;
        if (at == end || *at == '/' || is_blank(*at)) continue;
        std::vector<std::int64_t>& places = of_texture ? polygon_.textures : polygon_.normals;
        places.resize(polygon_.vertices.size() - 1, -1);
        places.push_back(
            parse_place(at, end, of_texture ? faces.texture_places.size() : faces.normals.size()));
      }
      if (at < end && !is_blank(*at)) parse_place(at, at, 0);
    }
    builder_.add(polygon_, [&] { return "line " + std::to_string(number); });
    const std::size_t triangles = faces.triangles.size();
    if (texture_ != Faces::none || !faces.texture_no.empty()) {
      faces.texture_no.resize(std::min(faces.texture_no.size(), triangles));
      faces.texture_no.resize(triangles, texture_);
    }
    builder_.set_color(color_);
  }

  void take_library(std::string_view name) {
    const std::optional<std::filesystem::path> found = file_beside(file_.path(), name);
    if (!found) return miss(name);
    try {
      for (auto& [key, material] : read_materials(*found)) materials_[key] = material;
    } catch (const Error&) {
      miss(name);
    }
  }

  void take_material(std::string_view name) {
    while (!name.empty() && is_blank(name.back())) name.remove_suffix(1);
    texture_ = Faces::none, color_.reset();
    const auto material = materials_.find(name);
    if (material == materials_.end()) return;
    color_ = material->second.color;
    const std::string& picture = material->second.picture;
    if (picture.empty()) return;
    if (const auto known = pictures_.find(picture); known != pictures_.end()) {
      texture_ = known->second;
      return;
    }
    if (const std::optional<std::filesystem::path> found = file_beside(file_.path(), picture)) {
      try {
        builder_.faces.textures.push_back(read_texture(*found));
        texture_ = std::uint32_t(builder_.faces.textures.size() - 1);
      } catch (const Error& error) {
        if (error.code() != ErrorCode::bad_input) throw;
        builder_.faces.without_colors = error.what();
      }
    } else {
      miss(picture);
    }
    pictures_[picture] = texture_;
  }

  void miss(std::string_view name) {
    while (!name.empty() && is_blank(name.back())) name.remove_suffix(1);
    builder_.faces.without_colors = std::string(name) + " is not beside the file";
  }

  const File& file_;
  FaceBuilder builder_;
  Polygon polygon_;
  std::uint64_t vertices_ = 0;
  std::map<std::string, Material, std::less<>> materials_;
  std::map<std::string, std::uint32_t, std::less<>> pictures_;
  std::uint32_t texture_ = Faces::none;
  std::optional<Rgba8> color_;
};

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

ReadResult read_obj(const std::filesystem::path& path, const ReadOptions& options, Progress& progress) {
  const File file(path);
  ReadResult result = read_vertices(file, options.faces != nullptr, progress);
  if (options.faces)
    take_faces(file, options, result, [&] { return FaceLines(file, result).read(progress); });
  return result;
}

}  // namespace sfumato::io
