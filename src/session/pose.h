// How a scene presents itself: which way is up, from which side to look first, and what the first view shows.
#pragma once

#include <optional>

#include "analysis/upright.h"
#include "core/camera.h"
#include "core/progress.h"
#include "core/units.h"
#include "scene/scene.h"
#include "session/first_view.h"

namespace sfumato {

struct Pose {
  analysis::Upright upright;
  Subject subject;
  LengthUnit unit = {};                 ///< of the horizontal axes, as far as the files say
  std::optional<dvec3> sensor = {};     ///< the first view is that of the sensor that stood there
  std::optional<FittedTo> around = {};  ///< the first view is fitted to these
  double vertical_exaggeration = 1;     ///< of the points
  /// What stands upright in the first picture, of length 1.
  dvec3 vertical() const { return upright.vertical == dvec3(0) ? up_vector(upright.up) : upright.vertical; }
};

/// Along the up axis, of some of what the first view is fitted to, where that is not nearly all; else none.
std::vector<double> shown_heights(const Pose& pose);

/// Turns the cloud's up axis to what the user wants, else what the file says, else what the shape says.
/// `cutaway`: rooms are seen without the walls before them.
/// `vertical_exaggeration`: heights become so many times as large, and the scalar `elevation` keeps the true
/// ones.
Pose stand_upright(scene::Scene& scene, const std::optional<UpAxis>& asked = {}, bool cutaway = true,
                   double vertical_exaggeration = 1, Progress& progress = no_progress());
/// Heights (world coordinates along the cloud's up axis) times a factor; the scalar `elevation` has the true
/// ones.
void exaggerate(PointCloud& cloud, double factor);
/// The view from the side that suits the scan, or of its sensor, which shows all but outliers; of a sweep,
/// what lies around its sensor.
Camera first_view(const Pose& pose, int width, int height);

}  // namespace sfumato
