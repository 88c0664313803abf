// From packed point records to a cloud: the one path that LAS, LAZ and COPC share.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "io/io.h"
#include "io/las_fields.h"

namespace sfumato::io::las {

/// What is decided of a whole file, for clouds that are parts of it: they agree, whatever each of them holds.
struct WholeFile {
  std::vector<std::uint8_t> first_record;
  dvec3 origin{0};
  int color_bits = 16;
};

/// By its header and a sample of its points, from everywhere in it: the same, however the file is cut.
WholeFile whole_file(const std::filesystem::path& file, Progress& progress);

/// The origin of all points of a file, by a sample of them and what it says of their place.
dvec3 origin_of(const Header& header, const ReadResult& sample, const std::optional<Bounds>& said);

/// Collects records into a cloud in file order. `unpack` may be called from several threads for disjoint
/// ranges.
class PointCollector {
 public:
  struct FieldStats {
    double min = std::numeric_limits<double>::infinity(), max = -min, sum = 0;
    std::uint64_t count = 0;
    bool has_residual = false, is_inexact = false;
  };
  /// Statistics of one run of records; combined in file order, so that the result does not depend on threads.
  struct Stats {
    std::array<std::int32_t, 3> low, high;
    std::vector<FieldStats> fields;
  };

  /// `first_record`: the file's first point, whose large values (GPS time) become the offsets of the scalars.
  PointCollector(const Header& header, const std::vector<std::uint8_t>& first_record);
  /// Of a part of a file. No attribute is left out: another part may have what this one has nothing of.
  PointCollector(const Header& header, const WholeFile& whole);

  /// Room for `points` points in all.
  void resize(std::size_t points);
  std::size_t bytes_per_point() const;
  /// Stores `count` records as points [first, first + count).
  void unpack(std::size_t first, const std::uint8_t* records, std::size_t count, Stats& stats);
  Stats empty_stats() const;
  /// The cloud, relative to an origin near its centre, and what the report says about points and attributes.
  ReadResult finish(const std::vector<Stats>& parts, Progress& progress);

 private:
  struct Column {
    Field field;
    double base = 0;  ///< offset of the scalar
    /// Columns that are mostly zeros are not there before a number is: fresh memory costs more than
    /// unpacking.
    bool may_be_absent = false;
    std::vector<float> values, residuals;
    std::unique_ptr<std::atomic<float*>> values_at = std::make_unique<std::atomic<float*>>(nullptr),
                                         residuals_at = std::make_unique<std::atomic<float*>>(nullptr);
  };
  /// The numbers of a column, made when they are asked for; from any thread.
  float* numbers(std::vector<float>& values, std::atomic<float*>& at);

  void unpack_column(Column& column, std::size_t first, const std::uint8_t* records, std::size_t count,
                     const std::vector<std::uint8_t>& seen, FieldStats& stats);
  template <class T>
  void unpack_values(Column& column, std::size_t first, const std::uint8_t* records, std::size_t count,
                     const std::vector<std::uint8_t>& seen, FieldStats& stats);
  std::int32_t median_step(int axis) const;
  void place_points(ReadResult& result, const Stats& total, Progress& progress);
  void place_colors(ReadResult& result, Progress& progress);
  void place_scalars(ReadResult& result, const Stats& total);
  void place_attributes(ReadResult& result);

  Header header_;
  std::optional<WholeFile> whole_;
  std::size_t points_ = 0;
  std::mutex making_;
  std::vector<std::string> notes_;
  std::vector<Column> columns_;
  std::vector<vec3> positions_;  ///< until `finish`, the bits of the file's integers
  std::vector<std::array<std::uint16_t, 3>> colors_;
  std::array<int, 3> color_columns_{-1, -1, -1};
};

}  // namespace sfumato::io::las
