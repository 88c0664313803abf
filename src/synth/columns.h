// The attributes a synthetic scan fills, as arrays to be written point by point from many threads.
#pragma once

#include "synth/synth.h"

namespace sfumato::synth {

struct Columns {
  bool normals = true, intensity = true, classes = true, scanner = false, amplitude = false, outlier = false,
       returns = false;
  std::string piece;  ///< scalar with the primitive's number; empty: none
};

/// What a scan holds at one point.
struct Sample {
  SurfacePoint point;
  vec3 color{0};
  std::uint8_t alpha = 255, class_id = class_unassigned, outlier = 0, scanner = 0;
  double reflectance = 0;  ///< 0..1, share of the light that comes back
  double amplitude = 0;
  std::uint32_t surface = 0;
  std::uint8_t return_number = 1, number_of_returns = 1;
};

class ColumnWriter {
 public:
  /// Gives `cloud` those attributes; points are then written by index, from any thread.
  ColumnWriter(PointCloud& cloud, const Columns& columns);
  void resize(std::size_t count);
  void write(std::size_t i, const Sample& sample);

 private:
  enum Column {
    intensity,
    class_id,
    piece,
    scanner,
    amplitude,
    outlier,
    return_number,
    number_of_returns,
    column_count
  };
  PointCloud& cloud_;
  bool normals_;
  std::array<int, column_count> place_;  ///< in cloud_.scalars, -1: not asked for
};

/// Colour, class and reflectance of a place on the scene's surface.
Sample surface_sample(const Scene& scene, std::uint32_t surface, const SurfacePoint& point);
/// A grey point anywhere in the box: what dust, birds and multiple reflections leave behind.
Sample make_outlier(const Bounds& box, Random& random);

}  // namespace sfumato::synth
