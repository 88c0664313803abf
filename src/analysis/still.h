// What stands still from one frame of a sequence to the next, in spite of its noise.
#pragma once

#include "core/point_cloud.h"
#include "core/progress.h"

namespace sfumato::analysis {

/// Follows a sequence of clouds. A point stands still that is nearer than half the spacing to one of the
/// frame before: the two are one point, measured twice. The nearest find each other first.
class StillPoints {
 public:
  /// Puts the points of the next frame that stand still where they were in the frame before. They keep their
  /// colour while it differs by less than `color_step` (RGB distance, 0..255 each), and a normal of the file
  /// while it turns by less than a crease.
  void hold(PointCloud& cloud, float color_step, Progress& progress = no_progress());

 private:
  PointCloud before_;  ///< positions, normals and colours
};

}  // namespace sfumato::analysis
