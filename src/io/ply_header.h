// The header of a PLY file: elements with properties, in file order.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/columns.h"
#include "io/file.h"

namespace sfumato::io {

struct PlyProperty {
  std::string name;
  StoredType type = StoredType::float32;
  bool is_list = false;
  StoredType count_type = StoredType::uint8;
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
  bool has_list() const;
  /// Bytes of one record in a binary file; the element must not have a list.
  std::size_t record_size() const;
};

struct PlyHeader {
  bool ascii = false, big_endian = false;
  std::vector<PlyElement> elements;
  std::size_t vertex = 0;        ///< which element holds the points
  std::uint64_t data_begin = 0;  ///< byte behind end_header's line
  std::size_t lines = 0;         ///< lines of the header
  std::size_t vertex_lines = 1;  ///< of ascii, which a vertex takes
  UpAxis up = UpAxis::pos_y;
  bool says_up = false;   ///< of the file itself
  bool names_up = false;  ///< by a comment of ours, of the file or of its kind
  std::string crs;
  std::string texture;  ///< `comment TextureFile`, the first
};

/// Error(bad_input) names the line of the header that is wrong.
PlyHeader read_ply_header(const File& file);

/// The points alone. `keep_places` puts each point's place in the file into `cloud.grid_index`.
ReadResult read_ply_vertices(const File& file, const PlyHeader& header, bool keep_places, Progress& progress);

/// Whether an element holds the corners of faces, or of strips of triangles.
bool has_ply_faces(const PlyHeader& header);
/// `vertices`: with the places of their records.
struct Faces;
Faces read_ply_faces(const File& file, const PlyHeader& header, const ReadResult& vertices,
                     Progress& progress);

/// Walks over the records of an element with lists, one after the other, in a binary file.
class PlyWalker {
 public:
  PlyWalker(const File& file, bool big_endian, std::uint64_t begin);
  /// The next number as a double; Error(bad_input) when the file ends.
  double number(StoredType type);
  void skip(std::uint64_t bytes);
  /// Skips a whole element.
  void skip_element(const PlyElement& element, Progress& progress);
  /// The length of a list; Error(bad_input) when the rest of the file cannot hold it.
  std::uint64_t list_length(const PlyProperty& property);
  std::uint64_t position() const { return base_ + at_; }

 private:
  const std::byte* take(std::size_t bytes);

  const File& file_;
  bool big_endian_ = false;
  std::uint64_t base_ = 0;  ///< file offset of the buffer
  std::size_t at_ = 0;
  std::vector<std::byte> buffer_;
};

}  // namespace sfumato::io
