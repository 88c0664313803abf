// Points on their way through the disk: records sorted into bins, more than memory holds.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <span>
#include <unordered_map>
#include <vector>

namespace sfumato::copc {

/// A file without a name in `folder`: gone with its last byte read, or with the process, however that ends.
class TemporaryFile {
 public:
  /// Throws Error(io). `purpose`: the output that the user knows of, for messages.
  TemporaryFile(const std::filesystem::path& folder, std::filesystem::path purpose);
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  /// Both from any thread. Error(io) says what a full disk lacks.
  void write(std::uint64_t at, std::span<const std::uint8_t> bytes);
  void read(std::uint64_t at, std::span<std::uint8_t> bytes) const;
  /// Gives the room on the disk back where the file system can.
  void forget(std::uint64_t at, std::uint64_t size);

 private:
  std::filesystem::path folder_, purpose_;
  int handle_ = -1;
};

/// A node of the octree: level and place in it.
struct Key {
  std::int32_t level = 0;
  std::uint32_t x = 0, y = 0, z = 0;
  bool operator==(const Key&) const = default;
  auto operator<=>(const Key&) const = default;
  Key parent() const { return {level - 1, x >> 1, y >> 1, z >> 1}; }
  Key child(unsigned octant) const {
    return {level + 1, 2 * x + (octant & 1), 2 * y + (octant >> 1 & 1), 2 * z + (octant >> 2)};
  }
};

struct KeyHash {
  std::size_t operator()(const Key& key) const {
    std::uint64_t h = std::uint64_t(key.level);
    for (std::uint32_t k : {key.x, key.y, key.z}) h = (h ^ k) * 0x9E3779B97F4A7C15ull, h ^= h >> 29;
    return std::size_t(h);
  }
};

/// Bytes in pieces that never move. Of many such that grow beside each other, one that grew by moving would
/// leave holes which none fits into: 1 GB of bins took 4.5 GB when a thousand million points were read. The
/// pieces have few sizes, so that what one gives back another takes.
class Pieces {
 public:
  void append(std::span<const std::uint8_t> bytes);
  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }
  std::size_t room() const { return room_; }  ///< bytes of memory
  /// Calls `use(span)` with one piece after the other.
  template <class Use>
  void for_each(Use&& use) const {
    for (const Piece& piece : pieces_) use(std::span<const std::uint8_t>(piece.bytes.get(), piece.size));
  }
  void copy_to(std::uint8_t* to) const;

 private:
  struct Piece {
    std::unique_ptr<std::uint8_t[]> bytes;
    std::size_t size = 0, room = 0;
  };
  std::vector<Piece> pieces_;
  std::size_t size_ = 0, room_ = 0;
};

/// Bins of records. They stay in memory while all together are below `memory` bytes, and go to the disk
/// beyond.
class Spool {
 public:
  Spool(std::filesystem::path folder, std::filesystem::path purpose, std::uint64_t memory)
      : folder_(std::move(folder)), purpose_(std::move(purpose)), memory_(memory) {}

  struct Bin {
    struct Extent {
      std::uint64_t at, size;
    };
    std::vector<Extent> extents;
    Pieces tail;             ///< behind the extents
    std::uint64_t size = 0;  ///< bytes in all
  };

  /// From any thread.
  void append(const Key& key, std::span<const std::uint8_t> bytes);
  /// Takes a bin out; from any thread, once nobody appends any more.
  Bin take(const Key& key);
  /// Its bytes; the disk gets its room back.
  std::vector<std::uint8_t> load(Bin&& bin);
  std::vector<std::uint8_t> load(const Key& key) { return load(take(key)); }
  /// A stretch of at most `limit` bytes (a multiple of `unit`, as every append must have been) from the end
  /// of the bin; empty when there is none left.
  std::vector<std::uint8_t> load_some(Bin& bin, std::size_t limit, std::size_t unit);

  /// Keys and bytes of all bins, sorted.
  std::vector<std::pair<Key, std::uint64_t>> bins() const;

 private:
  void write_out(Bin& bin);

  std::filesystem::path folder_, purpose_;
  std::uint64_t memory_, held_ = 0, end_ = 0;
  mutable std::mutex mutex_;
  std::unique_ptr<TemporaryFile> file_;
  std::unordered_map<Key, Bin, KeyHash> bins_;
};

}  // namespace sfumato::copc
