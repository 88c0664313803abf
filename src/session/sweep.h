// The first view of a sweep, what a lidar measured while it turned: dense near the sensor and sparse far off.
#pragma once

#include <functional>
#include <optional>

#include "session/standpoint.h"

namespace sfumato {

/// A view that is fitted to what lies around a sensor and then moved: what is farther is drawn, and seen as
/// far as it fits.
struct SweepView {
  Standpoint from;
  FittedTo around;
};
/// Of the views of a sweep the one over whose page its points are spread most evenly, moved to where they are
/// most so, if they are more so than over that of the usual view, which only sweeps ask for. `of_sensor`:
/// that is a picture that the sensor took, whose azimuth stays.
std::optional<SweepView> view_of_sweep(const PointCloud& cloud, const Subject& subject,
                                       const std::function<Camera()>& usual_view, bool of_sensor);

}  // namespace sfumato
