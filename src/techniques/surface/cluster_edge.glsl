// Where another side of a depth edge begins.
#include "frame.glsl"

// Eye z behind which a point of a square of that width is not of the same side as the nearest one.
float cluster_edge(float nearest_z, float spacing, float width_px) {
  return nearest_z - 4.0 * max(spacing, width_px / pixels_at(max(-nearest_z, 0.0)));
}
