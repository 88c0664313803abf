#include "labels/legend.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/colormap.h"
#include "labels/text.h"

namespace sfumato::labels {
namespace {

std::string title_of(const std::string& source) {
  std::string title = source;
  std::replace(title.begin(), title.end(), '_', ' ');
  return title;
}

/// Some rows of a picture.
struct Sheet {
  Image<Rgba8>& rows;
  int first_row, height;  ///< the first of them in the picture, and the height of that
  int width() const { return rows.width(); }
  void fill(int x, int y, int w, int h, Rgba8 color, int coverage = 255) const {
    labels::fill(rows, x, y - first_row, w, h, color, coverage);
  }
  void write(const Text& text, int x, int y, std::string_view words, Rgba8 ink) const {
    text.draw(rows, x, y - first_row, words, ink);
  }
};

struct Panel {
  int x, y, width, height, pad;
  Panel(const Sheet& sheet, int content_width, int content_height, int pad_px)
      : width(content_width + 2 * pad_px), height(content_height + 2 * pad_px), pad(pad_px) {
    x = sheet.width() - width - pad;
    y = sheet.height - height - pad;
  }
  void draw(const Sheet& sheet, const vec3& background) const {
    const vec3 c = background * 255.0f + 0.5f;
    sheet.fill(x, y, width, height, {std::uint8_t(c.x), std::uint8_t(c.y), std::uint8_t(c.z), 255}, 210);
  }
};

void draw_bar(const Sheet& sheet, const Coloring& coloring, const vec3& background, const Text& text) {
  const int em = text.size(), bar_width = std::max(4, em),
            bar_height = std::max(3 * em, sheet.height * 35 / 100);
  int decimals = 0;
  std::vector<double> ticks =
      nice_ticks(coloring.low, coloring.high, std::max(2, bar_height / (3 * em)), decimals);
  const std::string title = title_of(coloring.source);
  int label_width = 0;
  for (double tick : ticks)
    label_width = std::max(label_width, text.width(fmt::format("{:.{}f}", tick, decimals)));
  const int content_width = std::max(text.width(title), bar_width + em + label_width);
  const Panel panel(sheet, content_width, bar_height + 2 * em, em * 2 / 3);
  panel.draw(sheet, background);

  const Rgba8 ink = ink_on(background);
  const int left = panel.x + panel.pad, top = panel.y + panel.pad + 2 * em - em / 2;
  sheet.write(text, left, panel.y + panel.pad + em * 3 / 4, title, ink);
  const Colormap map = Colormap::named(coloring.colormap);
  for (int row = 0; row < bar_height; ++row)
    sheet.fill(left, top + row, bar_width, 1, map.at(1 - (row + 0.5) / bar_height));
  for (double tick : ticks) {
    const double share =
        coloring.high != coloring.low ? (tick - coloring.low) / (coloring.high - coloring.low) : 0.5;
    const int y = top + int(std::lround((1 - share) * (bar_height - 1)));
    sheet.fill(left + bar_width, y, std::max(2, em / 3), std::max(1, em / 16), ink);
    sheet.write(text, left + bar_width + em * 2 / 3, y + em * 3 / 8, fmt::format("{:.{}f}", tick, decimals),
                ink);
  }
}

void draw_swatches(const Sheet& sheet, const Coloring& coloring, const vec3& background, const Text& text) {
  const int em = text.size(), line = em * 3 / 2;
  std::vector<std::size_t> shown(coloring.swatches.size());
  std::iota(shown.begin(), shown.end(), 0u);
  const std::size_t room = std::size_t(std::max(1, (sheet.height * 8 / 10) / line));
  if (shown.size() > room) {  // those with most points, in their own order
    std::stable_sort(shown.begin(), shown.end(), [&](std::size_t a, std::size_t b) {
      return coloring.swatches[a].points > coloring.swatches[b].points;
    });
    shown.resize(room);
    std::sort(shown.begin(), shown.end());
  }
  // A long file name loses its middle, not the picture its right half.
  const auto label_of = [&](const Swatch& swatch) {
    std::string label = swatch.label;
    while (label.size() > 12 && text.width(label) > sheet.width() / 2)
      label = label.substr(0, label.size() / 2 - 2) + "…" + label.substr(label.size() / 2 + 2);
    return label;
  };
  int label_width = 0;
  for (std::size_t i : shown) label_width = std::max(label_width, text.width(label_of(coloring.swatches[i])));
  const Panel panel(sheet, line + label_width, line * int(shown.size()), em * 2 / 3);
  panel.draw(sheet, background);
  const Rgba8 ink = ink_on(background);
  int y = panel.y + panel.pad;
  for (std::size_t i : shown) {
    const Swatch& swatch = coloring.swatches[i];
    sheet.fill(panel.x + panel.pad, y + (line - em) / 2, em, em, swatch.color);
    sheet.write(text, panel.x + panel.pad + line, y + (line - em) / 2 + em * 7 / 8, label_of(swatch), ink);
    y += line;
  }
}

}  // namespace

std::vector<double> nice_ticks(double low, double high, int count, int& decimals) {
  if (low > high) std::swap(low, high);
  decimals = 3;
  if (!(high > low)) return {low};
  const double raw = (high - low) / count, power = std::pow(10.0, std::floor(std::log10(raw)));
  double step = 10 * power;
  for (double factor : {5.0, 2.0, 1.0})
    if (factor * power >= raw) step = factor * power;
  decimals = std::clamp(-int(std::floor(std::log10(step) + 1e-9)), 0, 9);
  std::vector<double> ticks;
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k)
    ticks.push_back(k == 0 ? 0 : k * step);
  return ticks;
}

void draw_legend(Image<Rgba8>& image, const Coloring& coloring, const vec3& background) {
  draw_legend(image, 0, image.height(), coloring, background);
}

void draw_legend(Image<Rgba8>& rows, int first_row, int height, const Coloring& coloring,
                 const vec3& background) {
  if (coloring.kind != ColorKind::scalar && coloring.swatches.empty()) return;
  const Text text(std::clamp(height / 42, 9, 64));
  const Sheet sheet{rows, first_row, height};
  if (coloring.kind == ColorKind::scalar)
    draw_bar(sheet, coloring, background, text);
  else
    draw_swatches(sheet, coloring, background, text);
}

}  // namespace sfumato::labels
