// The faces of a PLY file: polygons, or strips of triangles, with their colours and places in a picture.
#include <algorithm>
#include <array>
#include <cmath>

#include "io/faces.h"
#include "io/format.h"
#include "io/ply_header.h"
#include "io/text_rows.h"

namespace sfumato::io {
namespace {

const PlyProperty* list_of(const PlyElement& element, std::initializer_list<const char*> names) {
  for (const PlyProperty& property : element.properties)
    if (property.is_list && std::find(names.begin(), names.end(), property.name) != names.end())
      return &property;
  return nullptr;
}
const PlyProperty* corners_of(const PlyElement& element) {
  return list_of(element, {"vertex_indices", "vertex_index"});
}

/// A corner's number; anything that is no whole number becomes -1, which no vertex is.
std::int64_t to_corner(double value) {
  return value >= 0 && value < 0x1p32 && value == std::floor(value) ? std::int64_t(value) : -1;
}

/// Takes the numbers of one face after the other.
class FaceRecords {
 public:
  FaceRecords(const PlyElement& element, FaceBuilder& builder)
      : builder_(builder),
        corners_(corners_of(element)),
        places_(list_of(element, {"texcoord"})),
        are_strips_(element.name == "tristrips") {
    for (const PlyProperty& property : element.properties)
      for (std::size_t k = 0; k < 3; ++k)
        if (!property.is_list && property.name == std::array{"red", "green", "blue"}[k])
          channel_[k] = &property;
    is_colored_ =
        std::all_of(channel_.begin(), channel_.end(), [](const PlyProperty* p) { return p != nullptr; });
  }

  bool wants(const PlyProperty& property) const {
    return &property == corners_ || &property == places_ ||
           (is_colored_ && std::find(channel_.begin(), channel_.end(), &property) != channel_.end());
  }
  void number(const PlyProperty& property, double value) {
    if (&property == corners_)
      polygon_.vertices.push_back(are_strips_ && value == -1 ? -1 : to_corner(value));
    if (&property == places_) texture_.push_back(float(value));
    for (std::size_t k = 0; k < 3; ++k)
      if (&property == channel_[k]) {
        const double scale = property.type == StoredType::float32 || property.type == StoredType::float64
                                 ? 255
                             : property.type == StoredType::uint16 ? 1 / 257.0
                                                                   : 1;
        color_[k] = std::uint8_t(std::clamp(value * scale + 0.5, 0.0, 255.0));
      }
  }
  template <class Place>
  void end(const Place& place) {
    Faces& faces = builder_.faces;
    if (are_strips_) {
      end_strips(place);
    } else {
      if (!texture_.empty() && texture_.size() == 2 * polygon_.vertices.size())
        for (std::size_t k = 0; k < texture_.size(); k += 2) {
          polygon_.textures.push_back(std::int64_t(faces.texture_places.size()));
          faces.texture_places.emplace_back(texture_[k], texture_[k + 1]);
        }
      builder_.add(polygon_, place);
    }
    if (is_colored_) faces.colors.resize(faces.triangles.size(), Rgba8{color_[0], color_[1], color_[2], 255});
    polygon_.clear(), texture_.clear();
  }

 private:
  /// Every second triangle of a strip turns the other way; -1 begins another strip.
  template <class Place>
  void end_strips(const Place& place) {
    const std::vector<std::int64_t>& strip = polygon_.vertices;
    Polygon triangle;
    for (std::size_t i = 0, from = 0; i < strip.size(); ++i) {
      if (strip[i] < 0) from = i + 1;
      if (i < from + 2) continue;
      triangle.vertices = {strip[i - 2], strip[i - 1], strip[i]};
      if ((i - from) % 2 != 0) std::swap(triangle.vertices[0], triangle.vertices[1]);
      builder_.add(triangle, place);
    }
  }

  FaceBuilder& builder_;
  const PlyProperty *corners_ = nullptr, *places_ = nullptr;
  bool are_strips_ = false, is_colored_ = false;
  std::array<const PlyProperty*, 3> channel_{};
  Polygon polygon_;
  std::vector<float> texture_;
  std::array<std::uint8_t, 3> color_{};
};

void read_binary_faces(const File& file, const PlyHeader& header, std::size_t face, FaceBuilder& builder,
                       Progress& progress) {
  PlyWalker walker(file, header.big_endian, header.data_begin);
  for (std::size_t i = 0; i < face; ++i) walker.skip_element(header.elements[i], progress);
  const PlyElement& element = header.elements[face];
  FaceRecords records(element, builder);
  for (std::uint64_t i = 0; i < element.count; ++i) {
    if (i % 65536 == 0) progress.check();
    const std::uint64_t begin = walker.position();
    for (const PlyProperty& property : element.properties) {
      const std::uint64_t length = property.is_list ? walker.list_length(property) : 1;
      if (!records.wants(property)) {
        walker.skip(length * size_of(property.type));
        continue;
      }
      for (std::uint64_t k = 0; k < length; ++k) records.number(property, walker.number(property.type));
    }
    records.end([&] { return "byte " + std::to_string(begin); });
  }
}

void read_ascii_faces(const File& file, const PlyHeader& header, std::size_t face, FaceBuilder& builder,
                      Progress& progress) {
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
    for (std::uint64_t k = 0; k < header.elements[i].count; ++k) {
      if (k % 65536 == 0) progress.check();
      for (std::size_t part = 0; part < (i == header.vertex ? header.vertex_lines : 1); ++part) next();
    }
  const PlyElement& element = header.elements[face];
  FaceRecords records(element, builder);
  for (std::uint64_t i = 0; i < element.count; ++i) {
    if (i % 65536 == 0) progress.check();
    next();
    const std::string place = "line " + std::to_string(lines.line_number());
    try {
      const char *at = line.data(), *end = at + line.size();
      for (const PlyProperty& property : element.properties)
        for (double length = property.is_list ? next_number(at, end, property.name) : 1; length > 0; --length)
          records.number(property, next_number(at, end, property.name));
    } catch (const LineError& error) {
      bad_input(file.path(), place, std::string(error.what()) + "; the file is damaged, fetch it again");
    }
    records.end([&] { return place; });
  }
}

}  // namespace

bool has_ply_faces(const PlyHeader& header) {
  return std::any_of(header.elements.begin(), header.elements.end(),
                     [](const PlyElement& element) { return element.count > 0 && corners_of(element); });
}

Faces read_ply_faces(const File& file, const PlyHeader& header, const ReadResult& vertices,
                     Progress& progress) {
  FaceBuilder builder(vertices.cloud, kept_vertices(vertices.cloud, vertices.report.points));
  for (std::size_t i = 0; i < header.elements.size(); ++i) {
    if (!corners_of(header.elements[i])) continue;
    if (header.ascii)
      read_ascii_faces(file, header, i, builder, progress);
    else
      read_binary_faces(file, header, i, builder, progress);
  }
  Faces& faces = builder.faces;
  if (header.texture.empty()) return std::move(faces);
  if (const auto found = file_beside(file.path(), header.texture)) {
    try {
      faces.textures.push_back(read_texture(*found));
    } catch (const Error& error) {
      if (error.code() != ErrorCode::bad_input) throw;
      faces.without_colors = error.what();
    }
  } else if (vertices.cloud.colors.empty()) {
    faces.without_colors = header.texture + " is not beside the file";
  }
  return std::move(faces);
}

}  // namespace sfumato::io
