// Values column by column, for formats that are decoded one field after the other.
#pragma once

#include <span>
#include <vector>

#include "io/columns.h"
#include "io/io.h"

namespace sfumato::io {

class Table {
 public:
  /// The caller has checked that the file can hold so many rows. Values start as NaN.
  Table(std::vector<Column> columns, std::size_t rows);

  std::size_t rows() const { return rows_; }
  /// Empty when there is no column of that name.
  std::span<double> column(std::string_view name);
  std::span<double> column(std::size_t index) { return std::span(values_).subspan(index * rows_, rows_); }
  /// Fills cloud and report; points whose coordinates are not finite are dropped and counted. `keep_places`
  /// as in CloudBuilder.
  void build(bool keep_places, Progress& progress, ReadResult& result);

 private:
  std::vector<Column> columns_;
  std::size_t rows_;
  std::vector<double> values_;
};

}  // namespace sfumato::io
