// Some rows of a picture, drawn on in the pixels of the whole one.
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "core/furniture.h"
#include "labels/text.h"

namespace sfumato::labels {

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
  /// A convex polygon, its edges smooth: 4 x 4 samples a pixel.
  void polygon(std::span<const glm::dvec2> corners, Rgba8 color, int coverage = 255) const;
  /// A straight line of this width, px.
  void line(glm::dvec2 from, glm::dvec2 to, double width_px, Rgba8 color, int coverage = 255) const;
};

/// What titles and captions leave free at the top and the bottom, px.
struct Margins {
  int top = 0, bottom = 0;
};

/// A ground for words in a corner of the picture.
struct Plate {
  int x, y, width, height, pad;
  Plate(const Sheet& sheet, Corner corner, const Margins& margins, int content_width, int content_height,
        int pad_px);
  void draw(const Sheet& sheet, const vec3& background) const;
};

}  // namespace sfumato::labels
