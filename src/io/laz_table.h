// Where the chunks of a LAZ file are: its chunk table, or what can be found without one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/laz_chunk.h"

namespace sfumato::io::las {

/// The chunks as the file's chunk table names them, in file order. Nothing when the table is missing or does
/// not fit the file; `reason` then says why.
std::optional<std::vector<LazChunk>> read_chunk_table(const InputFile& file, const Header& header,
                                                      const LazLayout& layout, std::string& reason);

/// The chunks of a layered file found by walking from one to the next. Throws Error(bad_input) when the walk
/// does not meet the header's number of points.
std::vector<LazChunk> walk_layered_chunks(const InputFile& file, const Header& header,
                                          const LazLayout& layout);

}  // namespace sfumato::io::las
