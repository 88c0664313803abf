// The cloud of every comparison: three nested tori (the synthetic scene of Dobrev 2010), uniform by area,
// equal counts, opacities 0.3, 0.5 and 1. Deterministic, so that ours and the peers load the same bytes.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace sfumato::bench {

enum class Order { random, morton };

/// One vertex of the PLY file: 28 bytes, no padding.
struct TorusPoint {
  float position[3], normal[3];
  std::array<std::uint8_t, 4> rgba;
};

std::vector<TorusPoint> tori(std::size_t count, Order order = Order::random, std::uint64_t seed = 12345);
/// Binary little-endian PLY: x y z nx ny nz (float) red green blue alpha (uchar).
void write_tori(const std::filesystem::path& file, const std::vector<TorusPoint>& points);
/// tori_<count>.ply or tori_m_<count>.ply in $SFUMATO_BENCH_DATA (default: out/bench below the working
/// directory), written when it is missing.
std::filesystem::path tori_file(std::size_t count, Order order = Order::random);

}  // namespace sfumato::bench
