// What may be drawn into a picture to make it a figure or a map, as it is asked for.
#pragma once

#include <string>

namespace sfumato {

enum class Corner { top_left, top_right, bottom_left, bottom_right };

struct LegendLook {
  std::string title;  ///< empty: what the colours show
  std::string unit;   ///< behind the title; empty: none
  Corner corner = Corner::bottom_right;
  double size = 1;  ///< of the bar and its words, times the usual
  bool operator==(const LegendLook&) const = default;
};

struct Furniture {
  bool legend = false, scale_bar = false, north_arrow = false, grid = false;
  std::string title, caption;
  LegendLook legend_look;
  std::string unit;        ///< of the coordinates, where the reference system does not say it or is not known
  double print_scale = 0;  ///< the N of 1:N, 0: none is meant
  double dpi = 0;  ///< pixels an inch on paper: words are of 8 points; 0: they follow the picture's height
  bool empty() const {
    return !legend && !scale_bar && !north_arrow && !grid && title.empty() && caption.empty();
  }
  bool operator==(const Furniture&) const = default;
};

}  // namespace sfumato
