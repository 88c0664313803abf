// Files that are nothing but records of one layout, but for what stands before them.
#pragma once

#include <vector>

#include "io/columns.h"
#include "io/file.h"

namespace sfumato::io {

/// `rows` records of `record` bytes, from byte `begin` of the file on.
ReadResult read_flat_records(const File& file, std::vector<Column> columns, std::size_t rows,
                             std::size_t record, Progress& progress, std::uint64_t begin = 0);

}  // namespace sfumato::io
