// From which side a scan is looked at first.
#pragma once

#include "session/first_view.h"

namespace sfumato {

/// Degrees, as --camera-azimuth-angle and --camera-elevation-angle.
struct Standpoint {
  double azimuth_deg = -30, elevation_deg = 30;
};

/// By custom what stands is seen almost at eye level, a little from the left of its front, as one looks at a
/// statue, and what lies from above; elsewhere from where a small depth picture shows clearly more. Land has
/// no front. A room of which the cutaway shows hardly more than the whole is none any more.
Standpoint standpoint_for(Subject& subject, UpAxis up);

/// Whether a scan is no higher than land is.
bool is_lying(const Bounds& box, UpAxis up);

/// Where a sensor stood that saw all of the subject in one picture, as depth cameras do, and the direction of
/// the middle of that. From there nothing gapes that was hidden from it.
struct Sensor {
  dvec3 place, along;
};
/// Of a scan that says where its one scanner stood, or that lies before the origin and is not land.
std::optional<Sensor> sensor_of(const PointCloud& cloud, const Subject& subject);

/// A place inside of a scan to look around from: where a scanner stood, else the middle. World.
dvec3 place_inside(const PointCloud& cloud);

}  // namespace sfumato
