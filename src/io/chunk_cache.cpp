#include "io/chunk_cache.h"

namespace sfumato::io {

void ChunkCache::begin_read() {
  const std::lock_guard lock(mutex_);
  ++read_;
}

ChunkCache::Records ChunkCache::find(const Key& key) {
  const std::lock_guard lock(mutex_);
  const auto found = places_.find(key);
  if (found == places_.end()) return nullptr;
  entries_.splice(entries_.begin(), entries_, found->second);
  entries_.front().read = read_;
  return entries_.front().records;
}

void ChunkCache::keep(const Key& key, std::vector<std::uint8_t> records) {
  const std::lock_guard lock(mutex_);
  if (records.size() > room_ || places_.contains(key)) return;
  while (bytes_ + records.size() > room_) {
    const Entry& oldest = entries_.back();
    if (oldest.read == read_) return;  // and so are all others
    bytes_ -= oldest.records->size();
    places_.erase(oldest.key);
    entries_.pop_back();
  }
  bytes_ += records.size();
  entries_.push_front({key, std::make_shared<const std::vector<std::uint8_t>>(std::move(records)), read_});
  places_[key] = entries_.begin();
}

std::uint64_t ChunkCache::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

}  // namespace sfumato::io
