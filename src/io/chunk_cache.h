// Decoded chunks of compressed files, kept as long as there is room for them.
#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

namespace sfumato::io {

/// Of one file or several: keys are theirs. What was asked for longest ago makes room for what is new, but
/// nothing that this read asked for: a read of more than there is room for would push out its own first
/// chunks, the coarse ones that every next view needs, and the next one find none. Safe from several threads.
class ChunkCache {
 public:
  using Records = std::shared_ptr<const std::vector<std::uint8_t>>;
  struct Key {
    std::uint64_t file = 0, byte = 0;
    bool operator==(const Key&) const = default;
  };

  /// `room`: bytes of all records together.
  explicit ChunkCache(std::uint64_t room) : room_(room) {}

  /// What was asked for until now may make room.
  void begin_read();
  /// Null when it is not there.
  Records find(const Key& key);
  /// Nothing happens to records for which there is no room.
  void keep(const Key& key, std::vector<std::uint8_t> records);
  std::uint64_t bytes() const;

 private:
  struct KeyHash {
    std::size_t operator()(const Key& key) const {
      return std::size_t(key.byte * 0x9E3779B97F4A7C15u ^ key.file);
    }
  };
  struct Entry {
    Key key;
    Records records;
    std::uint64_t read = 0;  ///< that asked for them last
  };

  mutable std::mutex mutex_;
  std::uint64_t room_, bytes_ = 0, read_ = 0;
  std::list<Entry> entries_;  ///< asked for last, first
  std::unordered_map<Key, std::list<Entry>::iterator, KeyHash> places_;
};

}  // namespace sfumato::io
