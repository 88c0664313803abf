#include "labels/contact_sheet.h"

#include <algorithm>

#include "labels/text.h"

namespace sfumato::labels {

Image<Rgba8> contact_sheet(const std::vector<Panel>& panels, const vec3& background, bool transparent) {
  const int count = int(panels.size());
  const int columns = count == 4 ? 2 : std::min(count, count > 6 ? 4 : 3);
  const int rows = (count + columns - 1) / columns;
  const int width = panels[0].image.width(), height = panels[0].image.height();
  const Text text(std::clamp(height / 24, 9, 64));
  const int gap = std::max(2, height / 90), label = text.size() * 8 / 5;

  const vec3 c = background * 255.0f + 0.5f;
  const Rgba8 ground{std::uint8_t(c.x), std::uint8_t(c.y), std::uint8_t(c.z),
                     std::uint8_t(transparent ? 0 : 255)};
  Image<Rgba8> sheet(columns * width + (columns - 1) * gap, rows * (height + label) + (rows - 1) * gap,
                     ground);
  for (int i = 0; i < count; ++i) {
    const int x = i % columns * (width + gap), y = i / columns * (height + label + gap);
    const int indent = (width - text.width(panels[std::size_t(i)].label)) / 2;
    text.draw(sheet, x + indent, y + text.size() * 6 / 5, panels[std::size_t(i)].label, ink_on(background));
    for (int row = 0; row < height; ++row)
      std::copy_n(panels[std::size_t(i)].image.row(row), width, &sheet.at(x, y + label + row));
  }
  return sheet;
}

}  // namespace sfumato::labels
