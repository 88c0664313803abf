#include "passes/splat_cpu.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <tuple>

#include "core/color.h"
#include "core/wide.h"
#include "gl/context.h"
#include "gl/pace.h"
#include "gl/preferences.h"
#include "passes/loops_cpu.h"
#include "passes/view.h"

namespace sfumato {
namespace {

using namespace cpu;

/// Rows whose sums stay in a core's cache while all splats of the band are added.
constexpr int band_rows = 16;
/// Rows that are given away together: at 3840 px 70 MB of sums and surface.
constexpr int stripe_rows = 256;
constexpr float miss = 2;  ///< squared distance from a centre, in radii

/// cloud_splat of shaders/splat_cloud.glsl.
[[gnu::always_inline]] inline Disc disc_of(const Points& points, std::uint32_t i, const Eye& eye,
                                           const SplatShape& shape, const GpuCloud::Cut& cut) {
  constexpr float closing = 2, closed = 4, dot_share = 0.3125f;
  const vec3 position = points.positions[i];
  Disc disc;
  disc.point = i;
  disc.center = eye.turned(position) + vec3(eye.eye_from_cloud[3]);
  disc.normal = eye.turned(points.normal(i));
  const vec3 toward = eye.to_camera(disc.center);
  const vec2 radius_surface = points.radii[i];
  const bool is_far_side = radius_surface.y < 0 && glm::dot(disc.normal, toward) < 0;
  if (glm::dot(disc.normal, disc.normal) < 0.25f) disc.normal = toward;
  disc.radius = std::min(radius_surface.x, shape.radius_limit) * shape.radius_scale;
  const float wider = disc.radius * eye.pixels_at(std::max(-disc.center.z, eye.near)) / shape.widest_px;
  const float surface =
      (shape.dots ? std::abs(radius_surface.y) : 1) * (1 - glm::smoothstep(closing, closed, wider));
  const float most = surface < 1 ? std::min(1.0f, dot_share / (1 - surface)) : 1;
  if (wider > most) disc.radius *= most / wider;
  if (surface < 1) {
    const float turn = glm::dot(disc.normal, toward) < 0 ? -surface : surface;
    disc.normal = glm::normalize(toward * (1 - surface) + disc.normal * turn);
  }
  if (shape.part != SplatPart::all &&
      (points.field_at(i) > shape.field_threshold) != (shape.part == SplatPart::above))
    disc.radius = 0;
  if (!cut.empty() && is_cut(cut, position)) disc.radius = 0;
  disc.behind =
      is_far_side ? std::max(shape.behind, shape.behind_radii / shape.radius_scale * disc.radius) : 0;
  return disc;
}

/// hit_splat of shaders/splat.glsl at pixels side by side.
struct LaneHits {
  float t[lanes];     // as SplatHit::t
  float rho2[lanes];  // squared distance from the centre in radii; 1 and more: a miss
};
struct Caster {
  Caster(const Disc& of, const Eye& eye, float prefilter_px)
      : disc(of),
        near(eye.near),
        depth(-disc.center.z),
        spread(eye.orthographic ? 1 : depth),
        perspective(eye.orthographic ? 0 : 1),
        inverse_r2(1 / (disc.radius * disc.radius)) {
    const float scale = eye.pixels_at(depth) / prefilter_px;
    per_screen2 = prefilter_px > 0 && scale > 0 ? scale * scale : 0;
    off_screen2 = per_screen2 > 0 ? 0 : miss;
  }
  [[gnu::always_inline]] void hit(const float* slopes_x, float slope_y, LaneHits& hits) const {
    const float ay = slope_y * spread - disc.center.y, sy = slope_y * perspective;
    const float nx = disc.normal.x, nay = disc.normal.y * ay, nsy = disc.normal.y * sy - disc.normal.z;
    for (int k = 0; k < lanes; ++k) {
      const float ax = slopes_x[k] * spread - disc.center.x, sx = slopes_x[k] * perspective;
      const float beyond = -(nx * ax + nay) / (nx * sx + nsy);
      const float ox = ax + beyond * sx, oy = ay + beyond * sy;
      const float rho2 = (ox * ox + oy * oy + beyond * beyond) * inverse_r2;
      const float screen2 = (ax * ax + ay * ay) * per_screen2 + off_screen2;
      const bool inside = rho2 < 1;  // false where it is edge-on: infinite or not a number
      const float z = inside ? depth + beyond : depth;
      const float least2 = rho2 < screen2 ? rho2 : screen2;
      const float kept2 = inside ? least2 : screen2;
      hits.rho2[k] = z >= near ? kept2 : miss;
      hits.t[k] = z * std::sqrt(sx * sx + sy * sy + 1) + disc.behind;
    }
  }

