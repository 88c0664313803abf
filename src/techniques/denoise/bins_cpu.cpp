#include "techniques/denoise/bins_cpu.h"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace sfumato::denoise {
namespace {

using Word = std::atomic_ref<std::uint32_t>;
constexpr auto relaxed = std::memory_order_relaxed;

constexpr std::uint32_t no_bin = 0xffffffffu;
constexpr float weight_unit = 65536, most_weight = 4095, most_distance = 8388607;
constexpr std::uint32_t most_add = 0x10000000u;

/// bins.glsl and weights.glsl.
struct Table {
  const BinOptions& options;
  const BinMemory& memory;
  const Image<float>& nearest;
  std::uint32_t reach = std::uint32_t(options.peak_bins),
                threshold = std::uint32_t(options.weight_threshold * weight_unit);
  bool dense = options.layout == Layout::dense;
  std::atomic<std::uint32_t> overflow = 0, saturated = 0;

  /// -1 when the table is full.
  std::ptrdiff_t claim_slot(std::size_t pixel, std::uint32_t b) const {
    const std::size_t base = pixel * std::size_t(memory.slots);
    if (dense) return std::ptrdiff_t(base + b);
    std::uint32_t slot = fibonacci_slot(b, options.hash_bits);
    for (int probe = 0; probe < memory.slots; ++probe) {
      const Word cell(memory.keys[base + slot]);
      std::uint32_t key = cell.load(relaxed);
      if (key == 0 && cell.compare_exchange_strong(key, b + 1, relaxed)) key = b + 1;
      if (key == b + 1) return std::ptrdiff_t(base + slot);
      slot = (slot + 1) & std::uint32_t(memory.slots - 1);
    }
    return -1;
  }

  void add_to_bin(std::size_t pixel, std::uint32_t b, float weight) {
    const Word first_bin(memory.first_bin.data()[pixel]);
    std::uint32_t first = first_bin.load(relaxed);
    if (first != no_bin && b > first + reach) return;  // it cannot become the nearest
    const std::ptrdiff_t at = claim_slot(pixel, b);
    if (at < 0) {
      overflow.fetch_add(1, relaxed);
      return;
    }
    const std::uint32_t add = std::max(std::uint32_t(std::min(weight, most_weight) * weight_unit + 0.5f), 1u);
    const Word sum(memory.weights[at]);
    const std::uint32_t before = sum.fetch_add(add, relaxed);
    if (before >= 0u - most_add) {
      sum.fetch_sub(add, relaxed);
      saturated.fetch_add(1, relaxed);
    }
    if (before + add <= threshold) return;
    while (b < first && !first_bin.compare_exchange_weak(first, b, relaxed)) {
    }
  }

  void add(std::size_t pixel, float t, float weight) {
    const float nearest_hit = nearest.data()[pixel],
                origin = options.anchor == Anchor::grid
                             ? std::floor(nearest_hit / options.bin_size) * options.bin_size
                             : nearest_hit;
    const float distance = std::clamp((t - origin) / options.bin_size, 0.0f, most_distance);
    auto b = std::uint32_t(options.overlapping ? 2 * distance : distance);
    if (dense) b = std::min(b, std::uint32_t(memory.slots - 1));
    add_to_bin(pixel, b, weight);
    if (options.overlapping && b > 0 && distance < 0.5f * float(b - 1) + 1) add_to_bin(pixel, b - 1, weight);
  }
};

/// Of evidence.glsl.
float worth_of(const SplatCpu::Hits& hits, const cpu::Eye& eye, const SplatShape& shape,
               const BinOptions& options) {
  const cpu::Disc& disc = hits.disc;
  float n = options.covers;
  if (shape.prefilter_px > 0) {
    const float facing = std::max(std::abs(glm::dot(disc.normal, eye.to_camera(disc.center))), 0.05f),
                pixels = eye.pixels_at(std::max(-disc.center.z, eye.near)),
                radius_px = disc.radius * pixels / shape.prefilter_px;
    n *= std::max(1.0f, 1 / (radius_px * radius_px * facing));
  }
  return 7 / (options.surface_share * n) * hits.points.field_at(disc.point);
}

}  // namespace

BinCounts add_weights(GpuCloud& cloud, const View& view, const SplatShape& shape, const SplatBatches& batches,
                      const Image<float>& nearest_t, const BinOptions& options, const BinMemory& into) {
  Table table{options, into, nearest_t};
  const cpu::Eye eye(view);
  const bool has_worth = options.covers > 0 && shape.part != SplatPart::all;
  SplatCpu::for_each_hit(cloud, view, shape, batches, [&](const SplatCpu::Hits& hits) {
    const float worth = has_worth ? worth_of(hits, eye, shape, options) : 1;
    const std::size_t row = std::size_t(hits.y) * std::size_t(view.width()) + std::size_t(hits.x);
    for (int k = 0; k < hits.n; ++k) {
      if (!(hits.rho2[k] < 1)) continue;
      const float rho = std::sqrt(hits.rho2[k]), rest = 1 - rho;
      table.add(row + std::size_t(k), hits.t[k], rest * rest * rest * rest * (4 * rho + 1) * worth);
    }
    return table.overflow.load(relaxed) == 0;
  });
  return {table.overflow, table.saturated};
}

}  // namespace sfumato::denoise
