#include "passes/points_cpu.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/wide.h"
#include "passes/loops_cpu.h"
#include "passes/shaders_cpu.h"

namespace sfumato {
namespace {

using namespace cpu;

constexpr std::uint64_t no_pair = std::numeric_limits<std::uint64_t>::max();

struct BatchInView {
  std::size_t chunk = 0;
  const Batch* batch = nullptr;
  float distance = 0;  // from the eye
};

/// From front to back, so that most of what is hidden is so when it is visited: no result depends on it.
std::vector<BatchInView> batches_in_view(GpuCloud& cloud, const View& view) {
  std::vector<BatchInView> out;
  const mat4 eye_from_cloud(view.eye_from_cloud());
  for (std::size_t c = 0; c < cloud.chunks().size(); ++c) {
    const GpuCloud::Chunk& chunk = cloud.chunks()[c];
    for (std::uint32_t b = 0; b < chunk.batch_count; ++b) {
      const Batch& batch = cloud.prepared().batches[chunk.first_batch + b];
      if (!GpuCloud::is_in_view(batch, view)) continue;
      const vec3 middle = 0.5f * (batch.box_min + batch.box_max);
      out.push_back({c, &batch, glm::length(vec3(eye_from_cloud * vec4(middle, 1)))});
    }
  }
  std::sort(out.begin(), out.end(), [](const BatchInView& a, const BatchInView& b) {
    return std::pair(a.distance, a.batch) < std::pair(b.distance, b.batch);
  });
  return out;
}

/// What was there before; `pair` replaces it where it is less.
[[gnu::always_inline]] inline std::uint64_t lower(std::uint64_t& cell, std::uint64_t pair) {
  const std::atomic_ref<std::uint64_t> shared(cell);
  std::uint64_t before = shared.load(std::memory_order_relaxed);
  while (pair < before && !shared.compare_exchange_weak(before, pair, std::memory_order_relaxed)) {
  }
  return before;
}

/// The uniforms of points_to_pixels.comp, and its functions.
struct Visitor {
  Visitor(GpuCloud& cloud, const View& view, const PointVisit& asked, PointsCpu::Pairs& nearest)
      : eye(view),
        visit(asked),
        reference(asked.reference ? asked.reference->peek<float>().data() : nullptr),
        foot(asked.footprint),
        cut(cloud.cut()),
        pairs(nearest.data()),
        width(nearest.width()),
        height(nearest.height() / asked.list_length),
        dots(foot.mode == SizeMode::adaptive && foot.dot_share > 0),
        spacings(foot.mode == SizeMode::adaptive && !dots && foot.spacing_is_field),
        single(foot.mode == SizeMode::pixels && foot.size <= 1),
        oriented(foot.oriented && cloud.has_normals() && !single),
        usual_spacing(cloud.median_spacing()),
        largest_spacing(foot.largest_medians * usual_spacing),
        spacing_unit(cloud.prepared().spacing_unit()) {}

  [[gnu::always_inline]] void cover(int x, int y, float depth, std::uint32_t source) const {
    const std::size_t at = std::size_t(y) * std::size_t(width) + std::size_t(x);
    if (reference && !(depth >= reference[at] + visit.min_gap)) return;
    std::uint64_t pair = std::uint64_t(std::bit_cast<std::uint32_t>(depth)) << 32 | source;
    if (visit.list_length == 1) {
      lower(pairs[at], pair);
      return;
    }
    const std::size_t step = std::size_t(width) * std::size_t(height);
    // Every entry keeps the least that it is given and hands on the rest, unless both are of one bin.
    for (int k = 0; k < visit.list_length; ++k) {
      const std::uint64_t before = lower(pairs[at + std::size_t(k) * step], pair);
      if (before == no_pair || bin_of(before) == bin_of(pair)) return;
      pair = std::max(pair, before);
    }
  }
  float bin_of(std::uint64_t pair) const {
    return std::floor(std::bit_cast<float>(std::uint32_t(pair >> 32)) * visit.inverse_bin);
  }

  /// Whether all of these pixels keep what is nearer.
  [[gnu::always_inline]] bool is_hidden(const ivec2& low, const ivec2& high, float least) const {
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(least);
    const std::size_t last = std::size_t(width) * std::size_t(height) * std::size_t(visit.list_length - 1);
    for (int y = low.y; y <= high.y; ++y) {
      std::uint64_t* row = pairs + last + std::size_t(y) * std::size_t(width);
      for (int x = low.x; x <= high.x; ++x)
        if (bits <= std::atomic_ref(row[x]).load(std::memory_order_relaxed) >> 32) return false;
    }
    return true;
  }

