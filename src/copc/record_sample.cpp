#include "copc/record_sample.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <utility>

namespace sfumato::copc {

std::size_t RecordSample::size_for(std::uint64_t points) {
  constexpr std::uint64_t share = 16, least = 8192;
  return points / share < least ? 0 : std::size_t(std::min<std::uint64_t>(points / share, most));
}

void RecordSample::add(std::span<const std::uint8_t> record) { add(analysis::hash_of(record), record); }

void RecordSample::add(const RecordSample& other) {
  const std::span<const std::uint8_t> records = other.records_;
  for (std::size_t i = 0; i < other.hashes_.size(); ++i)
    add(other.hashes_[i], records.subspan(i * other.length_, other.length_));
}

void RecordSample::add(std::uint64_t hash, std::span<const std::uint8_t> record) {
  if (hash > limit_) return;
  length_ = record.size();
  hashes_.push_back(hash);
  records_.insert(records_.end(), record.begin(), record.end());
  if (hashes_.size() == 2 * most) trim();
}

void RecordSample::trim() {
  const auto compare = [&](std::uint32_t a, std::uint32_t b) {
    return std::memcmp(records_.data() + a * length_, records_.data() + b * length_, length_);
  };
  std::vector<std::uint32_t> order(hashes_.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return hashes_[a] != hashes_[b] ? hashes_[a] < hashes_[b] : compare(a, b) < 0;
  });
  const auto is_one = [&](std::uint32_t a, std::uint32_t b) {
    return hashes_[a] == hashes_[b] && compare(a, b) == 0;
  };
  order.erase(std::unique(order.begin(), order.end(), is_one), order.end());
  if (order.size() > most) order.resize(most);
  std::vector<std::uint64_t> hashes;
  std::vector<std::uint8_t> records;
  hashes.reserve(2 * most), records.reserve(2 * most * length_);
  for (const std::uint32_t i : order) {
    hashes.push_back(hashes_[i]);
    const auto from = records_.begin() + std::ptrdiff_t(i * length_);
    records.insert(records.end(), from, from + std::ptrdiff_t(length_));
  }
  hashes_ = std::move(hashes), records_ = std::move(records);
  if (hashes_.size() == most) limit_ = hashes_.back();
}

std::vector<std::uint8_t> RecordSample::first(std::size_t count) {
  if (hashes_.empty()) return {};
  trim();
  const std::size_t size = std::min(count, hashes_.size()) * length_;
  return {records_.begin(), records_.begin() + std::ptrdiff_t(size)};
}

}  // namespace sfumato::copc
