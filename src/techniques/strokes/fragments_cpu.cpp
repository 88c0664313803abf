#include "techniques/strokes/fragments_cpu.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <tuple>

#include "gl/commands.h"
#include "gl/pace.h"

namespace sfumato::strokes {
namespace {

using Four = float __attribute__((vector_size(16)));

/// Bilinear in a tile of a level of the brush; `at` is 0 to 1 in the tile and stays half a texel off its
/// border.
Four sample(const Image<vec4>& level, int tile_x, int tile_y, vec2 at) {
  const int n = level.width() / BrushPicture::tiles;
  const float x = at.x * float(n) - 0.5f, y = at.y * float(n) - 0.5f;
  const int x0 = std::clamp(int(x), 0, n - 1), y0 = std::clamp(int(y), 0, n - 1);
  const int right = x0 + 1 < n ? 1 : 0, below = y0 + 1 < n ? level.width() : 0;
  const vec4* texel = &level.at(tile_x * n + x0, tile_y * n + y0);
  auto load = [](const vec4* v) { return Four{v->x, v->y, v->z, v->w}; };
  const float fx = x - float(x0), fy = y - float(y0);
  const Four top = load(texel) + fx * (load(texel + right) - load(texel));
  const Four bottom = load(texel + below) + fx * (load(texel + below + right) - load(texel + below));
  return top + fy * (bottom - top);
}

/// As pack_paint of stroke.frag: 16 bits of alpha, 8 bits of twice either slope.
std::uint32_t pack_paint(float alpha, float slope_along, float slope_across) {
  auto snorm = [](float v) { return std::uint32_t(std::lrint(std::clamp(v, -1.0f, 1.0f) * 127)) & 0xffu; };
  return std::uint32_t(std::lrint(std::clamp(alpha, 0.0f, 1.0f) * 65535)) | snorm(2 * slope_along) << 16 |
         snorm(2 * slope_across) << 24;
}

}  // namespace

/// Hands out pages of the buffer until there is none left.
struct FragmentsCpu::Pages {
  glm::uvec4* fragments;
  std::uint64_t count;
  std::atomic<std::uint64_t> taken = 0, found = 0;
};

void FragmentsCpu::begin(const View& view, const StrokeSet& strokes, const BrushPicture& brush) {
  gl::barrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  brush_ = &brush;
  gl::end_stretch();
  order_strokes(strokes);
  gl::end_stretch();
  set_up(view, brush);
  gl::end_stretch();

  const std::uint32_t strips = std::uint32_t((view.height() + strip_rows - 1) / strip_rows);
  starts_.assign(strips + 1, 0);
  auto strips_of = [&](const Quad& quad, auto&& visit) {
    if (quad.x1 < quad.x0) return;
    for (int s = quad.y0 / strip_rows; s <= quad.y1 / strip_rows; ++s) visit(std::size_t(s));
  };
  for (const Quad& quad : quads_) strips_of(quad, [&](std::size_t s) { ++starts_[s + 1]; });
  for (std::uint32_t s = 0; s < strips; ++s) starts_[s + 1] += starts_[s];
  entries_.resize(starts_[strips]);
  std::vector<std::uint32_t> ends(starts_.begin(), starts_.end() - 1);
  for (std::uint32_t k = 0; k < quads_.size(); ++k)
    strips_of(quads_[k], [&](std::size_t s) { entries_[ends[s]++] = k; });
}

/// Near to far, strokes of one distance (coincident points) by lot, place in the file and layer, as in
/// paint.glsl.
void FragmentsCpu::order_strokes(const StrokeSet& strokes) {
  records_.resize(strokes.count() * record_texels);
  order_.resize(strokes.count());
  if (order_.empty()) return;
  strokes.records().buffer().download(records_.data(), records_.size() * sizeof(glm::uvec4));
  strokes.order().buffer().download(order_.data(), order_.size() * sizeof(std::uint32_t));
  auto key = [&](std::uint32_t stroke) { return records_[stroke * record_texels].w; };
  auto rest = [&](std::uint32_t stroke) {
    const glm::uvec4& texel = records_[stroke * record_texels + 5];
    return std::make_tuple(texel.z, texel.x, stroke);
  };
  for (std::size_t k = 0, end; k < order_.size(); k = end) {
    for (end = k + 1; end < order_.size() && key(order_[end]) == key(order_[k]);) ++end;
    if (end > k + 1)
      std::sort(order_.begin() + std::ptrdiff_t(k), order_.begin() + std::ptrdiff_t(end),
                [&](std::uint32_t a, std::uint32_t b) { return rest(a) < rest(b); });
  }
}

void FragmentsCpu::set_up(const View& view, const BrushPicture& brush) {
  const Camera& camera = view.camera();
  const Intrinsics k = camera.intrinsics();
  const bool orthographic = camera.orthographic();
  const double near = 1e-4 * camera.far_plane;
  near_ = float(near);
  const int width = view.width(), height = view.height();
  const glm::dvec2 whole_low = -glm::dvec2(camera.tile_origin());
  const glm::dvec2 whole_high = whole_low + glm::dvec2(camera.whole_width(), camera.whole_height());
  if (heads_.width() != width || heads_.height() != height) heads_ = Image<std::uint32_t>(width, height);
  quads_.assign(order_.size(), {});
  if (quads_.empty()) return;
  const float opacity = std::bit_cast<float>(records_[3].w);  // of all strokes
  const BrushPicture::Reach reach = brush.reach(seen_alpha / opacity);

  auto set_up_one = [&](Quad& quad, std::uint32_t stroke) {
    const glm::uvec4* record = &records_[stroke * record_texels];
    auto vector = [](const glm::uvec4& t) { return glm::uintBitsToFloat(glm::uvec3(t)); };
    const dvec3 center(vector(record[0])), along(vector(record[1])), across(vector(record[2]));
    const float lod = std::bit_cast<float>(record[2].w);
    quad.key = record[0].w;
    quad.stroke = stroke;
    quad.level = int(lod);
    quad.between_levels = lod - float(quad.level);
    quad.inset = 0.5f * std::exp2(std::ceil(lod)) / float(BrushPicture::tile_size);
    quad.opacity = opacity;
    quad.tile_x = int(record[1].w % BrushPicture::tiles);
    quad.tile_y = int(record[1].w / BrushPicture::tiles);
    const int coarse = std::min(quad.level + 1, BrushPicture::levels - 1);
    quad.reach = {std::max(reach.along[quad.level], reach.along[coarse]),
                  std::max(reach.across[quad.level], reach.across[coarse])};
    quad.depth = vec3(-center.z, -along.z, -across.z);

    dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
    for (int corner = 0; corner < 4; ++corner) {
      const dvec3 eye = center + (corner % 2 ? 1.0 : -1.0) * double(quad.reach.x) * along +
                        (corner / 2 ? 1.0 : -1.0) * double(quad.reach.y) * across;
      const double scale = orthographic ? 1 : std::max(-eye.z, 1e-30);
      const dvec3 at(k.fx * eye.x / scale + k.cx, -k.fy * eye.y / scale + k.cy, -eye.z);
      low = glm::min(low, at), high = glm::max(high, at);
    }
    quad.too_near = low.z < near;
    if (high.z < near) return;
    if (quad.too_near && !orthographic) low = dvec3(whole_low, 0), high = dvec3(whole_high, 0);
    const glm::dvec2 size(width, height);
    quad.x0 = int(std::clamp(std::floor(low.x), 0.0, size.x)),
    quad.y0 = int(std::clamp(std::floor(low.y), 0.0, size.y));
    quad.x1 = int(std::clamp(std::ceil(high.x), 0.0, size.x)) - 1;
    quad.y1 = int(std::clamp(std::ceil(high.y), 0.0, size.y)) - 1;
    if (quad.y1 < quad.y0) quad.x1 = quad.x0 - 1;
    if (quad.x1 < quad.x0) return;
    const glm::dvec2 base = glm::clamp(glm::floor(glm::dvec2(low)), whole_low, whole_high);
    quad.base_x = int(base.x), quad.base_y = int(base.y);

    // The ray of a pixel is origin + depth * slope, both linear in the pixel; it meets the plane where
    // depth = n . (center - origin) / n . slope, at u = (origin + depth * slope - center) . along /
    // |along|^2.
    const dvec3 n = glm::cross(along, across);
    const dvec3 columns[3] = {{1 / k.fx, 0, 0},
                              {0, -1 / k.fy, 0},
                              {(quad.base_x + 0.5 - k.cx) / k.fx, (k.cy - quad.base_y - 0.5) / k.fy, 0}};
    const double plane = glm::dot(n, center), sign = orthographic ? (n.z > 0 ? -1 : 1) : (plane < 0 ? -1 : 1);
    for (int c = 0; c < 3; ++c) {
      const double one = c == 2;
      const dvec3 origin = orthographic ? columns[c] : dvec3(0);
      const dvec3 slope = orthographic ? dvec3(0, 0, -one) : columns[c] + dvec3(0, 0, -one);
      // Times n . slope, which is a constant without perspective.
      const double w = orthographic ? -n.z * one : glm::dot(n, slope);
      const dvec3 offset =
          orthographic ? -n.z * (origin - one * center) - glm::dot(n, origin - one * center) * dvec3(0, 0, -1)
                       : plane * slope - w * center;
      quad.u[c] = float(sign * glm::dot(offset, along) / glm::dot(along, along));
      quad.v[c] = float(sign * glm::dot(offset, across) / glm::dot(across, across));
      quad.w[c] = float(sign * w);
    }
  };
  const Progress& progress = gl::lent_progress();
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, order_.size(), 2048), [&](const auto& range) {
    progress.check();
    for (std::size_t i = range.begin(); i < range.end(); ++i) set_up_one(quads_[i], order_[i]);
  });
}