  /// px
  [[gnu::always_inline]] float diameter_of(const Points& points, std::uint32_t i, const Batch& batch,
                                           const vec3& position, float depth) const {
    constexpr vec2 closing(2.5f, 3.75f);
    constexpr float overlap = 1.41f, lone = 0.32f, lone_most = 3.2f;
    float diameter = foot.size;
    const float scale = eye.pixels_at(depth);
    if (foot.mode == SizeMode::pixels) return diameter;
    if (foot.mode == SizeMode::world) return diameter * scale;
    vec2 own(0);
    float spacing;
    if (dots)
      own = points.fields_at(i), spacing = own.x * spacing_unit;
    else
      spacing = std::min(spacings ? points.field_at(i) : batch.spacing_at(position), largest_spacing);
    diameter *= spacing * scale;
    const float plain = diameter;
    if (foot.wide_px > 0 && diameter > foot.wide_px)
      diameter = foot.wide_px * std::sqrt(std::sqrt(diameter / foot.wide_px));
    if (!dots) return diameter;
    const float apart = foot.size * std::min(spacing, usual_spacing) * scale;
    const float most_px = foot.most_dot_px * glm::clamp(lone * apart / foot.most_dot_px, 1.0f, lone_most);
    const float as_dot = glm::clamp(foot.dot_share * plain, foot.least_dot_px, most_px);
    own.y *= 1 - glm::smoothstep(closing.x, closing.y, plain / foot.wide_px);
    diameter = glm::mix(as_dot, diameter, own.y);
    const float usual = std::max(foot.sparse_px / scale, overlap * usual_spacing);
    if (spacing > usual)
      diameter = std::max(std::min(diameter, foot.least_dot_px), diameter * std::sqrt(usual / spacing));
    return diameter;
  }

  /// A disc in the plane of its normal, where the rays through the centres of pixels meet it.
  [[gnu::always_inline]] void cover_oriented(const vec3& center, const vec3& normal, float diameter,
                                             std::uint32_t source) const {
    constexpr float least_px = 0.71f, dense_px = 1.5f;  // points_to_pixels.cpp
    const float depth = -center.z;
    Disc disc;
    disc.center = center, disc.normal = normal;
    disc.radius = std::max(0.5f * std::min(diameter, foot.most_px), least_px) / eye.pixels_at(depth);
    if (diameter < dense_px) {
      const vec2 pixel = glm::floor(eye.pixel_from_eye(center));
      if (!is_inside(pixel)) return;
      disc.first_x = disc.last_x = std::uint16_t(pixel.x);
      disc.first_y = disc.last_y = std::uint16_t(pixel.y);
    } else if (!find_pixels(disc, eye, 0)) {
      return;
    }
    const float spread = eye.orthographic ? 1 : depth, perspective = eye.orthographic ? 0 : 1;
    for (int y = disc.first_y; y <= disc.last_y; ++y)
      for (int x = disc.first_x; x <= disc.last_x; ++x) {
        const vec2 slope(eye.slopes_x[std::size_t(x)], eye.slopes_y[std::size_t(y)]);
        const vec3 direction(slope * perspective, -1);
        const vec2 across = slope * spread - vec2(center);
        // Edge-on: infinite or not a number, hence a miss.
        const float beyond = -glm::dot(vec2(normal), across) / glm::dot(normal, direction);
        const vec3 offset = vec3(across, 0) + beyond * direction;
        const float hit = depth + beyond;
        if (glm::dot(offset, offset) <= disc.radius * disc.radius && hit >= eye.near_plane)
          cover(x, y, hit, source);
      }
  }

