// Points of two numbers as a picture with axes.
#pragma once

#include <span>
#include <string>

#include "core/image.h"
#include "core/vec.h"

namespace sfumato::labels {

struct PlotPoint {
  double x = 0, y = 0;
  Rgba8 color;
};

struct PlotLook {
  std::string title, x_label, y_label;
  double low_x = 0, high_x = 1;  ///< what the horizontal axis shows; the vertical one shows all points
  bool equal_scale = true;       ///< a unit is as long on both axes, where that leaves the vertical one room
};

/// Of at least 160x120 pixels. Points farther to the end of `points` lie over those before.
Image<Rgba8> draw_plot(std::span<const PlotPoint> points, const PlotLook& look, int width, int height);

}  // namespace sfumato::labels
