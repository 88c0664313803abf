#include "core/furniture.h"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <utility>

#include "core/error.h"

namespace sfumato {
namespace {

constexpr FurnitureOption options[] = {
    {"legend", "", "explain the colours in the picture"},
    {"legend-title", "TEXT", "title of the legend (what the colours show)"},
    {"legend-unit", "UNIT", "after the title (for elevations that of the file's CRS)"},
    {"legend-place", "bottom-right|bottom-left|top-right|top-left", "corner of the legend (bottom-right)"},
    {"legend-size", "F", "the legend F times as large, 0.3 to 4 (1)"},
    {"scale-bar", "", "a bar of a round length, in orthographic views"},
    {"north-arrow", "", "an arrow to the north, which is +Y of the file (of a y-up file -Z)"},
    {"grid", "", "a grid of round coordinates, in plans (--view top --camera-orthographic)"},
    {"title", "TEXT", "above the picture"},
    {"caption", "TEXT", "below the picture"},
    {"unit", "m|ft|ft-us|km|cm|mm|NAME", "unit of the coordinates (that of the file's CRS)"},
};

bool truth(std::string_view name, const std::string& value) {
  if (value == "true") return true;
  if (value == "false") return false;
  throw Error(ErrorCode::usage, std::string(name) + ": '" + value + "' is not true or false");
}

Corner corner_named(const std::string& value) {
  static const std::pair<const char*, Corner> names[] = {{"bottom-right", Corner::bottom_right},
                                                         {"bottom-left", Corner::bottom_left},
                                                         {"top-right", Corner::top_right},
                                                         {"top-left", Corner::top_left}};
  for (const auto& [name, corner] : names)
    if (value == name) return corner;
  throw Error(ErrorCode::usage, "legend-place: '" + value +
                                    "' is no corner: write bottom-right, bottom-left, top-right or top-left");
}

}  // namespace

bool Furniture::empty() const {
  return !legend && !scale_bar && !north_arrow && !grid && title.empty() && caption.empty();
}

std::span<const FurnitureOption> furniture_options() { return options; }

bool is_furniture(std::string_view name) {
  return std::any_of(std::begin(options), std::end(options),
                     [&](const FurnitureOption& option) { return name == option.name; });
}

bool* flag_of(Furniture& furniture, std::string_view name) {
  if (name == "legend") return &furniture.legend;
  if (name == "scale-bar") return &furniture.scale_bar;
  if (name == "north-arrow") return &furniture.north_arrow;
  return name == "grid" ? &furniture.grid : nullptr;
}

bool set(Furniture& furniture, std::string_view name, const std::string& value) {
  if (bool* flag = flag_of(furniture, name))
    *flag = truth(name, value);
  else if (name == "title")
    furniture.title = value;
  else if (name == "caption")
    furniture.caption = value;
  else if (name == "legend-title")
    furniture.legend_look.title = value;
  else if (name == "legend-unit")
    furniture.legend_look.unit = value;
  else if (name == "unit")
    furniture.unit = value;
  else if (name == "legend-place")
    furniture.legend_look.corner = corner_named(value);
  else if (name == "print-scale")
    furniture.print_scale = std::strtod(value.c_str(), nullptr);
  else if (name == "dpi")
    furniture.dpi = std::strtod(value.c_str(), nullptr);
  else if (name == "legend-size") {
    char* end = nullptr;
    furniture.legend_look.size = std::strtod(value.c_str(), &end);
    if (end == value.c_str() || *end ||
        !(furniture.legend_look.size >= 0.3 && furniture.legend_look.size <= 4))
      throw Error(ErrorCode::usage, "legend-size: '" + value + "' is not a number from 0.3 to 4");
  } else {
    return false;
  }
  return true;
}

Furniture furniture_of(bool legend, const std::vector<std::pair<std::string, std::string>>& given) {
  Furniture furniture;
  for (const auto& [name, value] : given) set(furniture, name, value);
  furniture.legend = legend;
  return furniture;
}

}  // namespace sfumato