  [[gnu::always_inline]] void cover_round(const vec2& center, float diameter, float depth,
                                          std::uint32_t source) const {
    const float radius = 0.5f * std::min(diameter, foot.most_px);
    // A paraboloid as deep as its radius.
    const float bulge = 1 / (radius * eye.pixels_at(depth)), radius2 = radius * radius;
    const vec2 first = glm::max(glm::ceil(center - radius - 0.5f), vec2(0)),
               last = glm::min(glm::floor(center + radius - 0.5f), eye.size - 1.0f);
    if (!(first.x <= last.x && first.y <= last.y)) return;
    const ivec2 low(first), high(last), own(glm::floor(center));
    if (is_hidden(low, high, depth)) return;
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x) {
        const vec2 away = vec2(x, y) + 0.5f - center;
        const float away2 = glm::dot(away, away);
        // It always owns the pixel its centre falls into, however small it is.
        if (away2 <= radius2 || ivec2(x, y) == own)
          cover(x, y, depth + bulge * std::min(away2, radius2), source);
      }
  }

  bool is_inside(const vec2& pixel) const {
    return pixel.x >= 0 && pixel.y >= 0 && pixel.x < eye.size.x && pixel.y < eye.size.y;
  }

  [[gnu::always_inline]] void point(const Points& points, std::uint32_t i, const Batch& batch) const {
    if (visit.casters) {
      const float stopped = points.opacity ? points.opacity[i] : 0;
      if (!(stopped >= visit.casters->from && stopped < visit.casters->below)) return;
    }
    const vec3 position = points.positions[i];
    if (!cut.empty() && is_cut(cut, position)) return;
    const vec3 place = eye.turned(position) + vec3(eye.eye_from_cloud[3]);
    const float depth = -place.z;
    if (!(depth >= eye.near_plane)) return;
    const std::uint32_t source = points.source_index[i];
    const vec2 center = eye.pixel_from_eye(place);
    if (!single) {
      const float diameter = diameter_of(points, i, batch, position, depth);
      const bool is_single = diameter < foot.single_px;
      if (oriented && !is_single) {
        const vec3 normal = eye.turned(points.normal(i));
        if (glm::dot(normal, normal) > 0.25f) {
          cover_oriented(place, normal, diameter, source);
          return;
        }
      }
      if (diameter > 1 && !is_single) {
        cover_round(center, diameter, depth, source);
        return;
      }
    }
    if (is_inside(center)) cover(int(center.x), int(center.y), depth, source);
  }

  Eye eye;
  const PointVisit& visit;
  const float* reference;
  const Footprint& foot;
  const GpuCloud::Cut& cut;
  std::uint64_t* pairs;
  int width, height;
  bool dots, spacings, single, oriented;
  float usual_spacing, largest_spacing, spacing_unit;
};

SFUMATO_WIDE void visit_batch(const Visitor& visitor, const Points& points, std::uint32_t first,
                              const Batch& batch) {
  for (std::uint32_t i = first; i < first + batch.count; ++i) visitor.point(points, i, batch);
}

/// points_resolve.glsl and places.glsl.
class Resolver {
 public:
  Resolver(GpuCloud& cloud, const View& view, const gl::Texture& depth_bits, const gl::Texture& index,
           bool with_normals)
      : eye_(view),
        bits_(depth_bits.peek<std::uint32_t>()),
        sources_(index.peek<std::uint32_t>()),
        has_normals_(with_normals && cloud.has_normals()) {
    for (const ResidentCloud::Places& part : cloud.places())
      parts_.push_back(
          {part.first, part.count, static_cast<const std::uint32_t*>(part.values.buffer().memory())});
    for (std::size_t c = 0; c < cloud.chunks().size(); ++c)
      chunks_.push_back(
          {cloud.chunks()[c].first, cloud.chunks()[c].count, Points(cloud, c, {has_normals_, false, true})});
  }

  void row(int y, vec4* colors, float* depths, vec4* normals) const {
    const std::uint32_t *bits = bits_.row(y), *sources = sources_.row(y);
    for (int x = 0; x < bits_.width(); ++x) {
      colors[x] = vec4(0), depths[x] = std::numeric_limits<float>::infinity();
      if (normals) normals[x] = vec4(0, 0, 0, 1);
      if (sources[x] == ~0u) continue;
      const auto [points, i] = point_of(sources[x]);
      if (!points) continue;
      const float depth = std::bit_cast<float>(bits[x]);
      colors[x] = vec4(points->linear_color(i), 1), depths[x] = depth;
      if (!normals) continue;
      if (has_normals_) {
        const vec3 normal = points->normal(i);
        const vec3 ray(eye_.slopes_x[std::size_t(x)], eye_.slopes_y[std::size_t(y)], -1);
        const vec3 to_camera = eye_.orthographic ? vec3(0, 0, 1) : -depth * ray;
        // Unoriented: towards the camera.
        const bool away = glm::dot(eye_.turned(normal), to_camera) < 0;
        normals[x] = vec4(away ? -normal : normal, 1);
      }
      if (points->shadow) normals[x].w = points->shadow[i];
    }
  }

