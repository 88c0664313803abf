// Random numbers that belong to a point, not to a thread: every point, ray or primitive starts its own
// sequence from (seed, stream, index), so a result never depends on who computed it.
#pragma once

#include <cmath>
#include <cstdint>

namespace sfumato::synth {

/// Independent uses of one seed.
enum class Stream : std::uint64_t { area = 1, outlier, range, beam, camera, layout, layout_leaf, pulse };

inline std::uint64_t mix_bits(std::uint64_t z) {  // finaliser of splitmix64 (Steele, Lea, Flood 2014)
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
  return z ^ (z >> 31);
}

class Random {
 public:
  Random(std::uint64_t seed, Stream stream, std::uint64_t index)
      : state_(mix_bits(mix_bits(mix_bits(seed + 0x9E3779B97F4A7C15ull) + std::uint64_t(stream)) + index)) {}

  std::uint64_t bits() { return mix_bits(state_ += 0x9E3779B97F4A7C15ull); }
  /// [0, 1)
  double uniform() { return double(bits() >> 11) * 0x1p-53; }
  double uniform(double lo, double hi) { return lo + (hi - lo) * uniform(); }
  /// Standard normal (Box and Muller 1958).
  double gaussian() {
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    return radius * std::cos(2 * M_PI * uniform());
  }

 private:
  std::uint64_t state_;
};

}  // namespace sfumato::synth
