// Faces of a file: what a mesh is drawn from, as points on them.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "io/file.h"
#include "io/io.h"
#include "io/texture.h"

namespace sfumato::io {

/// Points on the faces of a file at most: twice as many as a picture of 1280x720 has pixels. Files with more
/// vertices than this are drawn by those.
constexpr std::uint64_t most_samples = 2'000'000;

using Triangle = std::array<std::uint32_t, 3>;

/// Triangles over the vertices of a cloud, and what their corners carry where the vertices do not.
struct Faces {
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  std::uint64_t count = 0;  ///< polygons, as the file has them
  std::uint64_t bad = 0;    ///< of those, left out: with a corner that is no vertex
  std::string first_bad;    ///< "line 17", "byte 200"
  std::vector<Triangle> triangles;
  /// Of each triangle, places in `normals` and `texture_places`, or `none`; empty: of none.
  std::vector<Triangle> normal_of, texture_of;
  std::vector<vec3> normals;
  std::vector<vec2> texture_places;       ///< 0 0 is the lower left corner of the picture
  std::vector<Rgba8> colors;              ///< of each triangle, or empty
  std::vector<std::uint32_t> texture_no;  ///< of each triangle, in `textures`, or `none`; empty: of none
  std::vector<Texture> textures;
  std::string without_colors;  ///< why, where the file names some that are not here

  bool empty() const { return triangles.empty(); }
};

/// One polygon of a file: places of its vertices, and of what else its corners have. Places that are not
/// there are beyond the end.
struct Polygon {
  std::vector<std::int64_t> vertices, normals, textures;
  void clear() { vertices.clear(), normals.clear(), textures.clear(); }
};

/// Cuts polygons into fans: from the first corner from which all triangles turn the same way, else from the
/// first.
class FaceBuilder {
 public:
  /// `vertex_of`: from the file's vertices to those of the cloud, -1 for dropped ones, whose triangles are
  /// left out.
  FaceBuilder(const PointCloud& cloud, std::vector<std::int64_t> vertex_of);
  /// `place`: for who wants to know which face is bad.
  template <class Place>
  void add(const Polygon& polygon, const Place& place) {
    ++faces.count;
    if (!add_fan(polygon) && faces.bad++ == 0) faces.first_bad = place();
  }
  /// Of the polygon that was added last.
  void set_color(const std::optional<Rgba8>& color) {
    if (color || !faces.colors.empty()) faces.colors.resize(faces.triangles.size(), color.value_or(no_color));
  }
  /// One colour of all tells nothing.
  void forget_one_color();
  std::size_t vertices() const { return vertex_of_.size(); }

  Faces faces;

 private:
  bool add_fan(const Polygon& polygon);
  std::size_t start_of(const std::vector<std::int64_t>& vertices) const;

  const PointCloud& cloud_;
  std::vector<std::int64_t> vertex_of_;
};

/// From the places kept in `cloud.grid_index`.
std::vector<std::int64_t> kept_vertices(const PointCloud& cloud, std::uint64_t records);

/// What is said of damaged faces.
std::string vertices_alone(const File& file, const Error& error);

/// What a reader does who was asked for faces: `read` gives them. Where only the drawing wants them, damaged
/// ones are not worth the vertices.
template <class Read>
void take_faces(const File& file, const ReadOptions& options, ReadResult& result, const Read& read) {
  try {
    if (!options.samples_faces || result.cloud.size() <= most_samples) *options.faces = read();
  } catch (const Error& error) {
    if (!options.samples_faces || error.code() != ErrorCode::bad_input) throw;
    result.report.notes.push_back(vertices_alone(file, error));
  }
  result.cloud.grid_index.clear();
}

/// Puts points on the faces in place of the vertices, evenly by area, about one for every pixel of a picture
/// that the cloud fills. Nothing changes where the vertices are as dense already.
void sample_faces(Faces faces, ReadResult& result, Progress& progress);

}  // namespace sfumato::io
