// Which points a subsample takes: the same ones whether the cloud is in memory or read in parts.
#pragma once

#include <cstdint>

namespace sfumato {

/// `wanted` of `total` points (wanted <= total, both below 2^32 or their product below 2^64): one of each of
/// `wanted` equal runs, at a place hashed from the run's number. Files come in scan order, and a fixed stride
/// would alias with the scan lines.
class Subsample {
 public:
  Subsample(std::uint64_t total, std::uint64_t wanted) : total_(total), wanted_(wanted) {}

  /// The place of the `k`-th of the wanted points; they ascend.
  std::uint64_t place(std::uint64_t k) const {
    const std::uint64_t first = start(k), last = start(k + 1);
    const std::uint32_t hash = std::uint32_t(k) * 2654435769u >> 8;
    return first + hash % (last - first);
  }
  /// How many of the wanted points lie before place `i`; for i = total all of them.
  std::uint64_t before(std::uint64_t i) const {
    if (i >= total_) return wanted_;
    std::uint64_t k = i * wanted_ / total_;
    if (i >= start(k + 1)) ++k;  // runs begin at whole places
    return place(k) < i ? k + 1 : k;
  }
  bool takes(std::uint64_t i) const { return before(i + 1) > before(i); }

 private:
  std::uint64_t start(std::uint64_t k) const { return k * total_ / wanted_; }

  std::uint64_t total_, wanted_;
};

}  // namespace sfumato
