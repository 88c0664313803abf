// From the camera options of the command line to a camera.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "command_line.h"
#include "core/camera.h"

namespace sfumato::cli {

struct CameraOptions {
  std::optional<std::string> file, position, focal_point, view_up, direction, azimuth_deg, elevation_deg, view_angle_deg;
  std::optional<std::string> resolution;
  bool orthographic = false;
  std::optional<Camera> preset;  ///< camera kept in a preset; `file` wins over it

  void declare(CommandLine& line);
  /// Throws Error(usage) for values that are no numbers or contradict each other, before anything is read.
  void check() const;
  /// The camera of a preset or --camera FILE, else the view that frames `box`; single options win over both.
  Camera resolve(const Bounds& box, UpAxis up) const;

 private:
  void aim(Camera& camera, UpAxis up) const;
  std::optional<dvec3> vector(const char* option, const std::optional<std::string>& text) const;
};

/// Full turn (or `degrees`) of `start` about its up axis through the target; the first frame is `start` itself.
std::vector<Camera> orbit(const Camera& start, const dvec3& up, int frames, double degrees);
/// A smooth path through the key cameras (Catmull-Rom on positions, targets, angles), first to last key.
std::vector<Camera> interpolate(const std::vector<Camera>& keys, int frames);

/// What the first view frames: the 2-98 % box, grown to the full one where that is at most a sixth further out,
/// so that stray points do not decide the view and a compact object is not cut.
Bounds framing_box(const PointCloud& cloud);

}  // namespace sfumato::cli
