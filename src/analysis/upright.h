// Which way is up in a cloud whose file does not say, and from where to look at it first.
#pragma once

#include <optional>
#include <string>

#include "core/point_cloud.h"

namespace sfumato::analysis {

struct Upright {
  UpAxis up = UpAxis::pos_z;
  std::string reason;        ///< what speaks for it: "a camera's view: y down"
  double azimuth_deg = -45;  ///< from where the first picture is taken, as --camera-azimuth-angle
  double elevation_deg = 30;
  bool is_camera_view = false;  ///< the scan is a picture, best seen from about where it was taken
  std::optional<UpAxis> other;  ///< what it may be as well, where nothing but the custom tells
};

/// From the shape of a sample of at most 65,536 points; `cloud.up` is the custom of the file's format, which
/// stays unless the shape speaks clearly against it.
Upright guess_upright(const PointCloud& cloud);

}  // namespace sfumato::analysis
