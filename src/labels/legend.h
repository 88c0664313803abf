// What the colours mean, drawn into the lower right corner of a picture.
#pragma once

#include <string>

#include "core/coloring.h"

namespace sfumato::labels {

/// A bar with ticks for a scalar, a list for classes; nothing for the cloud's own colours and for normals,
/// which explain themselves. `background` (sRGB 0..1) decides between dark and light letters.
void draw_legend(Image<Rgba8>& image, const Coloring& coloring, const vec3& background);

/// The part of that on some rows of a picture of this height.
void draw_legend(Image<Rgba8>& rows, int first_row, int height, const Coloring& coloring,
                 const vec3& background);

/// Round numbers inside [low, high], about `count` of them, and the decimals that tell them apart.
std::vector<double> nice_ticks(double low, double high, int count, int& decimals);

}  // namespace sfumato::labels
