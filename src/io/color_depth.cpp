#include "io/color_depth.h"

#include <cmath>
#include <numeric>

#include "core/counted.h"

namespace sfumato::io {

int ColorDepth::bits() const {
  constexpr double share = 0.99;
  const std::uint64_t points = std::accumulate(counts_.begin() + 1, counts_.end(), std::uint64_t(0));
  if (points == 0) return 0;
  auto left = std::uint64_t(std::ceil(share * double(points)));
  std::uint32_t largest = 0;
  while (left > 0 && largest < 65535) left -= std::min<std::uint64_t>(left, counts_[++largest]);
  if (largest <= largest_of(8)) return 8;
  return largest > largest_of(12) || low_ == 0 || unlike_ == 0 ? 16 : 12;
}

std::uint64_t ColorDepth::beyond(int bits) const {
  std::uint64_t points = 0;
  for (std::size_t value = std::size_t(largest_of(std::max(8, bits))) + 1; value < counts_.size(); ++value)
    points += counts_[value];
  return points;
}

std::uint16_t to_16_bits(std::uint32_t value, int bits) {
  value = std::min(value, largest_of(bits));
  if (bits == 8) return std::uint16_t(value << 8 | value);
  if (bits == 12) return std::uint16_t(value << 4 | value >> 8);
  return std::uint16_t(value);
}

std::string beyond_bits(std::uint64_t points, int bits) {
  const std::string most = std::to_string(largest_of(bits));
  return counted(points, "point") + (points == 1 ? " has a colour" : " have colours") + " beyond " + most +
         ", unlike all others: taken as " + most;
}

}  // namespace sfumato::io
