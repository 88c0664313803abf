// Encoding of LASzip chunks in memory, and what a LAZ file of such chunks says about them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "io/laz_chunk.h"

namespace sfumato::io::las {

/// The payload of the "laszip encoded" record (22204) for chunks of varying size. `format`: 6 to 8.
std::vector<std::uint8_t> laszip_record(int format, std::uint16_t record_length);

/// Packed records (LAS point format 6 to 8, as many as fit) as one chunk, ready to lie in a file. Throws
/// Error(io) when LASzip refuses, which it does not for records of that length.
std::vector<std::uint8_t> encode_chunk(int format, std::uint16_t record_length,
                                       std::span<const std::uint8_t> records);

/// The chunk table that readers of the whole file need: version, number of chunks, their counts and sizes.
std::vector<std::uint8_t> chunk_table(std::span<const LazChunk> chunks);

}  // namespace sfumato::io::las
