#include "labels/furniture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace sfumato::labels {
namespace {

/// Map north, and where it is in the picture: right and up, each of a unit direction of the scene.
glm::dvec2 north_in(const Camera& camera, UpAxis up) {
  const dvec3 axis = up_vector(up);
  const dvec3 north = std::abs(axis.z) > 0.5   ? dvec3(0, 1, 0)
                      : std::abs(axis.y) > 0.5 ? dvec3(0, 0, -1)
                                               : dvec3(0, 1, 0);
  const dmat4 to_eye = camera.view();
  const dvec3 seen(to_eye * glm::dvec4(north, 0));
  return {seen.x, seen.y};
}

/// 1, 2 or 5 times a power of ten, at most `most`.
double round_length(double most) {
  const double power = std::pow(10.0, std::floor(std::log10(most)));
  for (const double factor : {5.0, 2.0})
    if (factor * power <= most) return factor * power;
  return power;
}

std::string number(double value) {
  std::string text = fmt::format("{:.6f}", value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

/// Lines of a text that fit into a width.
std::vector<std::string> wrapped(const Text& text, const std::string& words, int width) {
  std::vector<std::string> lines(1);
  for (std::size_t at = 0; at < words.size();) {
    std::size_t end = words.find_first_of(" \n", at);
    if (end == std::string::npos) end = words.size();
    const std::string word = words.substr(at, end - at);
    const std::string longer = lines.back().empty() ? word : lines.back() + " " + word;
    if (!lines.back().empty() && text.width(longer) > width)
      lines.push_back(word);
    else
      lines.back() = longer;
    if (end < words.size() && words[end] == '\n') lines.emplace_back();
    at = end + 1;
  }
  return lines;
}

class Drawing {
 public:
  Drawing(const Sheet& sheet, const Furniture& furniture, const Seen& seen)
      : sheet_(sheet),
        furniture_(furniture),
        seen_(seen),
        em_(furniture.dpi > 0
                ? std::clamp(int(std::lround(furniture.dpi * 8 / 72)), 6, std::max(9, sheet.height / 24))
                : std::clamp(sheet.height / 42, 9, 64)),
        text_(em_),
        ink_(ink_on(seen.background)),
        pixels_per_unit_(seen.camera.pixels_per_unit()) {}

  void draw() {
    if (furniture_.grid) lines();
    if (!furniture_.title.empty()) margins_.top = band(furniture_.title, true);
    if (!furniture_.caption.empty()) margins_.bottom = band(furniture_.caption, false);
    const bool bar_is_left =
        furniture_.scale_bar && !(furniture_.legend && furniture_.legend_look.corner == Corner::bottom_left);
    if (furniture_.grid) coordinates(bar_is_left ? 5 * em_ : 0);
    const Corner legend = furniture_.legend_look.corner;
    const bool has_legend = furniture_.legend;
    if (furniture_.scale_bar)
      bar(has_legend && legend == Corner::bottom_left ? Corner::bottom_right : Corner::bottom_left);
    if (furniture_.north_arrow)
      arrow(has_legend && legend == Corner::top_right ? Corner::top_left : Corner::top_right);
    if (!has_legend) return;
    LegendLook look = furniture_.legend_look;
    if (look.unit.empty() && seen_.coloring.source == "elevation")
      look.unit =
          furniture_.unit.empty() ? vertical_unit(seen_.crs).symbol : unit_named(furniture_.unit).symbol;
    if (look.unit == "units") look.unit.clear();
    draw_legend(sheet_, seen_.coloring, seen_.background, look, em_, margins_);
  }

 private:
  /// Words over the whole width, at the top or the bottom; returns the height they take.
  int band(const std::string& words, bool is_title) {
    const Text text(is_title ? em_ * 3 / 2 : em_);
    const int size = text.size(), line = size * 5 / 4, pad = em_ / 2;
    const std::vector<std::string> rows = wrapped(text, words, sheet_.width() - 2 * pad);
    const int height = line * int(rows.size()) + 2 * pad;
    const int top = is_title ? 0 : sheet_.height - height;
    const vec3 c = seen_.background * 255.0f + 0.5f;
    sheet_.fill(0, top, sheet_.width(), height,
                {std::uint8_t(c.x), std::uint8_t(c.y), std::uint8_t(c.z), 255}, 210);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const int x = is_title ? (sheet_.width() - text.width(rows[i])) / 2 : pad;
      sheet_.write(text, x, top + pad + int(i) * line + size, rows[i], ink_);
    }
    return height;
  }

  LengthUnit unit() const {
    return furniture_.unit.empty() ? horizontal_unit(seen_.crs) : unit_named(furniture_.unit);
  }

  void bar(Corner corner) {
    double length = round_length(0.25 * sheet_.width() / pixels_per_unit_);
    // Metres and kilometres, so that numbers stay short.
    std::string symbol = unit().symbol;
    double shown = length;
    if (symbol == "m" && length >= 1000) symbol = "km", shown = length / 1000;
    if (symbol == "m" && length < 0.01)
      symbol = "mm", shown = length * 1000;
    else if (symbol == "m" && length < 1)
      symbol = "cm", shown = length * 100;
    std::string end = number(shown) + " " + symbol;
    // Of an unknown unit the ratio may be wrong, the bar is not.
    const bool is_known = furniture_.print_scale > 0 && unit().metres > 0;
    std::vector<std::string> above;
    if (is_known) above.push_back("1 : " + number(furniture_.print_scale));
    // Seen from straight above, heights have no length in the picture.
    if (seen_.vertical_exaggeration != 1 && !is_plan(seen_.camera, seen_.up))
      above.push_back("vertical exaggeration " + number(seen_.vertical_exaggeration) + "x");
    const int width = int(std::lround(length * pixels_per_unit_)), thick = std::max(3, em_ / 3);
    const int before = text_.width("0") / 2, after = text_.width(end) / 2;
    const int line = em_ * 5 / 4, lines_above = int(above.size()) * line;
    int over = 0;  // of the words above, on each side of the bar
    for (const std::string& each : above) over = std::max(over, (text_.width(each) - width + 1) / 2);
    const int to_left = std::max(before, over), to_right = std::max(after, over);
    const Plate plate(sheet_, corner, margins_, to_left + width + to_right, lines_above + thick + line,
                      em_ * 2 / 3);
    plate.draw(sheet_, seen_.background);
    const int left = plate.x + plate.pad + to_left, top = plate.y + plate.pad + lines_above;
    for (std::size_t i = 0; i < above.size(); ++i)
      sheet_.write(text_, left + (width - text_.width(above[i])) / 2,
                   plate.y + plate.pad + int(i) * line + em_ * 3 / 4, above[i], ink_);
    // Full ink along its whole length, so that it can be measured; the fields are cut out of its middle.
    sheet_.fill(left, top, width, thick, ink_);
    const int edge = std::max(1, thick / 5);
    const vec3 c = seen_.background * 255.0f + 0.5f;
    const Rgba8 paper{std::uint8_t(c.x), std::uint8_t(c.y), std::uint8_t(c.z), 255};
    for (const int field : {1, 3}) {
      const int from = left + int(std::lround(field * width / 4.0)),
                to = left + int(std::lround((field + 1) * width / 4.0));
      sheet_.fill(from, top + edge, to - from - (field == 3 ? edge : 0), thick - 2 * edge, paper);
    }
    const int baseline = top + thick + em_;
    sheet_.write(text_, left - before, baseline, "0", ink_);
    sheet_.write(text_, left + width - after, baseline, end, ink_);
  }

  void arrow(Corner corner) {
    const glm::dvec2 north = north_in(seen_.camera, seen_.up);
    const double length = 2.2 * em_;
    const int side = int(std::lround(2 * length + 2 * em_));
    const Plate plate(sheet_, corner, margins_, side, side, em_ / 3);
    plate.draw(sheet_, seen_.background);
    const glm::dvec2 middle(plate.x + 0.5 * plate.width, plate.y + 0.5 * plate.height);
    const glm::dvec2 along = glm::dvec2(north.x, -north.y) / glm::length(north), across(-along.y, along.x);
    const glm::dvec2 tip = middle + along * length, tail = middle - along * (0.8 * length),
                     notch = middle - along * (0.45 * length);
    // One half filled, as maps have it.
    const std::array<glm::dvec2, 3> full{tip, notch, tail + across * (0.45 * length)};
    const glm::dvec2 other = tail - across * (0.45 * length);
    sheet_.polygon(full, ink_);
    const double stroke = std::max(1.0, em_ / 12.0);
    sheet_.line(tip, other, stroke, ink_), sheet_.line(other, notch, stroke, ink_),
        sheet_.line(notch, tip, stroke, ink_);
    const glm::dvec2 letter = middle + along * (length + 0.55 * em_);
    sheet_.write(text_, int(std::lround(letter.x)) - text_.width("N") / 2,
                 int(std::lround(letter.y + 0.36 * em_)), "N", ink_);
  }

  /// Where lines of round numbers meet the left and the upper border: coordinate, place on the border, axis.
  struct Crossing {
    double value;
    glm::dvec2 from, to;
    bool at_top;
  };

  std::vector<Crossing> crossings(int& decimals) const {
    const dmat4 world = seen_.camera.inverse_view();
    const dvec3 up = up_vector(seen_.up);
    const int skip = std::abs(up.x) > 0.5 ? 0 : std::abs(up.y) > 0.5 ? 1 : 2;
    const int width = sheet_.width(), height = sheet_.height;
    const Intrinsics k = seen_.camera.intrinsics();
    const auto at = [&](double x, double y) {
      return dvec3(world * glm::dvec4((x - k.cx) / k.fx, -(y - k.cy) / k.fy, 0, 1));
    };
    std::vector<Crossing> all;
    const double span = std::max(width, height) / pixels_per_unit_;
    const std::vector<double> steps = nice_ticks(0, span, 6, decimals);
    const double step = steps.size() > 1 ? steps[1] - steps[0] : span;
    for (int axis = 0; axis < 3; ++axis) {
      if (axis == skip) continue;
      const double o = at(0, 0)[axis], dx = (at(width, 0)[axis] - o) / width,
                   dy = (at(0, height)[axis] - o) / height;
      const double corners[] = {o, o + dx * width, o + dy * height, o + dx * width + dy * height};
      const auto [low, high] = std::minmax_element(std::begin(corners), std::end(corners));
      const bool stands = std::abs(dx) > std::abs(dy);  // a line of one x runs from the top to the bottom
      for (double n = std::ceil(*low / step); n * step <= *high; ++n) {
        const double value = n * step;
        if (stands)
          all.push_back({value, {(value - o) / dx, 0}, {(value - o - dy * height) / dx, height}, true});
        else
          all.push_back({value, {0, (value - o) / dy}, {width, (value - o - dx * width) / dy}, false});
      }
    }
    return all;
  }

  void lines() const {
    int decimals = 0;
    const double width = std::max(1.0, em_ / 16.0);
    for (const Crossing& line : crossings(decimals)) sheet_.line(line.from, line.to, width, ink_, 110);
  }

  /// `taken`: of the left border from below, px.
  void coordinates(int taken) const {
    int decimals = 0;
    const int gap = em_ / 3;
    const vec3 c = seen_.background * 255.0f + 0.5f;
    const Rgba8 paper{std::uint8_t(c.x), std::uint8_t(c.y), std::uint8_t(c.z), 255};
    for (const Crossing& line : crossings(decimals)) {
      const std::string label = fmt::format("{:.{}f}", line.value, decimals);
      const int w = text_.width(label);
      int x = line.at_top ? int(std::lround(line.from.x)) - w / 2 : gap;
      int y = line.at_top ? margins_.top + gap : int(std::lround(line.from.y)) - em_ / 2;
      // Labels of both axes would meet in the corner, and cut ones cannot be read.
      if (line.at_top && (x < gap || x + w > sheet_.width() - gap)) continue;
      if (!line.at_top &&
          (y < margins_.top + 2 * em_ || y + em_ > sheet_.height - margins_.bottom - taken - gap))
        continue;
      sheet_.fill(x - gap / 2, y, w + gap, em_ * 9 / 8, paper, 210);
      sheet_.write(text_, x, y + em_ * 7 / 8, label, ink_);
    }
  }

  const Sheet& sheet_;
  const Furniture& furniture_;
  const Seen& seen_;
  int em_;
  Text text_;
  Rgba8 ink_;
  double pixels_per_unit_;
  Margins margins_;
};

}  // namespace

bool is_plan(const Camera& camera, UpAxis up) {
  return camera.orthographic() && glm::dot(camera.direction(), up_vector(up)) < -1 + 1e-9;
}

Furniture meaningful(const Furniture& furniture, const Camera& camera, UpAxis up) {
  Furniture out = furniture;
  out.scale_bar &= camera.orthographic();
  out.grid &= is_plan(camera, up);
  out.north_arrow &= glm::length(north_in(camera, up)) >= 0.05;
  return out;
}

void check(const Furniture& furniture, const Camera& camera, UpAxis up, bool is_panorama) {
  const auto refuse = [](const char* message) { throw Error(ErrorCode::usage, message); };
  const Furniture fits = is_panorama ? Furniture{} : meaningful(furniture, camera, up);
  if (furniture.scale_bar && !fits.scale_bar)
    refuse(
        "--scale-bar: in perspective what is far is smaller; add --camera-orthographic, --scale or "
        "--pixel-size");
  if (furniture.grid && !fits.grid)
    refuse("--grid: coordinates are those of a plan; add --view top --camera-orthographic");
  if (furniture.north_arrow && !fits.north_arrow)
    refuse("--north-arrow: north is straight ahead or behind, which no arrow in the picture can show");
}

void draw_furniture(Image<Rgba8>& rows, int first_row, const Furniture& furniture, const Seen& seen) {
  if (furniture.empty()) return;
  const Sheet sheet{rows, first_row, seen.camera.height};
  Drawing(sheet, furniture, seen).draw();
}

void draw_furniture(Image<Rgba8>& image, const Furniture& furniture, const Seen& seen) {
  draw_furniture(image, 0, furniture, seen);
}

}  // namespace sfumato::labels
