// From where a scan is looked at: the first view, and cameras that move.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/camera.h"
#include "core/point_cloud.h"
#include "core/progress.h"
#include "core/room.h"

namespace sfumato {

/// The frame that azimuth and elevation are measured in, as in core/camera.cpp: azimuth 0 looks from the
/// front. Radians.
struct Compass {
  dvec3 up, front, right;
  explicit Compass(UpAxis axis);
  /// Of a unit direction from the target to the camera.
  double azimuth(const dvec3& from) const;
  double elevation(const dvec3& from) const;
  dvec3 from(double azimuth, double elevation) const;
};

/// What the first view shows.
struct Subject {
  Bounds box;
  std::vector<dvec3> points;  ///< some of those in the box, world
  std::vector<vec3> facing;  ///< where each of them faces: its normal, or the way to the one scanner; or none
  std::vector<bool> framed;  ///< of the points, what hangs together, which the view fits tightly; or all
  double share = 1;          ///< of the cloud, what is framed
  std::optional<Room> room;  ///< seen from within: walls between it and the camera are not drawn
  bool is_framed(std::size_t i) const { return framed.empty() || framed[i]; }
};

/// What lies within a radius of a place.
struct Reach {
  dvec3 place;
  double radius;
};
/// What a view is fitted to before the camera moves to its right, upwards and back, in distances to its
/// target.
struct FittedTo {
  static constexpr double width_over_height = 16.0 / 9;  ///< of the page that the move was found for
  Reach reach;
  dvec3 move = dvec3(0);
};
void move_along_axes(Camera& camera, const dvec3& by);

/// Those of the framed points of a subject that lie there, and their box.
Subject within(const Subject& subject, const Reach& around);

/// Where scanners stood, as far as the file says.
std::vector<dvec3> scanners_of(const PointCloud& cloud);

/// The box of what hangs together and holds most points for its size (connected.h); of what is inside, up to
/// 50,000 points. `whole`: all but isolated outliers.
Subject subject_of(const PointCloud& cloud, bool whole = false, Progress& progress = no_progress());

/// The shortest turn that brings `from` to `to`, both of length 1 and not opposite.
glm::dmat3 turn_between(const dvec3& from, const dvec3& to);
/// Turns the camera about its target by the rotation that takes the axis to `vertical`.
void stand_on(Camera& camera, UpAxis axis, const dvec3& vertical);

/// Of the width and height of the page, what a fitted view fills: discs of the outermost points need room.
constexpr double filled_share = 0.92;
/// Keeps the direction of view and moves the camera to the nearest place that sees every one of the points
/// within that share. Points in one place have no extent to fit: the camera stays.
void fit(Camera& camera, const std::vector<dvec3>& points);
/// Likewise the points of a subject that are drawn for who looks from this side.
void fit(Camera& camera, const Subject& subject);

/// The slopes to the right and upwards between which the points of a subject appear, but for a share of them
/// on each side that a gap sets apart.
std::pair<glm::dvec2, glm::dvec2> slopes_of(const Subject& subject, const dvec3& eye, const dvec3& along,
                                            const dvec3& up, double beyond);
/// Of what a sensor saw, the share that its picture is not opened for on each side beyond a gap: of one that
/// sees nearly all within 60 degrees a few points may be at 80.
constexpr double beyond_picture = 0.01;
/// Keeps the direction of view, moves the camera to `place` and opens it as far as the subject needs there.
void see_from(Camera& camera, const dvec3& place, const Subject& subject);

/// Turns the camera to the middle of the subject's plan, in its direction, and moves it back until a turn
/// about `up` shows all of the subject from every side.
void step_back(Camera& camera, const dvec3& up, const Subject& subject);

/// The sides that have a name.
struct NamedView {
  const char* name;
  double azimuth_deg, elevation_deg;
};
/// front, back, left, right, top, bottom or iso. Throws Error(usage) that names `who` asked and the nearest.
NamedView find_view(std::string_view name, const std::string& who);

/// Turns the camera about its target to where azimuth and elevation (radians) say; what is not given stays.
/// Straight up and down it gets an up of its own; elsewhere it keeps its up, or stands `upright`.
void look_from(Camera& camera, UpAxis axis, std::optional<double> azimuth, std::optional<double> elevation,
               bool upright = false);
/// Shows things `factor` times as large, from the same place.
void magnify(Camera& camera, double factor);
/// Turns the camera about its direction of view, counter-clockwise; radians.
void roll(Camera& camera, double angle);
/// Parallel projection; the plane through the target keeps its size in the picture.
void make_orthographic(Camera& camera);

/// Full turn (or `degrees`) of `start` about its up axis through the target; the first frame is `start`
/// itself.
std::vector<Camera> orbit(const Camera& start, const dvec3& up, int frames, double degrees);
/// A smooth path through the key cameras (Catmull-Rom on positions, targets, angles), first to last key.
std::vector<Camera> interpolate(const std::vector<Camera>& keys, int frames);
/// One camera of that path: `place` is 0 at the first key, 1 at the second.
Camera interpolated(const std::vector<Camera>& keys, double place);

}  // namespace sfumato
