#include "techniques/soft/express_cpu.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include <glm/gtc/packing.hpp>

#include "gl/commands.h"
#include "gl/pace.h"

namespace sfumato::soft {
namespace {

/// Rows of pixels that stay in a core's cache while all spheres of the band are blended.
constexpr std::uint32_t band_rows = 16;

/// (1 + cos(pi delta)) / 2 = cos^2(pi delta / 2) of the squared delta <= 1: the series up to the term below
/// 1e-8.
float cosine_falloff(float delta2) {
  constexpr double x2 = std::numbers::pi * std::numbers::pi / 4;
  constexpr float c1 = float(-x2 / 2), c2 = float(x2 * x2 / 24), c3 = float(-x2 * x2 * x2 / 720);
  constexpr float c4 = float(x2 * x2 * x2 * x2 / 40320), c5 = float(-x2 * x2 * x2 * x2 * x2 / 3628800);
  constexpr float c6 = float(x2 * x2 * x2 * x2 * x2 * x2 / 479001600);
  const float u = delta2;
  const float root = 1 + u * (c1 + u * (c2 + u * (c3 + u * (c4 + u * (c5 + u * c6)))));
  return root * root;
}

}  // namespace

void ExpressCpu::list_bands(const Order& order, std::uint32_t rows) {
  const std::uint32_t bands = (rows + band_rows - 1) / band_rows;
  starts_.assign(bands + 1, 0);
  for (const Box& box : boxes_)
    if (box.y >= box.x)
      for (std::uint32_t b = (box.x >> 16) / band_rows; b <= (box.y >> 16) / band_rows; ++b) ++starts_[b + 1];
  for (std::uint32_t b = 0; b < bands; ++b) starts_[b + 1] += starts_[b];
  entries_.resize(starts_[bands]);
  std::vector<std::uint32_t> ends(starts_.begin(), starts_.end() - 1);
  for (std::uint32_t k = 0; k < order.count; ++k) {
    const std::uint32_t slot = slots_[std::size_t(order.first + order.step * std::int64_t(k))];
    const Box box = boxes_[slot];
    if (box.y >= box.x)
      for (std::uint32_t b = (box.x >> 16) / band_rows; b <= (box.y >> 16) / band_rows; ++b)
        entries_[ends[b]++] = slot;
  }
}

void ExpressCpu::blend_band(std::uint32_t band, const View& view, const Image<float>& solid_t,
                            Image<vec4>& color) const {
  const Camera& camera = view.camera();
  const bool orthographic = camera.orthographic();
  const Intrinsics k = camera.intrinsics();
  const int width = view.width(), first_row = int(band * band_rows);
  const int last_row = std::min(first_row + int(band_rows), view.height()) - 1;
  const float near = float(1e-4 * camera.far_plane);

  // Of every ray, per unit of eye depth: slope, 1 / length^2, and the depth of the solid surface.
  std::vector<float> slope_x(static_cast<std::size_t>(width)), shorter(std::size_t(width) * band_rows),
      behind(shorter.size());
  for (int x = 0; x < width; ++x) slope_x[std::size_t(x)] = float((x + 0.5 - k.cx) / k.fx);
  for (int y = first_row; y <= last_row; ++y) {
    const float slope_y = float((k.cy - y - 0.5) / k.fy);
    for (int x = 0; x < width; ++x) {
      const std::size_t at = std::size_t(y - first_row) * std::size_t(width) + std::size_t(x);
      const float s = slope_x[std::size_t(x)];
      const float length2 = orthographic ? 1 : 1 + s * s + slope_y * slope_y;
      shorter[at] = 1 / length2;
      behind[at] = solid_t.at(x, y) / std::sqrt(length2);
    }
  }

  for (std::uint32_t e = starts_[band]; e < starts_[band + 1]; ++e) {
    const std::uint32_t slot = entries_[e];
    const vec4 shape = shapes_[slot];
    const glm::uvec4 look = looks_[slot];
    const vec2 rg = glm::unpackHalf2x16(look.x), b_share = glm::unpackHalf2x16(look.y);
    const float opacity = std::bit_cast<float>(look.z), share = b_share.y, depth = -shape.z;
    const float cone_opacity = float(look.w >> 16) / 65535;
    const vec4 paint(rg.x, rg.y, b_share.x, 1);
    const float inverse_radius2 = 1 / (shape.w * shape.w), scale = orthographic ? 1 : depth;
    const Box box = boxes_[slot];
    const int x0 = int(box.x & 0xffff), x1 = int(box.y & 0xffff);
    for (int y = std::max(int(box.x >> 16), first_row); y <= std::min(int(box.y >> 16), last_row); ++y) {
      const float sy = float((k.cy - y - 0.5) / k.fy), ay = sy * scale - shape.y;
      const float slant_y = orthographic ? 0 : ay * sy;
      const std::size_t row = std::size_t(y - first_row) * std::size_t(width);
      vec4* const pixels = &color.at(0, y);
      for (int x = x0; x <= x1; ++x) {
        // From the centre to the ray at the centre's depth, then along the ray to the place nearest to the
        // centre: that lies `closer` less deep (sphere.glsl, soft_ray).
        const float sx = slope_x[std::size_t(x)], ax = sx * scale - shape.x;
        const float slant = orthographic ? 0 : ax * sx + slant_y;
        const float closer = slant * shorter[row + std::size_t(x)];
        const float delta2 = (ax * ax + ay * ay - slant * closer) * inverse_radius2;
        const float middle = depth - closer;
        if (!(delta2 < 1) || middle > behind[row + std::size_t(x)] || middle < near) continue;
        float alpha = opacity * cosine_falloff(delta2);
        if (share < 1) {  // Eq. 22
          const float cone = cone_opacity * (1 - std::sqrt(std::max(delta2, 0.0f)));
          alpha = std::clamp(cone + share * (alpha - cone), 0.0f, 1.0f);
        }
        pixels[x] = alpha * paint + (1 - alpha) * pixels[x];
      }
    }
  }
}

void ExpressCpu::draw(const SoftPoints& points, const Order& order, const View& view,
                      const gl::Texture& solid_t, gl::Texture& color) {
  if (order.count == 0) return;
  gl::barrier(GL_BUFFER_UPDATE_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT);
  boxes_.resize(points.count());
  shapes_.resize(points.count());
  looks_.resize(points.count());
  slots_.resize(order.list->buffer().bytes() / sizeof(std::uint32_t));
  points.boxes().buffer().download(boxes_.data(), boxes_.size() * sizeof(Box));
  points.shapes().buffer().download(shapes_.data(), shapes_.size() * sizeof(vec4));
  points.looks().buffer().download(looks_.data(), looks_.size() * sizeof(glm::uvec4));
  order.list->buffer().download(slots_.data(), slots_.size() * sizeof(std::uint32_t));
  const Image<float>& solid = solid_t.peek<float>();
  Image<vec4> picture = color.take<vec4>();

  list_bands(order, std::uint32_t(view.height()));
  const std::uint32_t bands = std::uint32_t(starts_.size()) - 1;
  gl::end_stretch();
  const Progress& progress = gl::lent_progress();
  tbb::parallel_for(std::uint32_t(0), bands, [&](std::uint32_t band) {
    progress.check();
    if (starts_[band + 1] > starts_[band]) blend_band(band, view, solid, picture);
  });
  color.give(std::move(picture));
}

}  // namespace sfumato::soft
