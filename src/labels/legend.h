// What the colours mean, drawn into a corner of a picture.
#pragma once

#include <string>
#include <vector>

#include "core/coloring.h"
#include "labels/sheet.h"

namespace sfumato::labels {

/// A bar with ticks for a scalar, a list for classes; nothing for the cloud's own colours and for normals,
/// which explain themselves. `background` (sRGB 0..1) decides between dark and light letters, `em` is the
/// usual height of letters, px.
void draw_legend(const Sheet& sheet, const Coloring& coloring, const vec3& background, const LegendLook& look,
                 int em, const Margins& margins);

/// Round numbers inside [low, high], about `count` of them, and the decimals that tell them apart.
std::vector<double> nice_ticks(double low, double high, int count, int& decimals);
/// Four to six of them, by the roundest step that gives so many.
std::vector<double> legend_ticks(double low, double high, int& decimals);

}  // namespace sfumato::labels