  const Disc& disc;
  float near, depth, spread, perspective, inverse_r2, per_screen2, off_screen2;
};

/// Whether a hit is of the surface that the nearest one begins; with room for a few roundings.
bool counts(float t, float nearest, float epsilon) { return t <= nearest * 1.000002f + epsilon; }

/// Whether no pixel has a hit so far that one of the disc's can be near to.
[[gnu::always_inline]] inline bool is_hidden(const Disc& disc, const Eye& eye, float prefilter_px,
                                             float epsilon, Image<float>& nearest) {
  const float z = -disc.center.z,
              around = prefilter_px > 0 ? prefilter_px / eye.pixels_at(std::max(z, eye.near)) : 0;
  const float least = (eye.orthographic ? z : glm::length(disc.center)) - disc.radius - around + disc.behind;
  for (int y = disc.first_y; y <= disc.last_y; ++y)
    for (int x = disc.first_x; x <= disc.last_x; ++x)
      if (counts(least, std::atomic_ref<float>(nearest.at(x, y)).load(std::memory_order_relaxed), epsilon))
        return false;
  return true;
}

/// Lowers the nearest hits to those of the disc; whether one of its own is no more than `epsilon` behind.
[[gnu::always_inline]] inline bool lower(const Disc& disc, const Eye& eye, float prefilter_px, float shift,
                                         float epsilon, Image<float>& nearest) {
  const Caster caster(disc, eye, prefilter_px);
  bool is_near = false;
  LaneHits hits;
  for (int y = disc.first_y; y <= disc.last_y; ++y) {
    for (int x = disc.first_x; x <= disc.last_x; x += lanes) {
      caster.hit(&eye.slopes_x[std::size_t(x)], eye.slopes_y[std::size_t(y)], hits);
      const int n = std::min(lanes, disc.last_x - x + 1);
      for (int k = 0; k < n; ++k) {
        if (!(hits.rho2[k] < 1)) continue;
        const float moved = hits.t[k] + shift;
        const std::atomic_ref<float> cell(nearest.at(x + k, y));
        float before = cell.load(std::memory_order_relaxed);
        is_near = is_near || counts(hits.t[k], std::min(before, moved), epsilon);
        while (moved < before && !cell.compare_exchange_weak(before, moved, std::memory_order_relaxed)) {
        }
      }
    }
  }
  return is_near;
}

SFUMATO_WIDE void visit(const Points& points, std::uint32_t first, std::uint32_t count, const Eye& eye,
                        const SplatShape& shape, const SplatShift& shift, float epsilon,
                        const GpuCloud::Cut& cut, Image<float>& nearest, std::vector<Disc>& kept) {
  kept.clear();
  for (std::uint32_t i = first; i < first + count; ++i) {
    Disc disc = disc_of(points, i, eye, shape, cut);
    if (!find_pixels(disc, eye, shape.prefilter_px)) continue;
    if (is_hidden(disc, eye, shape.prefilter_px, epsilon, nearest)) continue;
    const float moved = std::max(shift.least, shift.radii / shape.radius_scale * disc.radius);
    if (lower(disc, eye, shape.prefilter_px, moved, epsilon, nearest)) kept.push_back(disc);
  }
}

/// The side of deeper_side.glsl at one pixel.
vec2 deeper_side(const Image<float>& nearest, int x, int y, float full_step) {
  constexpr int distance_px = 2;
  const float own = nearest.at(x, y);
  const auto deeper = [&](int dx, int dy) {
    return std::clamp(
        nearest.at(std::clamp(x + dx, 0, nearest.width() - 1), std::clamp(y + dy, 0, nearest.height() - 1)) -
            own,
        -full_step, full_step);
  };
  return {deeper(distance_px, 0) - deeper(-distance_px, 0), deeper(0, distance_px) - deeper(0, -distance_px)};
}

/// splat_weight of shaders/splat.glsl of the hits that count, 0 of the others.
[[gnu::always_inline]] inline void weigh(const LaneHits& hits, const float* nearest, const SplatBlend& blend,
                                         float epsilon, float* weights) {
  for (int k = 0; k < lanes; ++k) {
    const float weight = blend.opaque ? 1 : wendland(hits.rho2[k]);
    weights[k] = hits.rho2[k] < 1 && counts(hits.t[k], nearest[k], epsilon) ? weight : 0;
  }
  if (blend.kernel == SplatKernel::gaussian && !blend.opaque)
    for (int k = 0; k < lanes; ++k)
      if (weights[k] > 0) weights[k] = std::exp(-hits.rho2[k] / (2 * 0.316f));
}

/// splat_accumulate.frag over the rows [first_row, last_row].
[[gnu::always_inline]] inline void add(const Disc& disc, const Points& points, const Eye& eye,
                                       float prefilter_px, const SplatBlend& blend, float epsilon,
                                       const Image<float>& nearest, int first_row, int last_row,
                                       SplatCpu::Sums& sums) {
  constexpr float grazing2 = 0.35f * 0.35f;
  const Caster caster(disc, eye, prefilter_px);
  const vec4 color(points.linear_color(disc.point), 1);
  const vec3 own = eye.turned(points.normal(disc.point));
  const float lit = points.shadow ? points.shadow[disc.point] : 1;
  LaneHits hits;
  float here[lanes] = {}, weights[lanes];
  for (int y = std::max(int(disc.first_y), first_row); y <= std::min(int(disc.last_y), last_row); ++y) {
    const float sy = eye.slopes_y[std::size_t(y)] * caster.perspective;
    for (int from = disc.first_x; from <= disc.last_x; from += lanes) {
      const int n = std::min(lanes, disc.last_x - from + 1);
      std::copy_n(&nearest.at(from, y), n, here);
      caster.hit(&eye.slopes_x[std::size_t(from)], eye.slopes_y[std::size_t(y)], hits);
      weigh(hits, here, blend, epsilon, weights);
      for (int k = 0; k < n; ++k) {
        const float w = weights[k];
        if (w == 0) continue;
        const int x = from + k;
        const vec3 slope(eye.slopes_x[std::size_t(x)] * caster.perspective, sy, -1);
        const float facing = glm::dot(own, slope);
        float side = facing > 0 ? -1 : 1;
        if (!blend.opaque && facing * facing < grazing2 * glm::dot(slope, slope) &&
            side * glm::dot(deeper_side(nearest, x, y, blend.epsilon), vec2(own.x, -own.y)) < 0)
          side = -side;
        const int row = y - sums.first_row;
        sums.color.at(x, row) += w * color;
        sums.normal.at(x, row) += w * vec4(side * own, hits.t[k] - disc.behind);
        if (points.shadow) sums.shadow.at(x, row) += w * lit;
      }
    }
  }
}

struct Entry {
  const Disc* disc;
  std::size_t chunk;
};
SFUMATO_WIDE void add_rows(std::span<const Entry> entries, const std::vector<Points>& chunks, const Eye& eye,
                           float prefilter_px, const SplatBlend& blend, float epsilon,
                           const Image<float>& nearest, int first_row, SplatCpu::Sums& sums) {
  for (const Entry& entry : entries)
    add(*entry.disc, chunks[entry.chunk], eye, prefilter_px, blend, epsilon, nearest, first_row,
        first_row + band_rows - 1, sums);
}

template <class Use>
void for_each_range(const SplatBatches& batches, const Use& use) {
  for (std::size_t c = 0; c < batches.chunks.size(); ++c) {
    const SplatBatches::OfChunk& of = batches.chunks[c];
    for (const SplatBatches::Ranges* ranges : {&of.points, &of.quads, &of.small})
      for (std::size_t r = 0; r < ranges->first.size(); ++r) {
        const int corners = ranges == &of.quads ? 6 : 1;
        use(c, std::uint32_t(ranges->first[r] / corners), std::uint32_t(ranges->count[r] / corners));
      }
  }
}

/// Distance of a point from the eye.
float depth_of(const Points& points, std::uint32_t i, const Eye& eye) {
  return glm::length(eye.turned(points.positions[i]) + vec3(eye.eye_from_cloud[3]));
}

/// False when `take` wants no more.
SFUMATO_WIDE bool give_hits(const Points& points, std::uint32_t first, std::uint32_t count, const Eye& eye,
                            const SplatShape& shape, const GpuCloud::Cut& cut,
                            const std::function<bool(const Disc&)>& wants,
                            const std::function<bool(const SplatCpu::Hits&)>& take) {
  LaneHits hits;
  for (std::uint32_t i = first; i < first + count; ++i) {
    Disc disc = disc_of(points, i, eye, shape, cut);
    if (!find_pixels(disc, eye, shape.prefilter_px) || (wants && !wants(disc))) continue;
    const Caster caster(disc, eye, shape.prefilter_px);
    for (int y = disc.first_y; y <= disc.last_y; ++y)
      for (int x = disc.first_x; x <= disc.last_x; x += lanes) {
        caster.hit(&eye.slopes_x[std::size_t(x)], eye.slopes_y[std::size_t(y)], hits);
        if (!take({points, disc, x, y, std::min(lanes, disc.last_x - x + 1), hits.t, hits.rho2}))
          return false;
      }
  }
  return true;
}

}  // namespace

bool SplatCpu::is_used() {
  return gl::limits().software && gl::preferences().splat_path == SplatPath::automatic &&
         gl::place_of_work(gl::preferences().splats) == gl::Place::cpu;
}

void SplatCpu::for_each_hit(GpuCloud& cloud, const View& view, const SplatShape& shape,
                            const SplatBatches& batches, const std::function<bool(const cpu::Disc&)>& wants,
                            const std::function<bool(const Hits&)>& take) {
  const Eye eye(view);
  std::vector<Points> chunks;
  for (std::size_t c = 0; c < batches.chunks.size(); ++c) chunks.emplace_back(cloud, c, Points::Reads{});
  struct Range {
    std::size_t chunk;
    std::uint32_t first, count;
    float depth;
  };
  std::vector<Range> ranges;
  for_each_range(batches, [&](std::size_t chunk, std::uint32_t first, std::uint32_t count) {
    // Near the camera a batch may cover a large picture, and nothing of it is hidden.
    constexpr std::uint32_t most = 256;
    for (std::uint32_t k = 0; k < count; k += most)
      ranges.push_back({chunk, first + k, std::min(most, count - k),
                        depth_of(chunks[chunk], first + k + std::min(most, count - k) / 2, eye)});
  });
  std::sort(ranges.begin(), ranges.end(), [](const Range& a, const Range& b) {
    return std::tuple(a.depth, a.chunk, a.first) < std::tuple(b.depth, b.chunk, b.first);
  });
  in_order(ranges.size(), [&](std::size_t k) {
    const Range& of = ranges[k];
    return give_hits(chunks[of.chunk], of.first, of.count, eye, shape, cloud.cut(), wants, take);
  });
}

void SplatCpu::find_nearest(GpuCloud& cloud, const View& view, const SplatShape& shape,
                            const SplatBatches& batches, const SplatShift& shift, float epsilon,
                            Image<float>& nearest) {
  const Eye eye(view);
  std::vector<Points> chunks;
  for (std::size_t c = 0; c < batches.chunks.size(); ++c) chunks.emplace_back(cloud, c, Points::Reads{});
  std::size_t used = 0;
  for_each_range(batches, [&](std::size_t chunk, std::uint32_t first, std::uint32_t count) {
    if (used == kept_.size()) kept_.emplace_back();
    OfBatch& batch = kept_[used++];
    batch.chunk = chunk, batch.first = first, batch.count = count;
    batch.depth = depth_of(chunks[chunk], first + count / 2, eye);
  });
  kept_.resize(used);
  prefilter_px_ = shape.prefilter_px;

  // From front to back, so that most of what is hidden is so when it is visited: no result depends on it.
  std::vector<std::size_t> order(used);
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(kept_[a].depth, a) < std::pair(kept_[b].depth, b);
  });
  in_order(used, [&](std::size_t k) {
    OfBatch& batch = kept_[order[k]];
    visit(chunks[batch.chunk], batch.first, batch.count, eye, shape, shift, epsilon, cloud.cut(), nearest,
          batch.discs);
    return true;
  });
}

