// What the readers of VTK's two formats share: arrays of points.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "io/format.h"
#include "io/table.h"

namespace sfumato::io {

/// Arrays of as many tuples as there are points become columns; others are of cells, or of nobody.
class VtkArrays {
 public:
  explicit VtkArrays(std::filesystem::path path) : path_(std::move(path)) {}
  /// Coordinates of further points, three a point.
  void add_points(const std::vector<double>& xyz, StoredType type);
  /// An array of the points that were added last, `count` of them.
  void add(const std::string& name, StoredType type, std::size_t width, const std::vector<double>& values,
           std::size_t count);
  /// Polygons, or strips of triangles, over the points that were added last, as the file has them.
  struct Polygons {
    std::vector<double> corners;  ///< without `ends`, each behind the number of its corners
    std::vector<double> ends;     ///< of each, in `corners`
    bool are_strips = false;
    std::size_t first_point = 0;
  };
  void add_polygons(Polygons polygons);
  /// Where only the drawing wants them.
  void drop_polygons(const Error& why) { polygons_.clear(), why_dropped_ = why; }
  std::size_t rows() const { return rows_; }
  ReadResult build(const ReadOptions& options, Progress& progress);

 private:
  Faces faces_over(const ReadResult& result, Progress& progress) const;
  struct Named {
    Column column;
    std::vector<double> values;
  };
  Named& named(const std::string& name, StoredType type);
  std::filesystem::path path_;
  std::vector<Named> columns_;
  std::vector<Polygons> polygons_;
  std::optional<Error> why_dropped_;
  std::size_t rows_ = 0, first_point_ = 0;
};

/// All of a file.
std::string text_of(const std::filesystem::path& file);

bool is_vtk(std::string_view head);
ReadResult read_vtk(const std::filesystem::path& file, const ReadOptions& options, Progress& progress);
bool is_vtk_xml(std::string_view head);
ReadResult read_vtk_xml(const std::filesystem::path& file, const ReadOptions& options, Progress& progress);

}  // namespace sfumato::io
