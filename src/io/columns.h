// From records of numbers to a cloud: what all point formats share. A reader names its columns and where they
// lie in memory, sizes a CloudBuilder by a count it has checked against the file, and decodes records through
// cursors, one per thread, that own disjoint ranges of rows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "io/io.h"

namespace sfumato::io {

/// What a column means to the cloud.
enum class Role : std::uint8_t { skip, x, y, z, nx, ny, nz, red, green, blue, alpha, radius, scalar };

struct Column {
  std::string name;                         ///< as in the file
  StoredType stored = StoredType::float32;  ///< as the file declares it
  StoredType layout = StoredType::float32;  ///< as it lies in the memory given to `decode`
  std::size_t offset = 0, stride = 0;       ///< bytes from the block's start, and from record to record
  Role role = Role::scalar;
};

std::size_t size_of(StoredType type);
/// A number as it lies in memory, in the byte order of this machine.
double number_of(StoredType type, const std::byte* bytes);
/// Types that a float does not hold.
bool is_wide(StoredType type);
bool is_integer(StoredType type);
/// The first column of that role; -1 when there is none.
int column_of(const std::vector<Column>& columns, Role role);

/// Sets the roles by the usual names (x, nx, normal_x, red, r, diffuse_red, radius ...). A group counts only
/// when it is complete: without ny, nx is a scalar. False when x, y or z is missing.
bool assign_roles(std::vector<Column>& columns);

/// Gives scalars that other programs spell in their way the names that colours, classes and filters know,
/// those of LAS: CloudCompare's `scalar_Intensity` and `Return Number`, `Class`. A name that is there already
/// stays the only one.
void use_usual_names(std::vector<Column>& columns);

/// Lays them out side by side as doubles, as in rows that were parsed.
void lay_out_as_doubles(std::vector<Column>& columns);

/// Minimum, maximum and sum over finite values: of coordinates over kept points, of attributes over all
/// records.
struct Stats {
  double min = std::numeric_limits<double>::infinity(), max = -min, sum = 0;
  std::uint64_t count = 0;
  void merge(const Stats& other);
};

/// Where the local (0,0,0) of points within [min, max] goes: zero unless the numbers are so much larger than
/// the cloud that float would show it. `as_float`: the file holds floats, which the origin then keeps
/// exactly.
dvec3 choose_origin(const dvec3& min, const dvec3& max, bool as_float);

/// Chooses the offset of the scalar field: zero unless float would lose digits that the file has.
/// `offset`: that which was chosen for another part of the file.
ScalarField make_scalar(std::string name, StoredType type, const std::vector<double>& values,
                        const Stats& stats, std::optional<double> offset = {});

/// Two digits, for notes.
std::string short_text(double number);

class CloudBuilder {
 public:
  /// Rows [begin, end) of the arrays. Decoding drops non-finite points, so a cursor may end up short.
  struct Cursor {
    std::size_t begin = 0, at = 0, end = 0;
    std::uint64_t records = 0, normals_dropped = 0;
    std::vector<Stats> stats;  ///< one per column
  };

  /// Allocates `rows` rows: the caller has checked that the file can hold so many. `keep_places` keeps each
  /// point's record number in `grid_index`.
  CloudBuilder(std::vector<Column> columns, std::size_t rows, bool big_endian = false,
               bool keep_places = false);

  Cursor cursor(std::size_t begin, std::size_t end) const;
  /// Records [first, first + count) of `block`; `place` is the record number of the first of them.
  void decode(Cursor& cursor, const std::byte* block, std::size_t first, std::size_t count,
              std::uint64_t place);
  /// What is chosen by the numbers that a file holds; the offsets are those of its scalars, in their order.
  struct Choices {
    dvec3 origin{0};
    bool has_colors = false;
    float color_factor = 1, alpha_factor = 1;
    std::vector<double> offsets;
  };
  /// Closes the gaps that dropped points left, chooses origin and offsets, fills cloud and report. `chosen`:
  /// before, for another part of the file.
  void finish(std::vector<Cursor>& cursors, ReadResult& result, const Choices* chosen = nullptr);
  /// Once it is finished.
  const Choices& choices() const { return choices_; }

  const std::vector<Column>& columns() const { return columns_; }

 private:
  struct Batch;
  struct Field {
    std::size_t column = 0;
    std::vector<float> PointCloud::*attribute = nullptr;  ///< instead of a scalar
    std::vector<float> narrow;
    std::vector<double> wide;  ///< types that float cannot hold, until the offset is known
  };

  void decode_batch(Cursor& cursor, Batch& batch, std::uint64_t place);
  template <class T, class V>
  void decode_positions(Cursor& cursor, Batch& batch, std::vector<V>& out);
  /// Loads a column of the batch, counts its statistics over all records, and leaves the kept ones.
  template <class T>
  void load_counted(Cursor& cursor, const Batch& batch, std::size_t index, T* out) const;
  void decode_normals(Cursor& cursor, const Batch& batch);
  void decode_colors(Cursor& cursor, const Batch& batch);
  template <class T>
  void decode_values(Cursor& cursor, const Batch& batch, std::size_t column, std::vector<T>& out);
  void close_gaps(const std::vector<Cursor>& cursors);
  void finish_positions(const dvec3& min, const dvec3& max, const Choices* chosen, PointCloud& cloud);
  void finish_colors(const std::vector<Stats>& stats, const Choices* chosen, ReadReport& report);

  std::vector<Column> columns_;
  Choices choices_;
  bool swap_ = false;
  int xyz_[3], normal_[3], color_[3], alpha_ = -1;  ///< columns; -1: none
  bool wide_positions_ = false, byte_colors_ = false, keep_places_ = false;

  std::vector<vec3> positions_, normals_;
  std::vector<dvec3> world_;  ///< positions of files that hold doubles, until the origin is known
  std::vector<Rgba8> colors_;
  std::vector<vec4> raw_colors_;  ///< colours that are not bytes, until their range is known
  std::vector<std::uint32_t> places_;
  std::vector<Field> fields_;
};

}  // namespace sfumato::io
