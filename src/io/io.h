// Reading and writing clouds. A format is one file in this folder and one row of the table in io.cpp.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/point_cloud.h"
#include "core/progress.h"

namespace sfumato::io {

/// An attribute as the file has it: name and statistics over the finite stored values (LAS colours 16 bit as
/// stored, PCD rgb unpacked to red green blue).
struct AttributeStats {
  std::string name;
  double min = 0, max = 0, mean = 0;
};

class RecordTap;
struct Faces;

/// One of `count` parts of a file, which together are all of it, each point in one: places of the whole in
/// file order, or of files of chunks, nodes and tiles some of those.
struct Part {
  std::uint64_t index = 0, count = 1;
  std::uint64_t begin(std::uint64_t total) const { return start(index, total); }
  std::uint64_t end(std::uint64_t total) const { return start(index + 1, total); }
  /// Whether points [first, first + points) of `total`, which are not to be parted, are among its.
  bool holds(std::uint64_t first, std::uint64_t points, std::uint64_t total) const {
    const std::uint64_t middle = first + points / 2;
    return middle >= begin(total) && middle < end(total);
  }
  bool operator==(const Part&) const = default;

 private:
  /// index * total / count, without overflow.
  std::uint64_t start(std::uint64_t i, std::uint64_t total) const {
    return total / count * i + total % count * i / count;
  }
};

struct ReadOptions {
  std::vector<std::string> columns;         ///< text, rows of .npy: names by position, win over the guess
  std::optional<std::uint64_t> max_points;  ///< deterministic subsample while or after reading
  /// Only this part of the file, or of its subsample; not with `faces`. Parts agree in attributes, in the
  /// depth of colours and in the origin, whatever each holds: LAS keeps columns of nothing but zeros for it.
  /// Of LAS, LAZ, COPC, EPT and Potree the rest is not read but for a sample, and of records of 0 0 0 that
  /// the whole leaves out (`ReadReport::notes`) up to three a part may stay. Reports are those of the part,
  /// of other formats those of the whole.
  std::optional<Part> part;
  bool strict = false;           ///< refuse a file of which parts are damaged
  bool every_attribute = false;  ///< also LAS user_data and point_source_id of nothing but zeros
  bool samples_faces = false;    ///< of meshes, points on their faces in place of the vertices
  Faces* faces = nullptr;        ///< takes the faces of the file (io/faces.h)
  RecordTap* tap = nullptr;      ///< sees records of LAS, LAZ and COPC as they are read (io/record_tap.h)
  bool operator==(const ReadOptions&) const = default;
};

/// Said of such a part behind what is wrong with it (ReadReport::damage).
inline const std::string is_left_out = "; it is left out";

struct ReadReport {
  std::filesystem::path file;
  std::string format;                      ///< "las", "laz", "copc", "ply", "pcd", "text", ...
  std::uint64_t points = 0;                ///< records in the file
  std::uint64_t points_finite = 0;         ///< kept (before any subsampling)
  std::uint64_t points_dropped = 0;        ///< coordinates that are not finite, or beyond 1e37
  std::uint64_t points_missing = 0;        ///< in parts that are damaged and left out
  std::uint64_t normals_dropped = 0;       ///< zero or non-finite normals
  dvec3 bounds_min{0}, bounds_max{0};      ///< world, doubles, over the finite points
  std::vector<AttributeStats> attributes;  ///< in file order
  std::string crs;
  std::vector<std::string> damage;  ///< the parts left out, one line each
  std::vector<std::string> notes;   ///< guesses and choices the user should see, one line each
  std::vector<std::string> digits;  ///< what is stored more exactly than it is kept: for copies, not pictures
};

struct ReadResult {
  PointCloud cloud;  ///< file order
  ReadReport report;
  bool has_faces = false;  ///< PLY and Draco: whether they were wanted or not, its points are vertices
};

/// Reads any supported file; the format is found by content first, extension second.
/// Throws Error(bad_input) with file, byte or line, found, expected; Error(io) when it cannot be opened.
/// Chunks of LAZ and nodes of COPC that are damaged are left out, as is what PLY and PCD lack where they
/// end early, and the report says so, unless `options.strict` or nothing else is left.
ReadResult read(const std::filesystem::path& file, const ReadOptions& options = {},
                Progress& progress = no_progress());

/// About `points` of the points of a large file, from everywhere in it, in a small part of the time: runs of
/// neighbours of LAS, LAZ, COPC, PLY, PCD, OBJ and text. The report has the file's number of points where its
/// header says it, and statistics of what is here. Nothing where the file cannot be cut so, or has less than
/// four times as many.
std::optional<ReadResult> read_excerpt(const std::filesystem::path& file, std::size_t points,
                                       const ReadOptions& options = {}, Progress& progress = no_progress());

/// Vertices and triangles of a PLY or OBJ file (polygons are fanned).
Mesh read_mesh(const std::filesystem::path& file, Progress& progress = no_progress());

struct WriteReport {
  std::vector<std::string> notes;  ///< what the file cannot hold as it was, one line each
};

/// Writes .las, .laz, .ply or .pcd (binary), .xyz .txt .asc .csv or .npy, by extension; `-` is PLY; file
/// order and every attribute kept. The file appears under its name only when it is complete. Throws
/// Error(usage) for an extension that cannot be written, and for coordinates that the format cannot hold.
WriteReport write(const std::filesystem::path& file, const PointCloud& cloud,
                  Progress& progress = no_progress());

/// Whether `write` knows the extension.
bool can_write(const std::filesystem::path& file);

struct FormatInfo {
  std::string name, extensions, description;
  bool can_read = false, can_write = false;
};
/// The ordered table of formats.
std::vector<FormatInfo> formats();

}  // namespace sfumato::io
