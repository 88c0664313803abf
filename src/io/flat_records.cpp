#include "io/flat_records.h"

#include <algorithm>

namespace sfumato::io {

ReadResult read_flat_records(const File& file, std::vector<Column> columns, std::size_t rows,
                             std::size_t record, Progress& progress, std::uint64_t begin) {
  constexpr std::size_t step = 1 << 16;
  CloudBuilder builder(std::move(columns), rows);
  std::vector<CloudBuilder::Cursor> cursors{builder.cursor(0, rows)};
  std::vector<std::byte> block;
  for (std::size_t first = 0; first < rows; first += step) {
    progress.check();
    const std::size_t count = std::min(step, rows - first);
    block.resize(count * record);
    file.read(begin + first * record, block);
    builder.decode(cursors[0], block.data(), 0, count, first);
    progress.update(double(first + count) / double(rows), "reading");
  }
  ReadResult result;
  builder.finish(cursors, result);
  return result;
}

}  // namespace sfumato::io
