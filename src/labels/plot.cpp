#include "labels/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "labels/legend.h"
#include "labels/text.h"

namespace sfumato::labels {

Image<Rgba8> draw_plot(std::span<const PlotPoint> points, const PlotLook& look, int width, int height) {
  width = std::max(width, 160), height = std::max(height, 120);
  const Rgba8 ground{255, 255, 255, 255}, ink{35, 38, 42, 255}, faint{224, 226, 228, 255};
  Image<Rgba8> image(width, height, ground);
  const Text text(std::clamp(height / 24, 12, 28));
  const int em = text.size();

  double low_y = 0, high_y = 1;
  if (!points.empty()) {
    const auto [low, high] = std::minmax_element(
        points.begin(), points.end(), [](const PlotPoint& a, const PlotPoint& b) { return a.y < b.y; });
    low_y = low->y, high_y = high->y;
  }
  const double span_x = std::max(look.high_x - look.low_x, 1e-12);
  double span_y = std::max(high_y - low_y, 1e-9 * span_x);
  const int top = 2 * em, bottom = height - 5 * em / 2;
  int decimals_y = 0;
  std::vector<double> ticks_y =
      nice_ticks(low_y, low_y + span_y, std::max(2, (bottom - top) / (3 * em)), decimals_y);
  int label_width = 0;
  for (const double tick : ticks_y)
    label_width = std::max(label_width, text.width(fmt::format("{:.{}f}", tick, decimals_y)));
  const int left = label_width + em;
  int right = width - em;
  double px_x = (right - left) / span_x, px_y = (bottom - top) / (1.04 * span_y);
  if (look.equal_scale) {
    const double both = std::min(px_x, px_y);
    if (both * span_y > 0.15 * (bottom - top)) px_x = px_y = both;
    right = std::min(right, std::max(left + int(std::ceil(span_x * px_x)), left + 12 * em));
  }
  const double middle_y = 0.5 * (low_y + high_y);
  const double half_y = 0.5 * (bottom - top) / px_y;
  ticks_y =
      nice_ticks(middle_y - half_y, middle_y + half_y, std::max(2, (bottom - top) / (3 * em)), decimals_y);
  const auto place_x = [&](double x) { return left + int(std::lround((x - look.low_x) * px_x)); };
  const auto place_y = [&](double y) {
    return int(std::lround(0.5 * (top + bottom) - (y - middle_y) * px_y));
  };

  int decimals_x = 0;
  const double end_x = look.low_x + (right - left) / px_x;
  for (const double tick :
       nice_ticks(look.low_x, end_x, std::max(2, (right - left) / (6 * em)), decimals_x)) {
    const std::string label = fmt::format("{:.{}f}", tick, decimals_x);
    fill(image, place_x(tick), top, 1, bottom - top, faint);
    const int x = std::min(place_x(tick) - text.width(label) / 2, width - text.width(label) - 2);
    text.draw(image, x, bottom + em * 5 / 4, label, ink);
  }
  for (const double tick : ticks_y) {
    const std::string label = fmt::format("{:.{}f}", tick, decimals_y);
    fill(image, left, place_y(tick), right - left, 1, faint);
    text.draw(image, left - em / 2 - text.width(label), place_y(tick) + em * 3 / 8, label, ink);
  }
  const int dot = points.size() < 20'000 ? 2 : 1;
  for (const PlotPoint& each : points) {
    const int x = place_x(each.x), y = place_y(each.y);
    if (x >= left && x <= right && y >= top && y <= bottom) fill(image, x, y, dot, dot, each.color);
  }
  fill(image, left, top, 1, bottom - top, ink);
  fill(image, left, bottom, right - left, 1, ink);
  text.draw(image, left, em * 5 / 4, look.title, ink);
  text.draw(image, right - text.width(look.x_label), bottom + em * 9 / 4, look.x_label, ink);
  text.draw(image, 4, em * 5 / 4, look.y_label, ink);
  return image;
}

}  // namespace sfumato::labels
