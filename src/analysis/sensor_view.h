// Whether points are what one picture shows.
#pragma once

#include <span>

#include "core/vec.h"

namespace sfumato::analysis {

struct SensorView {
  double first = 0;  ///< the share of the points that no other one hides
  /// Of the surfaces seen, what faces up less what faces down, of all, -1 to 1: floors and tables are seen
  /// from above.
  double faces_up = 0;
  /// Something is to both sides of straight ahead, above and below it, and nothing at the eye: a camera is so
  /// before what it sees, no origin is below what stands on it.
  bool ahead = false;
  bool afar = false;  ///< all of it is farther away than it is deep
  /// All is to one side of straight ahead: no picture of a whole scene, but perhaps a part of one.
  bool is_beside = false;
  double width = 0;  ///< of what appears at a distance of 1, or its height where that is more
  /// Less than 3 degrees: no camera looks through such a window, the origin of a map does.
  bool is_narrow() const { return !(width > 0.05); }
  bool of_pixels = false;  ///< the lines of sight are in columns and rows, as those of an image
  /// Of what is open in the points' rectangle across the line of sight, the share that is closed in that of
  /// their directions, 0 to 1: an image ends at its sides, a tile of land at those of its plan.
  double framed = 0;
};

/// Of who looks from `eye` along a unit vector, upright by `up`: nothing where 2 % or more of the points lie
/// farther than 60 degrees from it to a side.
SensorView sensor_view_of(std::span<const dvec3> points, const dvec3& eye, const dvec3& along,
                          const dvec3& up);

/// From `eye` each line of sight meets one surface: 0 to 1.
double is_one_picture(const SensorView& view);
/// The points are those of an image taken at `eye`, however noisy its depths are: 0 to 1.
double is_image(const SensorView& view);

/// The mean direction from `eye` to the points, a unit vector; 0 where they lie all around it.
dvec3 mean_direction(std::span<const dvec3> points, const dvec3& eye);

/// The share of points to which the nearest one in space is at the same elevation from `eye`, and one usual
/// step to a side: most, of what a lidar there measured while it turned. 0 of more than a million.
double turned_share(std::span<const vec3> points, const vec3& eye, const vec3& up);

/// Whether the points are more likely than not a picture that was taken from `eye`, whichever way it looked.
bool are_one_picture(std::span<const dvec3> points, const dvec3& eye);

}  // namespace sfumato::analysis
