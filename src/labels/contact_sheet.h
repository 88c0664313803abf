// The same view by several techniques on one labelled picture.
#pragma once

#include <string>
#include <vector>

#include "core/image.h"

namespace sfumato::labels {

struct Panel {
  std::string label;
  Image<Rgba8> image;
};

/// Panels of one size, in reading order, three side by side (a square for four, four from seven on), a label
/// above each. `background` is sRGB 0..1; with `transparent` what lies between the panels is clear.
Image<Rgba8> contact_sheet(const std::vector<Panel>& panels, const vec3& background, bool transparent);

}  // namespace sfumato::labels