std::uint64_t FragmentsCpu::list(int first_row, int last_row, glm::uvec4* fragments, std::uint64_t room) {
  std::fill(heads_.begin(), heads_.end(), no_fragment);
  row_counts_.assign(std::size_t(heads_.height()), 0);
  Pages pages{fragments, room / page};
  gl::end_stretch();
  const Progress& progress = gl::lent_progress();
  tbb::parallel_for(std::uint32_t(0), std::uint32_t(starts_.size()) - 1, [&](std::uint32_t strip) {
    progress.check();
    list_strip(strip, first_row, last_row, pages);
  });
  return pages.found;
}

void FragmentsCpu::list_strip(std::uint32_t strip, int first_row, int last_row, Pages& pages) {
  const int width = heads_.width(), top = std::max(int(strip) * strip_rows, first_row);
  const int bottom = std::min({int(strip + 1) * strip_rows, last_row, heads_.height()}) - 1;
  if (bottom < top) return;
  const std::size_t words = std::size_t(width + 63) / 64;
  std::vector<std::uint64_t> closed(words * strip_rows);  // pixels that have their opaque fragment
  std::vector<std::uint32_t> lasts(std::size_t(width) * strip_rows, no_fragment);
  std::uint64_t place = 0, page_end = 0;

  for (std::uint32_t e = starts_[strip]; e < starts_[strip + 1]; ++e) {
    const Quad& quad = quads_[entries_[e]];
    for (int y = std::max(quad.y0, top); y <= std::min(quad.y1, bottom); ++y) {
      const float down = float(y - quad.base_y);
      const float row_u = quad.u.y * down + quad.u.z, row_v = quad.v.y * down + quad.v.z;
      const float row_w = quad.w.y * down + quad.w.z;
      // |u| <= reach w and |v| <= reach w: four half lines.
      float from = float(quad.x0 - quad.base_x), to = float(quad.x1 - quad.base_x);
      auto keep_below = [&](float slope, float at_zero) {
        if (slope > 0)
          to = std::min(to, -at_zero / slope);
        else if (slope < 0)
          from = std::max(from, -at_zero / slope);
        else if (at_zero > 0)
          to = -1;
      };
      keep_below(quad.u.x - quad.reach.x * quad.w.x, row_u - quad.reach.x * row_w);
      keep_below(-quad.u.x - quad.reach.x * quad.w.x, -row_u - quad.reach.x * row_w);
      keep_below(quad.v.x - quad.reach.y * quad.w.x, row_v - quad.reach.y * row_w);
      keep_below(-quad.v.x - quad.reach.y * quad.w.x, -row_v - quad.reach.y * row_w);
      if (!(from <= to)) continue;
      const int left = quad.base_x + int(std::ceil(from)), right = quad.base_x + int(to);
      const std::size_t row = std::size_t(y - top);
      for (int word = left >> 6; word <= right >> 6; ++word) {
        std::uint64_t open = ~closed[row * words + std::size_t(word)];
        if (left > word * 64) open &= ~std::uint64_t(0) << (left & 63);
        if (right < word * 64 + 63) open &= ~std::uint64_t(0) >> (63 - (right & 63));
        for (; open; open &= open - 1) {
          const int x = word * 64 + std::countr_zero(open);
          const float step = float(x - quad.base_x), w = quad.w.x * step + row_w;
          if (!(w > 0)) continue;
          const vec2 at = vec2(quad.u.x * step + row_u, quad.v.x * step + row_v) / w;
          if (quad.too_near && !(quad.depth.x + at.x * quad.depth.y + at.y * quad.depth.z >= near_)) continue;
          const vec2 inside = glm::clamp(0.5f + 0.5f * at, quad.inset, 1 - quad.inset);
          Four paint = sample(brush_->level(quad.level), quad.tile_x, quad.tile_y, inside);
          if (quad.between_levels > 0)
            paint += quad.between_levels *
                     (sample(brush_->level(quad.level + 1), quad.tile_x, quad.tile_y, inside) - paint);
          const float alpha = paint[0] * quad.opacity;
          if (!(alpha >= seen_alpha)) continue;
          ++row_counts_[std::size_t(y)];
          if (alpha >= opaque_alpha) closed[row * words + std::size_t(word)] |= open & -open;
          if (place == page_end) {
            const std::uint64_t taken = pages.taken++;
            if (taken >= pages.count) continue;  // counted all the same
            place = taken * page, page_end = place + page;
          }
          pages.fragments[place] = {quad.key, quad.stroke, pack_paint(alpha, paint[2], paint[3]),
                                    no_fragment};
          std::uint32_t& last = lasts[row * std::size_t(width) + std::size_t(x)];
          (last == no_fragment ? heads_.at(x, y) : pages.fragments[last].w) = std::uint32_t(place);
          last = std::uint32_t(place++);
        }
      }
    }
  }
  std::uint64_t found = 0;
  for (int y = top; y <= bottom; ++y) found += row_counts_[std::size_t(y)];
  pages.found += found;
}

}  // namespace sfumato::strokes
