#include "labels/sheet.h"

#include <algorithm>
#include <cmath>

namespace sfumato::labels {

void Sheet::polygon(std::span<const glm::dvec2> corners, Rgba8 color, int coverage) const {
  if (corners.size() < 3) return;
  glm::dvec2 low = corners[0], high = corners[0];
  double area = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec2 a = corners[i], b = corners[(i + 1) % corners.size()];
    low = glm::min(low, a), high = glm::max(high, a);
    area += a.x * b.y - b.x * a.y;
  }
  const auto holds = [&](glm::dvec2 p) {
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const glm::dvec2 a = corners[i], b = corners[(i + 1) % corners.size()];
      if (((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x)) * area < 0) return false;
    }
    return true;
  };
  const int left = std::max(0, int(std::floor(low.x))), right = std::min(width(), int(std::ceil(high.x)));
  const int top = std::max(first_row, int(std::floor(low.y))),
            bottom = std::min(first_row + rows.height(), int(std::ceil(high.y)));
  constexpr int steps = 4;
  for (int y = top; y < bottom; ++y)
    for (int x = left; x < right; ++x) {
      int inside = 0;
      for (int k = 0; k < steps * steps; ++k)
        inside += holds({x + (k % steps + 0.5) / steps, y + (k / steps + 0.5) / steps});
      if (inside > 0) blend(rows.at(x, y - first_row), color, coverage * inside / (steps * steps));
    }
}

void Sheet::line(glm::dvec2 from, glm::dvec2 to, double width_px, Rgba8 color, int coverage) const {
  const double length = glm::length(to - from);
  if (!(length > 0)) return;
  const glm::dvec2 along = (to - from) / length, across = glm::dvec2(-along.y, along.x) * (0.5 * width_px);
  const std::array<glm::dvec2, 4> corners{from + across, to + across, to - across, from - across};
  polygon(corners, color, coverage);
}

Plate::Plate(const Sheet& sheet, Corner corner, const Margins& margins, int content_width, int content_height,
             int pad_px)
    : width(content_width + 2 * pad_px), height(content_height + 2 * pad_px), pad(pad_px) {
  const bool left = corner == Corner::top_left || corner == Corner::bottom_left;
  const bool top = corner == Corner::top_left || corner == Corner::top_right;
  x = left ? pad : sheet.width() - width - pad;
  y = top ? margins.top + pad : sheet.height - margins.bottom - height - pad;
}

void Plate::draw(const Sheet& sheet, const vec3& background) const {
  const vec3 c = background * 255.0f + 0.5f;
  sheet.fill(x, y, width, height, {std::uint8_t(c.x), std::uint8_t(c.y), std::uint8_t(c.z), 255}, 210);
}

}  // namespace sfumato::labels
