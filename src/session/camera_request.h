// How to look at a scan: what a user asks for in words or numbers, on top of the first view or of a camera.
#pragma once

#include <optional>
#include <utility>

#include "core/camera.h"
#include "session/pose.h"

namespace sfumato {

/// Angles in degrees, places and directions in world coordinates. What is given wins over what `start` or the
/// first view has.
struct CameraRequest {
  std::optional<Camera> start;  ///< instead of the view that shows the scan
  std::optional<double> azimuth, elevation;
  std::optional<double>
      fov;  ///< full vertical angle, from where 45 degrees show everything: a smaller one zooms in
  std::optional<double> distance;  ///< from the place looked at
  std::optional<dvec3> position, direction, view_up;
  std::optional<dvec3> focal_point;  ///< looked at from where the camera stands
  std::optional<dvec3> look_at;  ///< looked at from the same side and distance; with `position`, from there
  std::optional<double> zoom, roll;
  bool orthographic = false;
  std::optional<double> pixel_size;  ///< scene units a pixel shows, in parallel projection
  std::optional<double>
      print_scale;            ///< the N of 1:N on paper, at `dpi`; the pose's unit says how long a unit is
  std::optional<double> dpi;  ///< 300 where paper is meant
  std::string side;  ///< a named view, whose picture stands upright; azimuth and elevation are its own
  std::optional<std::pair<int, int>> size;    ///< px
  std::pair<int, int> first_size{1280, 720};  ///< of the view that shows the scan, where no size is given
  bool operator==(const CameraRequest&) const = default;
};

/// A pixel of such a size without a picture's size shows all of the subject's box, and the borders of the
/// picture lie at multiples of it. Throws Error(usage) where the camera would stand in the place that it
/// looks at. A `start` with intrinsics of its own takes no size, fov or parallel projection: who asks refuses
/// them first, by the names that they have there.
Camera view_of(const Pose& pose, const CameraRequest& request);
/// What stands upright in it: the first picture's vertical, but the axis where the side is asked for.
dvec3 vertical_of(const Pose& pose, const CameraRequest& request);

}  // namespace sfumato
