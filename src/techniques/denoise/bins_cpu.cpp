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

/// bins.glsl.
struct Bins {
  const BinOptions& options;
  int slots;
  bool dense = options.layout == Layout::dense;

  float distance(float nearest_hit, float t) const {
    const float origin = options.anchor == Anchor::grid
                             ? std::floor(nearest_hit / options.bin_size) * options.bin_size
                             : nearest_hit;
    return std::clamp((t - origin) / options.bin_size, 0.0f, most_distance);
  }
  std::uint32_t at(float distance) const {
    const auto b = std::uint32_t(options.overlapping ? 2 * distance : distance);
    return dense ? std::min(b, std::uint32_t(slots - 1)) : b;
  }
  float start(std::uint32_t b) const { return options.overlapping ? 0.5f * float(b) : float(b); }
  bool reaches_earlier(float distance, std::uint32_t b) const {
    return options.overlapping && b > 0 && distance < start(b - 1) + 1;
  }
  /// place_in_bin of attributes.glsl.
  float place(float distance, std::uint32_t wanted) const {
    const std::uint32_t b = at(distance);
    if (b != wanted && !(b == wanted + 1 && reaches_earlier(distance, b))) return -1;
    return std::min(distance - start(wanted), 1.0f);
  }
};

/// weights.glsl.
struct Table {
  Table(const BinOptions& of, const BinMemory& into) : options(of), memory(into), bins{of, into.slots} {}

  const BinOptions& options;
  const BinMemory& memory;
  const Bins bins;
  std::uint32_t reach = std::uint32_t(options.peak_bins),
                threshold = std::uint32_t(options.weight_threshold * weight_unit);
  std::atomic<std::uint32_t> overflow = 0, saturated = 0;

  /// -1 when the table is full.
  std::ptrdiff_t claim_slot(std::size_t pixel, std::uint32_t b) const {
    const std::size_t base = pixel * std::size_t(memory.slots);
    if (bins.dense) return std::ptrdiff_t(base + b);
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
    add_to_bin(pixel, b, std::max(std::uint32_t(std::min(weight, most_weight) * weight_unit + 0.5f), 1u));
  }
  void add_to_bin(std::size_t pixel, std::uint32_t b, std::uint32_t add) {
    const Word first_bin(memory.first_bin.data()[pixel]);
    std::uint32_t first = first_bin.load(relaxed);
    if (first != no_bin && b > first + reach) return;  // it cannot become the nearest
    const std::ptrdiff_t at = claim_slot(pixel, b);
    if (at < 0) {
      overflow.fetch_add(1, relaxed);
      return;
    }
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

  void add(std::size_t pixel, float nearest_hit, float t, float weight) {
    const float distance = bins.distance(nearest_hit, t);
    const std::uint32_t b = bins.at(distance);
    add_to_bin(pixel, b, weight);
    if (bins.reaches_earlier(distance, b)) add_to_bin(pixel, b - 1, weight);
  }
};

/// evidence.glsl.
float evidence_of(const cpu::Disc& disc, const cpu::Eye& eye, const SplatShape& shape,
                  const BinOptions& options) {
  float n = options.covers;
  if (shape.prefilter_px > 0) {
    const float facing = std::max(std::abs(glm::dot(disc.normal, eye.to_camera(disc.center))), 0.05f),
                pixels = eye.pixels_at(std::max(-disc.center.z, eye.near)),
                radius_px = disc.radius * pixels / shape.prefilter_px;
    n *= std::max(1.0f, 1 / (radius_px * radius_px * facing));
  }
  return 7 / (options.surface_share * n);
}

/// Of each 8 x 8 pixels, the farthest end of a chosen bin (farthest.glsl).
Image<float> farthest_ends(const Image<vec4>& choice) {
  Image<float> ends((choice.width() + 7) / 8, (choice.height() + 7) / 8, -1);
  for (int y = 0; y < choice.height(); ++y)
    for (int x = 0; x < choice.width(); ++x)
      ends.at(x / 8, y / 8) = std::max(ends.at(x / 8, y / 8), choice.at(x, y).w);
  return ends;
}

}  // namespace