void SplatCpu::add_up(GpuCloud& cloud, const View& view, const SplatBlend& blend, float epsilon,
                      const Image<float>& nearest, const std::function<void(const Sums&)>& take) const {
  const Eye eye(view);
  const int width = view.width(), height = view.height();
  std::vector<Points> chunks;
  for (std::size_t c = 0; c < cloud.chunks().size(); ++c) chunks.emplace_back(cloud, c, Points::Reads{});

  // The splats of each band, in their order.
  const std::size_t bands = std::size_t((height + band_rows - 1) / band_rows);
  std::vector<std::size_t> starts(bands + 1, 0);
  const auto for_each_band = [](const Disc& disc, const auto& use) {
    for (std::size_t b = disc.first_y / band_rows; b <= std::size_t(disc.last_y / band_rows); ++b) use(b);
  };
  for (const OfBatch& batch : kept_)
    for (const Disc& disc : batch.discs) for_each_band(disc, [&](std::size_t b) { ++starts[b + 1]; });
  for (std::size_t b = 0; b < bands; ++b) starts[b + 1] += starts[b];
  std::vector<Entry> entries(starts[bands]);
  std::vector<std::size_t> ends(starts.begin(), starts.end() - 1);
  for (const OfBatch& batch : kept_)
    for (const Disc& disc : batch.discs)
      for_each_band(disc, [&](std::size_t b) { entries[ends[b]++] = {&disc, batch.chunk}; });

  const Progress& progress = gl::lent_progress();
  const int most_rows = std::min(stripe_rows, int(bands) * band_rows);
  Sums sums{Image<vec4>(width, most_rows), Image<vec4>(width, most_rows), {}};
  if (cloud.has_shadow()) sums.shadow = Image<float>(width, most_rows);
  for (int first = 0; first < height; first += stripe_rows) {
    sums.first_row = first, sums.rows = std::min(stripe_rows, height - first);
    tbb::parallel_for(first / band_rows, (first + sums.rows + band_rows - 1) / band_rows, [&](int band) {
      progress.check();
      const int top = band * band_rows, row = top - first, rows = std::min(band_rows, height - top);
      std::fill_n(&sums.color.at(0, row), width * rows, vec4(0));
      std::fill_n(&sums.normal.at(0, row), width * rows, vec4(0));
      if (!sums.shadow.empty()) std::fill_n(&sums.shadow.at(0, row), width * rows, 0.0f);
      const std::size_t b = std::size_t(band);
      add_rows(std::span(entries).subspan(starts[b], starts[b + 1] - starts[b]), chunks, eye, prefilter_px_,
               blend, epsilon, nearest, top, sums);
    });
    take(sums);
  }
}

