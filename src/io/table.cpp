#include "io/table.h"

#include <cmath>

namespace sfumato::io {

Table::Table(std::vector<Column> columns, std::size_t rows)
    : columns_(std::move(columns)), rows_(rows), values_(columns_.size() * rows, std::nan("")) {
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    columns_[i].layout = StoredType::float64;
    columns_[i].offset = i * rows * sizeof(double);
    columns_[i].stride = sizeof(double);
  }
}

std::span<double> Table::column(std::string_view name) {
  for (std::size_t i = 0; i < columns_.size(); ++i)
    if (columns_[i].name == name) return column(i);
  return {};
}

void Table::build(bool keep_places, Progress& progress, ReadResult& result) {
  constexpr std::size_t step = 1 << 16;
  CloudBuilder builder(columns_, rows_, false, keep_places);
  std::vector<CloudBuilder::Cursor> cursors{builder.cursor(0, rows_)};
  for (std::size_t first = 0; first < rows_; first += step) {
    progress.check();
    builder.decode(cursors[0], reinterpret_cast<const std::byte*>(values_.data()), first,
                   std::min(step, rows_ - first), first);
  }
  builder.finish(cursors, result);
}

}  // namespace sfumato::io
