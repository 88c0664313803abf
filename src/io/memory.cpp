#include "io/memory.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "core/counted.h"
#include "io/columns.h"
#include "io/parallel.h"

namespace sfumato::io {

MemoryResult read_memory(std::span<const MemoryColumn> given, std::size_t rows, Progress& progress) {
  // The builder takes columns of one block of memory: the one that begins where the first of them does.
  const std::byte* block = nullptr;
  for (const MemoryColumn& column : given)
    if (!block || std::less<>()(column.data, block)) block = column.data;
  std::vector<Column> columns;
  for (const MemoryColumn& column : given)
    columns.push_back(
        {column.name, column.type, column.type, std::size_t(column.data - block), column.stride});
  // The names of scalars mean nothing: 'a' is no alpha here. What is to be skipped is not looked at.
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (given[i].is_scalar) columns[i].role = Role::skip;
  if (!assign_roles(columns)) throw Error(ErrorCode::bad_input, "the columns lack x, y or z; give all three");
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (given[i].is_scalar) columns[i].role = Role::scalar;

  CloudBuilder builder(columns, rows, false, true);
  constexpr std::size_t step = 1 << 16;
  const std::size_t parts = std::clamp<std::size_t>(rows / step, 1, thread_count());
  std::vector<CloudBuilder::Cursor> cursors;
  for (std::size_t i = 0; i < parts; ++i)
    cursors.push_back(builder.cursor(rows * i / parts, rows * (i + 1) / parts));
  in_parallel(parts, [&](std::size_t i) {
    for (std::size_t first = cursors[i].begin, last = cursors[i].end; first < last; first += step) {
      progress.check();
      builder.decode(cursors[i], block, first, std::min(step, last - first), first);
    }
  });
  MemoryResult result;
  builder.finish(cursors, result);
  PointCloud& cloud = result.cloud;
  if (result.report.points_dropped > 0) {
    result.kept = std::move(cloud.grid_index);
    result.report.notes.push_back(
        std::to_string(result.report.points_dropped) + " of " + counted(rows, "point") + " " +
        (result.report.points_dropped == 1 ? "is" : "are") + " not finite and left out");
  }
  std::vector<std::uint32_t>().swap(
      cloud.grid_index);  // "= {}" would keep its memory as long as the cloud lives
  return result;
}

}  // namespace sfumato::io
