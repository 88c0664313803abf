// Words in pictures: DejaVu Sans, embedded in the program, drawn by FreeType.
#pragma once

#include <memory>
#include <string_view>

#include "core/image.h"

namespace sfumato::labels {

class Text {
 public:
  /// `size_px`: height of the em square.
  explicit Text(int size_px);
  ~Text();

  int size() const { return size_px_; }
  /// Width of a line in pixels.
  int width(std::string_view utf8) const;
  /// Draws a line whose baseline starts at (x, y); parts outside the picture are clipped.
  void draw(Image<Rgba8>& image, int x, int y, std::string_view utf8, Rgba8 color) const;

 private:
  struct Face;
  int size_px_;
  std::unique_ptr<Face> face_;
};

/// `color` over the pixel, with `coverage` 0..255 as its opacity; straight alpha.
void blend(Rgba8& pixel, Rgba8 color, int coverage);
void fill(Image<Rgba8>& image, int x, int y, int width, int height, Rgba8 color, int coverage = 255);
/// Black or white, whichever reads better on `background` (sRGB 0..1).
Rgba8 ink_on(const vec3& background);

}  // namespace sfumato::labels
