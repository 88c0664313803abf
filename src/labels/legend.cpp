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

/// Shorter than the ticks' decimals plus one where the last digit is 0.
std::string end_text(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, decimals + 1);
  if (text.back() == '0') text = fmt::format("{:.{}f}", value, decimals);
  return text;
}

void draw_bar(const Sheet& sheet, const Coloring& coloring, const vec3& background, const LegendLook& look,
              const Text& text, const Margins& margins) {
  const int em = text.size(), bar_width = std::max(4, em),
            bar_height = std::max(6 * em, int(std::lround(sheet.height * 0.35 * look.size)));
  int decimals = 0;
  const std::vector<double> ticks = legend_ticks(coloring.low, coloring.high, decimals);
  const bool has_range = coloring.high != coloring.low;
  const auto row_of = [&](double value) {
    const double share = has_range ? (value - coloring.low) / (coloring.high - coloring.low) : 0.5;
    return int(std::lround((1 - share) * (bar_height - 1)));
  };
  // The ends are values of their own; a round number too near to one of them would be written over it.
  std::vector<std::pair<int, std::string>> rows;
  if (has_range)
    for (const double end : {coloring.high, coloring.low})
      rows.emplace_back(row_of(end), end_text(end, decimals));
  const std::size_t ends = rows.size();
  for (const double tick : ticks) {
    const int row = row_of(tick);
    if (std::all_of(rows.begin(), rows.begin() + std::ptrdiff_t(ends),
                    [&](const auto& end) { return std::abs(end.first - row) > em; }))
      rows.emplace_back(row, fmt::format("{:.{}f}", tick, decimals));
  }
  std::string title = look.title.empty() ? title_of(coloring.source) : look.title;
  if (!look.unit.empty()) title += " (" + look.unit + ")";
  int label_width = 0;
  for (const auto& [row, label] : rows) label_width = std::max(label_width, text.width(label));
  const int content_width = std::max(text.width(title), bar_width + em + label_width);
  const Plate panel(sheet, look.corner, margins, content_width, bar_height + 2 * em, em * 2 / 3);
  panel.draw(sheet, background);

  const Rgba8 ink = ink_on(background);
  const int left = panel.x + panel.pad, top = panel.y + panel.pad + 2 * em - em / 2;
  sheet.write(text, left, panel.y + panel.pad + em * 3 / 4, title, ink);
  const Colormap map = coloring.ramp();
  for (int row = 0; row < bar_height; ++row)
    sheet.fill(left, top + row, bar_width, 1, map.at(1 - (row + 0.5) / bar_height));
  for (const auto& [row, label] : rows) {
    const int y = top + row;
    sheet.fill(left + bar_width, y, std::max(2, em / 3), std::max(1, em / 16), ink);
    sheet.write(text, left + bar_width + em * 2 / 3, y + em * 3 / 8, label, ink);
  }
}

void draw_swatches(const Sheet& sheet, const Coloring& coloring, const vec3& background,
                   const LegendLook& look, const Text& text, const Margins& margins) {
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
  const int title_lines = look.title.empty() ? 0 : 1;
  const Plate panel(sheet, look.corner, margins,
                    std::max(line + label_width, title_lines ? text.width(look.title) : 0),
                    line * (int(shown.size()) + title_lines), em * 2 / 3);
  panel.draw(sheet, background);
  const Rgba8 ink = ink_on(background);
  int y = panel.y + panel.pad;
  if (title_lines)
    sheet.write(text, panel.x + panel.pad, y + (line - em) / 2 + em * 7 / 8, look.title, ink), y += line;
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

std::vector<double> legend_ticks(double low, double high, int& decimals) {
  if (low > high) std::swap(low, high);
  decimals = 3;
  if (!(high > low)) return {low};
  // The roundest first: with these factors there is always one that gives four to six numbers.
  const double power = std::pow(10.0, std::floor(std::log10(high - low)));
  for (const double factor : {1.0, 2.0, 5.0, 2.5, 4.0, 3.0, 1.5, 6.0, 8.0})
    for (const double scale : {power, power / 10}) {
      const double step = factor * scale, first = std::ceil(low / step - 1e-9),
                   last = std::floor(high / step + 1e-9);
      if (last - first < 3 || last - first > 5) continue;
      decimals = 0;
      for (double whole = step; decimals < 12 && std::abs(whole - std::round(whole)) > 1e-6 * whole;
           whole *= 10)
        ++decimals;
      std::vector<double> ticks;
      for (double k = first; k <= last; ++k) ticks.push_back(k == 0 ? 0 : k * step);
      return ticks;
    }
  return nice_ticks(low, high, 5, decimals);
}

void draw_legend(const Sheet& sheet, const Coloring& coloring, const vec3& background, const LegendLook& look,
                 int em, const Margins& margins) {
  if (coloring.kind != ColorKind::scalar && coloring.swatches.empty()) return;
  const Text text(std::clamp(int(std::lround(em * look.size)), 6, 256));
  if (coloring.kind == ColorKind::scalar)
    draw_bar(sheet, coloring, background, look, text, margins);
  else
    draw_swatches(sheet, coloring, background, look, text, margins);
}

}  // namespace sfumato::labels
