// Points that lie in memory as columns: what another program, or another language, holds.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "io/io.h"

namespace sfumato::io {

/// One number per point, `stride` bytes apart. The names are those of files: x y z nx ny nz red green blue
/// alpha radius, and everything else is a scalar.
struct MemoryColumn {
  std::string name;
  StoredType type = StoredType::float32;
  const std::byte* data = nullptr;
  std::size_t stride = 0;
  bool is_scalar = false;  ///< whatever its name says
};

struct MemoryResult : ReadResult {
  std::vector<std::uint32_t> kept;  ///< the rows that became points; empty: all of them
};

/// The cloud that a file with these columns gives: points that are not finite are dropped, colours become
/// bytes, large coordinates get an origin. Copies every column once. Throws Error(bad_input) when x, y or z
/// is missing.
MemoryResult read_memory(std::span<const MemoryColumn> columns, std::size_t rows,
                         Progress& progress = no_progress());

}  // namespace sfumato::io
