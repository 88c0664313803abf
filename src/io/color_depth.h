// How many bits the colours of a file have, which 16-bit fields do not say: told by what most points hold.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace sfumato::io {

/// Counts the colours of points and tells their bits.
class ColorDepth {
 public:
  ColorDepth() : counts_(65536) {}
  void add(std::uint32_t red, std::uint32_t green, std::uint32_t blue) {  // for every point: no branch
    ++counts_[std::min<std::uint32_t>(std::max({red, green, blue}), 65535)];
    low_ |= (red | green | blue) & 255;
    unlike_ |= ((red ^ red >> 8) | (green ^ green >> 8) | (blue ^ blue >> 8)) & 255;
  }
  /// 8, 12 or 16; 0 when no point has another colour than 0 0 0. Of points that are not 0 0 0, 99 % are
  /// within the bits: a few odd values decide nothing. 16 bits that were made of 8 are multiples of 256 or
  /// 257, however dark.
  int bits() const;
  /// Points beyond so many bits (0: 8).
  std::uint64_t beyond(int bits) const;

 private:
  std::vector<std::uint32_t> counts_;   ///< of points by their largest channel
  std::uint32_t low_ = 0, unlike_ = 0;  ///< bits of low bytes; those that differ from the high ones
};

/// The largest number of so many bits.
inline std::uint32_t largest_of(int bits) { return (1u << bits) - 1; }
/// From 0..2^bits-1 to 16 bits: bits repeat behind themselves, so that white stays white.
std::uint16_t to_16_bits(std::uint32_t value, int bits);

/// "12 points have colours beyond 255, which are taken as 255".
std::string beyond_bits(std::uint64_t points, int bits);

}  // namespace sfumato::io
