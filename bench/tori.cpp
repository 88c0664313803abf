#include "tori.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <string>
#include <utility>

#include "core/interleave.h"

namespace sfumato::bench {

namespace {

// splitmix64, so that the cloud does not depend on the standard library.
struct Random {
  std::uint64_t state;
  double operator()() {
    state += 0x9E3779B97F4A7C15ull;
    std::uint64_t z = state;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    z ^= z >> 31;
    return double(z >> 11) * (1.0 / 9007199254740992.0);
  }
};

std::uint64_t morton_key(const TorusPoint& p) {
  auto quantise = [](float x) { return std::uint64_t((x + 1.5f) / 3.f * 2097151.f); };
  return interleaved(quantise(p.position[0]), quantise(p.position[1]), quantise(p.position[2]));
}

std::vector<TorusPoint> sort_morton(const std::vector<TorusPoint>& points) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) keys[i] = {morton_key(points[i]), std::uint32_t(i)};
  std::sort(keys.begin(), keys.end());
  std::vector<TorusPoint> sorted(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) sorted[i] = points[keys[i].second];
  return sorted;
}

}  // namespace

std::vector<TorusPoint> tori(std::size_t count, Order order, std::uint64_t seed) {
  constexpr double tube_radius[3] = {0.45, 0.30, 0.15};  // ring radius 1
  constexpr std::array<std::uint8_t, 4> rgba[3] = {
      {60, 90, 220, 77}, {60, 190, 80, 128}, {150, 100, 50, 255}};
  Random random{seed};
  std::vector<TorusPoint> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double r = tube_radius[i % 3];
    double u, w;
    do {  // rejection by the area element 1 + r cos w
      u = 2 * std::numbers::pi * random();
      w = 2 * std::numbers::pi * random();
    } while (random() > (1 + r * std::cos(w)) / (1 + r));
    const double ring = 1 + r * std::cos(w);
    points[i] = {{float(ring * std::cos(u)), float(ring * std::sin(u)), float(r * std::sin(w))},
                 {float(std::cos(w) * std::cos(u)), float(std::cos(w) * std::sin(u)), float(std::sin(w))},
                 rgba[i % 3]};
  }
  return order == Order::morton ? sort_morton(points) : points;
}

void write_tori(const std::filesystem::path& file, const std::vector<TorusPoint>& points) {
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path());
  std::filesystem::path partial = file;
  partial += ".partial";
  std::ofstream out(partial, std::ios::binary);
  out.exceptions(std::ios::failbit | std::ios::badbit);
  out << "ply\nformat binary_little_endian 1.0\nelement vertex " << points.size() << '\n';
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) out << "property float " << name << '\n';
  for (const char* name : {"red", "green", "blue", "alpha"}) out << "property uchar " << name << '\n';
  out << "end_header\n";
  static_assert(sizeof(TorusPoint) == 28);
  out.write(reinterpret_cast<const char*>(points.data()),
            std::streamsize(points.size() * sizeof(TorusPoint)));
  out.close();
  std::filesystem::rename(partial, file);
}

std::filesystem::path tori_file(std::size_t count, Order order) {
  const char* folder = std::getenv("SFUMATO_BENCH_DATA");
  std::filesystem::path file = folder ? folder : "out/bench";
  file /= (order == Order::morton ? "tori_m_" : "tori_") + std::to_string(count) + ".ply";
  if (!std::filesystem::exists(file)) write_tori(file, tori(count, order));
  return file;
}

}  // namespace sfumato::bench
