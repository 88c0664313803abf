// The adaptive models of LASzip's arithmetic coder (FastAC), which decoder and encoder of the chunk table
// share.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace sfumato::io::las {

// Sizes of FastAC: interval lengths, and precision of bit and symbol probabilities.
inline constexpr std::uint32_t min_length = 1u << 24;
inline constexpr int bit_shift = 13, symbol_shift = 15;

class BitModel {
 public:
  std::uint32_t zero_probability() const { return zero_probability_; }
  void count(bool bit) {
    if (!bit) ++zeros_;
    if (--until_update_ > 0) return;
    total_ += cycle_;
    if (total_ > 1u << bit_shift) {
      total_ = (total_ + 1) >> 1;
      zeros_ = (zeros_ + 1) >> 1;
      if (zeros_ == total_) ++total_;
    }
    zero_probability_ = std::uint32_t((std::uint64_t(zeros_) * (0x80000000u / total_)) >> (31 - bit_shift));
    cycle_ = std::min(64u, (5 * cycle_) >> 2);
    until_update_ = cycle_;
  }

 private:
  std::uint32_t zeros_ = 1, total_ = 2, zero_probability_ = 1u << (bit_shift - 1), cycle_ = 4,
                until_update_ = 4;
};

class SymbolModel {
 public:
  explicit SymbolModel(std::uint32_t symbols) : counts_(symbols, 1), distribution_(symbols) {
    cycle_ = symbols;
    update();
    cycle_ = until_update_ = (symbols + 6) >> 1;
  }
  std::uint32_t size() const { return std::uint32_t(counts_.size()); }
  std::uint32_t distribution(std::uint32_t symbol) const { return distribution_[symbol]; }
  void count(std::uint32_t symbol) {
    ++counts_[symbol];
    if (--until_update_ == 0) update();
  }

 private:
  void update() {
    if ((total_ += cycle_) > 1u << symbol_shift) {
      total_ = 0;
      for (std::uint32_t& count : counts_) total_ += (count = (count + 1) >> 1);
    }
    const std::uint32_t scale = 0x80000000u / total_;
    std::uint32_t sum = 0;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      distribution_[i] = (scale * sum) >> (31 - symbol_shift);
      sum += counts_[i];
    }
    cycle_ = std::min((5 * cycle_) >> 2, (size() + 6) << 3);
    until_update_ = cycle_;
  }

  std::vector<std::uint32_t> counts_, distribution_;
  std::uint32_t total_ = 0, cycle_ = 0, until_update_ = 0;
};

}  // namespace sfumato::io::las
