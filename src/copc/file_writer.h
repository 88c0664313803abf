// A COPC 1.0 file: header, records, nodes as they come, hierarchy.
#pragma once

#include <filesystem>
#include <span>
#include <utility>
#include <vector>

#include "copc/octree.h"
#include "io/atomic_writer.h"
#include "io/laz_chunk.h"

namespace sfumato::copc {

class FileWriter {
 public:
  /// Throws Error(usage, io). Nothing has a name before `finish`.
  FileWriter(const std::filesystem::path& file, const Schema& schema);
  void append(const EncodedNode& node);
  /// RecordSample, as a node is encoded.
  void set_sample(EncodedNode sample) { sample_ = std::move(sample); }
  /// Writes what is known last, and names the file. Returns its size in bytes.
  std::uint64_t finish(const Cube& cube, const Summary& summary);

  std::size_t nodes() const { return chunks_.size(); }
  int levels() const { return levels_; }

 private:
  struct Node {
    Key key;
    std::uint64_t byte;
    std::uint32_t size, count;
  };
  struct Record;

  std::vector<Record> records(std::span<const std::uint8_t> info) const;
  std::vector<std::uint8_t> head(const Summary& summary, std::span<const std::uint8_t> info,
                                 std::uint64_t first_evlr, std::uint32_t evlrs) const;
  std::vector<std::uint8_t> hierarchy(std::uint64_t byte, std::uint64_t& root_at,
                                      std::uint64_t& root_size) const;
  void write(std::span<const std::uint8_t> bytes) { writer_.write(std::as_bytes(bytes)); }
  void write_evlr(const char* user_id, std::uint16_t record_id, std::span<const std::uint8_t> data);

  const Schema& schema_;
  io::AtomicWriter writer_;
  std::uint64_t point_data_ = 0;
  int levels_ = 0;
  std::vector<Node> nodes_;
  std::vector<io::las::LazChunk> chunks_;
  EncodedNode sample_;  ///< of no points: there is none
};

}  // namespace sfumato::copc