void SplatCpu::normalize(const View& view, const Sums& sums, Surface& surface) {
  const Eye eye(view);
  const int width = view.width();
  const glm::mat3 cloud_from_eye = glm::transpose(glm::mat3(eye.eye_from_cloud));
  tbb::parallel_for(0, sums.rows, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const vec4 color = sums.color.at(x, y);
      const int row = sums.first_row + y;
      vec4 &albedo = surface.albedo.at(x, row), &normal = surface.normal.at(x, row);
      albedo = vec4(0), normal = vec4(0, 0, 0, 1);
      float& depth = surface.depth.at(x, row);
      depth = std::numeric_limits<float>::infinity();
      if (!(color.a > 0)) continue;
      const vec4 mean = sums.normal.at(x, y) / color.a;
      const vec3 slope = eye.orthographic
                             ? vec3(0, 0, -1)
                             : vec3(eye.slopes_x[std::size_t(x)], eye.slopes_y[std::size_t(row)], -1);
      // On an outline, half of it beyond: then it is seen from the side.
      const vec3 facing =
          vec3(mean) - std::max(glm::dot(vec3(mean), slope), 0.0f) / glm::dot(slope, slope) * slope;
      const vec3 n = cloud_from_eye * facing;
      const float size = glm::length(n);
      albedo = vec4(vec3(color) / color.a, 1);
      depth = mean.w / glm::length(slope);  // ray distance to eye depth
      normal =
          vec4(size > 1e-3f ? n / size : vec3(0), sums.shadow.empty() ? 1 : sums.shadow.at(x, y) / color.a);
    }
  });
}

}  // namespace sfumato
