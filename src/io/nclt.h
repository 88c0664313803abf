// Sweeps of the NCLT dataset, records of eight bytes.
#pragma once

#include "io/columns.h"
#include "io/file.h"

namespace sfumato::io {

/// Whether the last byte of each eight is one of 32 lasers.
bool is_nclt_sweep(const File& file);
ReadResult read_nclt_sweep(const File& file, Progress& progress);

}  // namespace sfumato::io
