// What a program of ours and its decoder processes (src/apps/decoder) say to each other: packets over a
// socket, bytes and records in memory that both see.
#pragma once

#include <cstdint>

namespace sfumato::io {

/// Changes with every change of these structures: a decoder of another version is not used.
inline constexpr std::uint32_t decoder_version = 2;

/// Where a decoder finds the socket and the memory when it starts.
inline constexpr int decoder_socket = 3, decoder_memory = 4;

/// `draco_faces`: of a mesh, three places among the records that `draco` gives.
enum class Decode : std::uint32_t { laszip = 1, draco = 2, draco_faces = 3 };

/// To the decoder: begin. The records come in blocks of `block_points` (the last is shorter) into two places
/// in turn, the third block only after the first was given back (any packet of one byte), and so on.
struct DecodeJob {
  Decode what = Decode::laszip;
  std::uint32_t format = 0, record_length = 0;  ///< LASzip: of its points
  std::uint32_t block_points = 0;               ///< LASzip
  std::uint64_t points = 0;                     ///< LASzip: how many there are
  std::uint64_t memory_size = 0;                ///< of the shared memory by now
  std::uint64_t input = 0, input_size = 0;      ///< bytes in the shared memory
  std::uint64_t output = 0, block_size = 0;     ///< of the first of two blocks, which lie behind each other
};

/// From the decoder: hello, or what a block holds.
struct DecodeReply {
  enum Kind : std::uint32_t { hello = 1, block = 2, fault = 3, fields = 4 } kind = hello;
  std::uint32_t points = 0;  ///< of a block; with `hello` the version; with `fields` 1 of a mesh
  std::uint64_t total = 0;   ///< with `fields`: points in all
  char text[1000] = {};      ///< of a fault: one line; of fields: a name, type and number of components each
};

}  // namespace sfumato::io