 private:
  /// Its chunk and its number there; null where the cloud has none of that source index.
  std::pair<const Points*, std::uint32_t> point_of(std::uint32_t source) const {
    for (const Part& part : parts_) {
      if (source - part.first >= part.count) continue;
      const std::uint32_t place = part.places[source - part.first];
      for (const Chunk& chunk : chunks_)
        if (place - chunk.first < chunk.count) return {&chunk.points, place - chunk.first};
    }
    return {nullptr, 0};
  }

  struct Part {
    std::uint32_t first, count;
    const std::uint32_t* places;
  };
  struct Chunk {
    std::uint32_t first, count;
    Points points;
  };
  Eye eye_;
  const Image<std::uint32_t>&bits_, &sources_;
  bool has_normals_;
  std::vector<Part> parts_;
  std::vector<Chunk> chunks_;
};

}  // namespace

void PointsCpu::begin(int width, int height) {
  if (pairs_.width() != width || pairs_.height() != height) pairs_ = Pairs(width, height);
  std::fill(pairs_.begin(), pairs_.end(), no_pair);
}

void PointsCpu::begin(const gl::Texture& depth_bits, const gl::Texture* index) {
  begin(depth_bits.width(), depth_bits.height());
  const std::uint32_t *bits = depth_bits.peek<std::uint32_t>().data(),
                      *numbers = index ? index->peek<std::uint32_t>().data() : nullptr;
  for (std::size_t i = 0; i < pairs_.size(); ++i)
    pairs_.data()[i] = std::uint64_t(bits[i]) << 32 | (numbers ? numbers[i] : ~0u);
}

void PointsCpu::words(Image<std::uint32_t>& out, int shift) const {
  if (out.width() != pairs_.width() || out.height() != pairs_.height())
    out = Image<std::uint32_t>(pairs_.width(), pairs_.height());
  for_each_row(pairs_.height(), [&](int y) {
    std::transform(pairs_.row(y), pairs_.row(y) + pairs_.width(), &out.at(0, y),
                   [&](std::uint64_t pair) { return std::uint32_t(pair >> shift); });
  });
}

void PointsCpu::end(gl::Texture& depth_bits, gl::Texture* index) const {
  const auto give = [&](gl::Texture& texture, int shift) {
    Image<std::uint32_t> image = texture.blank<std::uint32_t>();
    words(image, shift);
    texture.give(std::move(image));
  };
  give(depth_bits, 32);
  if (index) give(*index, 0);
}

void PointsCpu::visit(GpuCloud& cloud, const View& view, const PointVisit& visit) {
  const Visitor visitor(cloud, view, visit, pairs_);
  std::vector<Points> chunks;
  for (std::size_t c = 0; c < cloud.chunks().size(); ++c)
    chunks.emplace_back(cloud, c, Points::Reads{visitor.oriented, false, false});
  const std::vector<BatchInView> batches = batches_in_view(cloud, view);

  in_order(batches.size(), [&](std::size_t k) {
    const BatchInView& of = batches[k];
    visit_batch(visitor, chunks[of.chunk], of.batch->first - cloud.chunks()[of.chunk].first, *of.batch);
    return true;
  });
}

void resolve_points(GpuCloud& cloud, const View& view, const gl::Texture& depth_bits,
                    const gl::Texture& index, gl::Texture& albedo, gl::Texture& depth, gl::Texture* normal) {
  wait_for_gl();
  const Resolver resolver(cloud, view, depth_bits, index, normal != nullptr);
  Image<vec4> colors = albedo.blank<vec4>(), normals = normal ? normal->blank<vec4>() : Image<vec4>();
  Image<float> depths = depth.blank<float>();
  for_each_row(colors.height(), [&](int y) {
    resolver.row(y, &colors.at(0, y), &depths.at(0, y), normal ? &normals.at(0, y) : nullptr);
  });
  albedo.give(std::move(colors)), depth.give(std::move(depths));
  if (normal) normal->give(std::move(normals));
}

}  // namespace sfumato
