// From the camera options of the command line to a camera.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "command_line.h"
#include "core/camera.h"

namespace sfumato::cli {

/// What the first view shows.
struct Subject {
  Bounds box;
  std::vector<dvec3> points;  ///< some of those in the box, world; the view fits them tightly
};

/// The 2-98 % box and up to 50,000 of the points inside. A side grows to the full box where that is at most a
/// third of the diagonal further out: stray points do not decide the view, and neither the tower of a flat
/// site nor the tip of a wedge is cut.
Subject subject_of(const PointCloud& cloud);

struct CameraOptions {
  std::optional<std::string> file, position, focal_point, view_up, direction, azimuth_deg, elevation_deg,
      view_angle_deg;
  std::optional<std::string> resolution, view, zoom, roll_deg, look_at, distance;
  bool orthographic = false, panorama = false;
  double first_azimuth_deg = -45, first_elevation_deg = 30;  ///< of the view that frames the scan
  std::optional<Camera> preset;  ///< camera kept in a preset; `file` wins over it

  void declare(CommandLine& line);
  /// Throws Error(usage) for values that are no numbers or contradict each other, before anything is read. A named
  /// view becomes its azimuth and elevation.
  void check();
  /// The camera of a preset or --camera FILE, else the view that frames `subject`; single options win over
  /// both.
  Camera resolve(const Subject& subject, UpAxis up) const;

  /// Whether anything but the picture's size was asked for.
  bool moves_camera() const;

 private:
  void aim(Camera& camera, UpAxis up) const;
  void magnify(Camera& camera) const;
  std::optional<dvec3> vector(const char* option, const std::optional<std::string>& text) const;
};

/// Full turn (or `degrees`) of `start` about its up axis through the target; the first frame is `start`
/// itself.
std::vector<Camera> orbit(const Camera& start, const dvec3& up, int frames, double degrees);
/// A smooth path through the key cameras (Catmull-Rom on positions, targets, angles), first to last key.
std::vector<Camera> interpolate(const std::vector<Camera>& keys, int frames);

}  // namespace sfumato::cli
