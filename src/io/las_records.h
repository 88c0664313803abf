// The point records of a LAS, LAZ or COPC file as they lie in it, a part at a time: for those who do not want
// the whole cloud in memory.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "core/point_cloud.h"
#include "io/laz_chunk.h"

namespace sfumato::io::las {

/// Where the points of a compressed file are.
struct LazChunks {
  LazLayout layout;
  std::vector<LazChunk> chunks;
  bool is_run =
      false;         ///< one chunk that stands for many, which only decoding one after the other tells apart
  std::string note;  ///< how they were found without a chunk table; empty otherwise
};

/// By the octree of a COPC, else the chunk table, else without. Throws Error(bad_input).
LazChunks find_chunks(const InputFile& file, const Header& header);

/// What the header says of the points' place, if it can be.
std::optional<Bounds> header_bounds(const InputFile& file);

/// Points handled at a time: at most 65536, fewer where a point is long.
std::size_t records_at_a_time(std::size_t record_length);

/// Opens the file for each part anew, so that there may be more files than a process may have open.
class RecordFile {
 public:
  explicit RecordFile(const std::filesystem::path& path);

  const Header& header() const { return header_; }
  /// What the header says of the points' place, if it can be.
  std::optional<Bounds> bounds() const { return bounds_; }
  const std::string& note() const { return chunks_.note; }

  struct Part {
    std::uint64_t first = 0, count = 0;
  };
  /// In file order; each can be read on a thread of its own.
  const std::vector<Part>& parts() const { return parts_; }
  /// Hands over the records of one part, `records_at_a_time` or fewer at once, in file order. `first` counts
  /// in the file. Throws Error(bad_input), and what `sink` throws.
  void read(std::size_t part,
            const std::function<void(std::uint64_t first, const std::uint8_t* records, std::size_t count)>&
                sink) const;

 private:
  std::filesystem::path path_;
  Header header_;
  std::optional<Bounds> bounds_;
  LazChunks chunks_;
  std::vector<Part> parts_;
};

}  // namespace sfumato::io::las
