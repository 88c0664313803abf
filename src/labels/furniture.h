// What makes a picture a figure or a map: legend, scale bar, north arrow, coordinate grid, title and caption.
#pragma once

#include <string>

#include "core/camera.h"
#include "core/furniture.h"
#include "core/units.h"
#include "labels/legend.h"

namespace sfumato::labels {

/// The picture that it is drawn on.
struct Seen {
  Camera camera;  ///< of the whole picture
  UpAxis up = UpAxis::pos_z;
  std::string crs;  ///< of the points, may be empty
  const Coloring& coloring;
  vec3 background{1};
  bool is_panorama = false;
  double vertical_exaggeration = 1;
};

/// Throws Error(usage) where something asked for has no meaning: a scale bar in perspective, a grid beside a
/// plan, a north arrow towards the horizon.
void check(const Furniture& furniture, const Camera& camera, UpAxis up, bool is_panorama);
/// What of it has one: for windows, whose cameras turn.
Furniture meaningful(const Furniture& furniture, const Camera& camera, UpAxis up);
void draw_furniture(Image<Rgba8>& image, const Furniture& furniture, const Seen& seen);
/// The part of that on some rows of the picture.
void draw_furniture(Image<Rgba8>& rows, int first_row, const Furniture& furniture, const Seen& seen);

/// A parallel view straight down: whole pixels have coordinates.
bool is_plan(const Camera& camera, UpAxis up);

}  // namespace sfumato::labels
