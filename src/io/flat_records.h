// Files that are nothing but records of one layout.
#pragma once

#include <vector>

#include "io/columns.h"
#include "io/file.h"

namespace sfumato::io {

/// `rows` records of `record` bytes, from the file's first byte on.
ReadResult read_flat_records(const File& file, std::vector<Column> columns, std::size_t rows,
                             std::size_t record, Progress& progress);

}  // namespace sfumato::io
