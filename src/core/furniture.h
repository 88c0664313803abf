// What may be drawn into a picture to make it a figure or a map, as it is asked for.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sfumato {

enum class Corner { top_left, top_right, bottom_left, bottom_right };

struct LegendLook {
  std::string title;  ///< empty: what the colours show
  std::string unit;   ///< behind the title; empty: none
  Corner corner = Corner::bottom_right;
  double size = 1;  ///< of the bar and its words, times the usual
};

struct Furniture {
  bool legend = false, scale_bar = false, north_arrow = false, grid = false;
  std::string title, caption;
  LegendLook legend_look;
  std::string unit;        ///< of the coordinates, where the reference system does not say it or is not known
  double print_scale = 0;  ///< the N of 1:N, 0: none is meant
  double dpi = 0;  ///< pixels an inch on paper: words are of 8 points; 0: they follow the picture's height
  bool empty() const;
};

/// The options that say it, the same on the command line, in presets and in Python (with underscores).
struct FurnitureOption {
  const char* name;
  const char* metavar;  ///< empty: a flag
  const char* help;
};
std::span<const FurnitureOption> furniture_options();
bool is_furniture(std::string_view name);
/// Of an option without a value; nothing for others.
bool* flag_of(Furniture& furniture, std::string_view name);
/// Sets the option of that name, or `print-scale` and `dpi`, which belong to views; false when it is none of
/// these. Throws Error(usage) for values that are
/// none. Flags take "true" and "false".
bool set(Furniture& furniture, std::string_view name, const std::string& value);

/// Of options by name, which were checked when they were given.
Furniture furniture_of(bool legend, const std::vector<std::pair<std::string, std::string>>& options);

}  // namespace sfumato
