#include "image_strokes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

#include "core/vec.h"

namespace sfumato::bench {
namespace {

Image<vec3> blurred(const Image<vec3>& picture, int radius) {
  const int w = picture.width(), h = picture.height();
  Image<vec3> once(w, h), twice(w, h);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      vec3 sum(0);
      for (int k = -radius; k <= radius; ++k) sum += picture.at(std::clamp(x + k, 0, w - 1), y);
      once.at(x, y) = sum / float(2 * radius + 1);
    }
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      vec3 sum(0);
      for (int k = -radius; k <= radius; ++k) sum += once.at(x, std::clamp(y + k, 0, h - 1));
      twice.at(x, y) = sum / float(2 * radius + 1);
    }
  return twice;
}

float luma(const vec3& c) { return glm::dot(c, vec3(0.299f, 0.587f, 0.114f)); }

}  // namespace

Image<Rgba8> paint_over(const Image<Rgba8>& picture, const ImageStrokes& s) {
  const int w = picture.width(), h = picture.height();
  Image<vec3> colors(w, h);
  for (std::size_t i = 0; i < picture.size(); ++i) {
    const Rgba8 c = picture.data()[i];
    colors.data()[i] = vec3(c.r, c.g, c.b);
  }
  const Image<vec3> soft = blurred(colors, std::max(1, int(s.width_px / 3)));
  const Image<vec3> smooth = blurred(soft, std::max(1, int(s.width_px / 2)));
  auto at = [&](const Image<vec3>& image, float x, float y) {
    return image.at(std::clamp(int(x), 0, w - 1), std::clamp(int(y), 0, h - 1));
  };

  const float step = 0.5f * s.width_px;
  const int columns = int(std::ceil(float(w) / step)), rows = int(std::ceil(float(h) / step));
  std::vector<int> order(std::size_t(columns) * std::size_t(rows));
  std::iota(order.begin(), order.end(), 0);
  std::mt19937 random(1);
  std::shuffle(order.begin(), order.end(), random);
  std::vector<vec3> noise(order.size());
  std::uniform_real_distribution<float> uniform(-0.5f, 0.5f);
  for (vec3& n : noise) n = vec3(uniform(random), uniform(random), uniform(random));

  Image<vec3> canvas = smooth;
  for (int cell : order) {
    const vec3 n = noise[std::size_t(cell)];
    const float x = (float(cell % columns) + 0.5f + n.x) * step,
                y = (float(cell / columns) + 0.5f + n.y) * step;
    const vec3 color = at(soft, x, y);
    const float gx = luma(at(smooth, x + 2, y)) - luma(at(smooth, x - 2, y));
    const float gy = luma(at(smooth, x, y + 2)) - luma(at(smooth, x, y - 2));
    // Along the edge; where there is none, all one way.
    float angle = gx * gx + gy * gy > 4 ? std::atan2(gx, -gy) : std::numbers::pi_v<float> / 4;
    angle += 2 * n.z * s.noise_deg * std::numbers::pi_v<float> / 180;
    const vec2 along(std::cos(angle), std::sin(angle));
    float reach[2] = {0, 0};
    for (int side = 0; side < 2; ++side)
      for (float& r = reach[side]; r < 0.5f * s.length_px; r += 1) {
        const vec2 p = vec2(x, y) + (side ? r : -r) * along;
        if (glm::distance(at(soft, p.x, p.y), color) > s.colour_limit) break;
      }
    const float half = 0.5f * s.width_px;
    const int r = int(std::ceil(0.5f * s.length_px + half));
    for (int py = std::max(0, int(y) - r); py <= std::min(h - 1, int(y) + r); ++py)
      for (int px = std::max(0, int(x) - r); px <= std::min(w - 1, int(x) + r); ++px) {
        const vec2 d = vec2(px, py) + 0.5f - vec2(x, y);
        const float u = glm::dot(d, along), beyond = std::max({0.0f, u - reach[1], -u - reach[0]});
        const float v = along.x * d.y - along.y * d.x;
        const float alpha = std::clamp(half + 0.5f - std::hypot(beyond, v), 0.0f, 1.0f);
        if (alpha > 0) canvas.at(px, py) = glm::mix(canvas.at(px, py), color, alpha);
      }
  }
  Image<Rgba8> out(w, h);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const vec3 c = canvas.data()[i] + 0.5f;
    out.data()[i] = {std::uint8_t(c.x), std::uint8_t(c.y), std::uint8_t(c.z), 255};
  }
  return out;
}

}  // namespace sfumato::bench
