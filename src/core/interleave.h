// Three numbers as one, bit by bit: the key of a Morton curve.
#pragma once

#include <cstdint>

namespace sfumato {

/// The last 21 bits of `v`, each at every third place.
constexpr std::uint64_t every_third_bit(std::uint64_t v) {
  v &= 0x1fffff;
  v = (v | v << 32) & 0x1f00000000ffff;
  v = (v | v << 16) & 0x1f0000ff0000ff;
  v = (v | v << 8) & 0x100f00f00f00f00f;
  v = (v | v << 4) & 0x10c30c30c30c30c3;
  return (v | v << 2) & 0x1249249249249249;
}

/// Of the last 21 bits of each; x counts least.
constexpr std::uint64_t interleaved(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
  return every_third_bit(x) | every_third_bit(y) << 1 | every_third_bit(z) << 2;
}

}  // namespace sfumato
