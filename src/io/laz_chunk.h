// Decoding of one LASzip chunk in memory, by a decoder process where there are some.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "io/las_header.h"

namespace sfumato::io::las {

/// What the file's "laszip encoded" record says, checked against the header.
struct LazLayout {
  int format = 0;
  std::uint16_t record_length = 0;
  bool is_chunked = true;   ///< false: one run without chunks (LASzip 1)
  bool is_layered = false;  ///< point formats 6 to 10: chunks begin with the sizes of their layers
  std::uint32_t layers = 0;
  std::uint32_t chunk_size = 0;   ///< points; variable_chunks: as the chunk table says
  std::vector<std::uint8_t> vlr;  ///< the record itself
};

inline constexpr std::uint32_t variable_chunks = 0xFFFFFFFFu;
/// No writer makes chunks of more points; a larger number is damage.
inline constexpr std::uint32_t largest_chunk = 16u << 20;

/// Throws Error(bad_input) when the record is missing or does not fit the header.
LazLayout read_laz_layout(const InputFile& file, const Header& header);

/// A run of compressed points.
struct LazChunk {
  std::uint64_t byte = 0, size = 0;  ///< in the file
  std::uint64_t first = 0;           ///< number of its first point
  std::uint32_t count = 0;
  std::uint32_t held =
      0;  ///< points that it has in the file, where `count` is only the first of them; 0: as many
  std::uint32_t number = 0;                      ///< in the file, from 0
  std::int32_t level = -1, x = 0, y = 0, z = 0;  ///< of COPC: its node
};

/// Bytes of the layered chunk at the start of `bytes`, which end where the file ends, found from its own
/// layer sizes; `count` is set to the chunk's point count. 0 when the sizes do not fit.
std::uint64_t layered_chunk_size(const LazLayout& layout, std::span<const std::uint8_t> bytes,
                                 std::uint64_t available, std::uint32_t& count);

/// Decodes the points of one chunk (or of a whole run of chunks of layout.chunk_size points) in order. LASzip
/// sees a small file of its own that holds just this chunk, and zeros behind it instead of an end.
class LazDecoder {
 public:
  /// Reads the chunk's bytes and checks what can be checked before LASzip sees them. Throws Error(bad_input).
  /// `is_run`: the bytes are several chunks one after the other, without a chunk table. `progress` is asked
  /// while the decoder process works.
  LazDecoder(const InputFile& file, const LazLayout& layout, const LazChunk& chunk, bool is_run = false,
             Progress& progress = no_progress());
  ~LazDecoder();

  /// The next points as packed records of layout.record_length bytes, `records_at_a_time` of them or what is
  /// left; empty behind the last. They may be written over, and last until the next call. Throws
  /// Error(bad_input), also when the bytes have ended their decoder; Cancelled.
  std::span<std::uint8_t> next();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sfumato::io::las
