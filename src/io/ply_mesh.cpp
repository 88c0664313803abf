// The faces of a PLY file, for those who want the surface and not only its corners.
#include <algorithm>
#include <cmath>

#include "io/format.h"
#include "io/ply_header.h"
#include "io/text_rows.h"

namespace sfumato::io {
namespace {

const PlyProperty* corners_of(const PlyElement& face) {
  for (const PlyProperty& property : face.properties)
    if (property.is_list && (property.name == "vertex_indices" || property.name == "vertex_index"))
      return &property;
  return nullptr;
}

[[noreturn]] void bad_corner(const File& file, const std::string& place, std::uint64_t vertices) {
  bad_input(file.path(), place,
            "found a face with a corner outside the " + std::to_string(vertices) +
                " vertices; the file is damaged, export it again");
}

/// A corner's number; anything that is no whole number becomes -1, which `add_fan` refuses.
std::int64_t to_corner(double value) {
  return value >= 0 && value < 0x1p32 && value == std::floor(value) ? std::int64_t(value) : -1;
}

void read_binary_faces(const File& file, const PlyHeader& header, std::size_t face,
                       const std::vector<std::int64_t>& vertex_of, Mesh& mesh, Progress& progress) {
  PlyWalker walker(file, header.big_endian, header.data_begin);
  for (std::size_t i = 0; i < face; ++i) walker.skip_element(header.elements[i], progress);
  const PlyElement& element = header.elements[face];
  const PlyProperty* corners = corners_of(element);
  std::vector<std::int64_t> polygon;
  for (std::uint64_t i = 0; i < element.count; ++i) {
    if (i % 65536 == 0) progress.check();
    const std::uint64_t begin = walker.position();
    for (const PlyProperty& property : element.properties) {
      const std::uint64_t length = property.is_list ? walker.list_length(property) : 1;
      if (&property != corners) {
        walker.skip(length * size_of(property.type));
        continue;
      }
      polygon.clear();
      for (std::uint64_t k = 0; k < length; ++k) polygon.push_back(to_corner(walker.number(property.type)));
    }
    if (!add_fan(polygon, vertex_of, mesh))
      bad_corner(file, "byte " + std::to_string(begin), vertex_of.size());
  }
}

void read_ascii_faces(const File& file, const PlyHeader& header, std::size_t face,
                      const std::vector<std::int64_t>& vertex_of, Mesh& mesh, Progress& progress) {
  LineReader lines(file, header.data_begin, header.lines + 1);
  std::string_view line;
  const auto next = [&] {
    do {
      if (!lines.next(line))
        bad_input(file.path(), "line " + std::to_string(lines.line_number()),
                  "the file ends before its last face; it is cut short, fetch it again");
    } while (skip_blanks(line.data(), line.data() + line.size()) == line.data() + line.size());
  };
  for (std::size_t i = 0; i < face; ++i)
    for (std::uint64_t k = 0; k < header.elements[i].count; ++k) next();
  const PlyElement& element = header.elements[face];
  const PlyProperty* corners = corners_of(element);
  std::vector<std::int64_t> polygon;
  for (std::uint64_t i = 0; i < element.count; ++i) {
    if (i % 65536 == 0) progress.check();
    next();
    const std::string place = "line " + std::to_string(lines.line_number());
    try {
      const char *at = line.data(), *end = at + line.size();
      for (const PlyProperty& property : element.properties) {
        if (&property == corners) polygon.clear();
        double length = property.is_list ? next_number(at, end, property.name) : 1;
        for (; length > 0; --length) {
          const double value = next_number(at, end, property.name);
          if (&property == corners) polygon.push_back(to_corner(value));
        }
      }
    } catch (const LineError& error) {
      bad_input(file.path(), place, std::string(error.what()) + "; the file is damaged, fetch it again");
    }
    if (!add_fan(polygon, vertex_of, mesh)) bad_corner(file, place, vertex_of.size());
  }
}

}  // namespace

Mesh read_ply_mesh(const std::filesystem::path& path, Progress& progress) {
  const File file(path);
  const PlyHeader header = read_ply_header(file);
  ReadResult vertices = read_ply_vertices(file, header, true, progress);
  const std::vector<std::int64_t> vertex_of = kept_vertices(vertices.cloud, vertices.report.points);
  Mesh mesh;
  mesh.colors = std::move(vertices.cloud.colors);
  for (std::size_t i = 0; i < vertices.cloud.size(); ++i)
    mesh.positions.push_back(vec3(vertices.cloud.world(i)));
  for (std::size_t i = 0; i < header.elements.size(); ++i) {
    if (!corners_of(header.elements[i])) continue;
    if (header.ascii)
      read_ascii_faces(file, header, i, vertex_of, mesh, progress);
    else
      read_binary_faces(file, header, i, vertex_of, mesh, progress);
  }
  return mesh;
}

}  // namespace sfumato::io