BinCounts add_weights(GpuCloud& cloud, const View& view, const SplatShape& shape, const SplatBatches& batches,
                      const Image<float>& nearest_t, const BinOptions& options, const BinMemory& into) {
  Table table{options, into};
  const cpu::Eye eye(view);
  const bool has_worth = options.covers > 0 && shape.part != SplatPart::all;
  SplatCpu::for_each_hit(cloud, view, shape, batches, {}, [&](const SplatCpu::Hits& hits) {
    const float worth =
        has_worth ? evidence_of(hits.disc, eye, shape, options) * hits.points.field_at(hits.disc.point) : 1;
    const std::size_t row = std::size_t(hits.y) * std::size_t(view.width()) + std::size_t(hits.x);
    for (int k = 0; k < hits.n; ++k)
      if (hits.rho2[k] < 1)
        table.add(row + std::size_t(k), nearest_t.data()[row + std::size_t(k)], hits.t[k],
                  cpu::wendland(hits.rho2[k]) * worth);
    return table.overflow.load(relaxed) == 0;
  });
  return {table.overflow, table.saturated};
}

void add_attributes(GpuCloud& cloud, const View& view, const SplatShape& shape, const SplatBatches& batches,
                    const Image<float>& nearest_t, const Image<vec4>& choice, const BinOptions& options,
                    const SumMemory& into) {
  constexpr float least_weight = 1 / 536870912.0f, sum_unit = 16777216;  // attributes.glsl says why
  const Bins bins{options, options.dense_bins};
  const cpu::Eye eye(view);
  const Image<float> ends = farthest_ends(choice);
  const auto wants = [&](const cpu::Disc& disc) {
    const float depth = -disc.center.z,
                around = shape.prefilter_px > 0
                             ? shape.prefilter_px / eye.pixels_at(std::max(depth, eye.near))
                             : 0,
                nearest = (eye.orthographic ? depth : glm::length(disc.center)) - disc.radius + disc.behind -
                          around;
    for (int y = disc.first_y / 8; y <= disc.last_y / 8; ++y)
      for (int x = disc.first_x / 8; x <= disc.last_x / 8; ++x)
        if (nearest <= ends.at(x, y)) return true;
    return false;
  };
  SplatCpu::for_each_hit(cloud, view, shape, batches, wants, [&](const SplatCpu::Hits& hits) {
    const cpu::Disc& disc = hits.disc;
    const float worth = options.covers > 0 ? evidence_of(disc, eye, shape, options) : 1,
                lit = hits.points.shadow ? hits.points.shadow[disc.point] : 1;
    const vec3 color = hits.points.linear_color(disc.point);
    const bool has_normal = hits.points.normal(disc.point) != vec3(0);
    const std::size_t row = std::size_t(hits.y) * std::size_t(view.width()) + std::size_t(hits.x);
    for (int k = 0; k < hits.n; ++k) {
      const std::size_t pixel = row + std::size_t(k);
      const vec4& chosen = choice.data()[pixel];
      if (!(hits.rho2[k] < 1) || chosen.x < 0) continue;
      const float place =
          bins.place(bins.distance(nearest_t.data()[pixel], hits.t[k]), std::uint32_t(chosen.x));
      if (place < 0) continue;
      const float w = std::nearbyint(std::max(cpu::wendland(hits.rho2[k]) * worth, least_weight) *
                                     (sum_unit / std::max(chosen.y, 1 / weight_unit)));
      const vec3 slope = eye.orthographic ? vec3(0, 0, -1)
                                          : vec3(eye.slopes_x[std::size_t(hits.x + k)],
                                                 eye.slopes_y[std::size_t(hits.y)], -1);
      const vec3 normal = glm::dot(disc.normal, slope) > 0 ? -disc.normal : disc.normal;
      std::uint32_t* sums = into.sums + pixel * std::size_t(into.stride);
      const auto add = [&](int at, float value) {
        Word(sums[at]).fetch_add(std::uint32_t(std::int32_t(std::nearbyint(value))), relaxed);
      };
      add(0, w), add(1, w * color.r), add(2, w * color.g), add(3, w * color.b);
      if (has_normal) add(4, w * normal.x), add(5, w * normal.y), add(6, w * normal.z);
      add(7, w * place);
      if (hits.points.shadow) add(8, w * lit);
    }
    return true;
  });
}

BinCounts add_bins(const std::vector<VisiblePoints::Bin>& bins, const BinOptions& options,
                   const BinMemory& into) {
  Table table{options, into};
  const auto last = std::uint32_t(into.slots - 1);
  for (const VisiblePoints::Bin& bin : bins)
    table.add_to_bin(bin.pixel, table.bins.dense ? std::min(bin.number, last) : bin.number, bin.weight);
  return {table.overflow, table.saturated};
}

}  // namespace sfumato::denoise
