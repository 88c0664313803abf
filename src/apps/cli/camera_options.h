// From the camera options of the command line to a camera.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "command_line.h"
#include "core/camera.h"
#include "session/view_wishes.h"

namespace sfumato::cli {

struct CameraOptions {
  std::optional<std::string> file, position, focal_point, view_up, direction, azimuth_deg, elevation_deg,
      view_angle_deg;
  std::optional<std::string> resolution, view, zoom, roll_deg, look_at, distance;
  std::optional<std::string> pixel_size, scale, dpi_text, exaggeration_text;
  bool orthographic = false, panorama = false, whole = false;
  std::optional<Camera> preset;  ///< camera kept in a preset; `file` wins over it

  void declare(CommandLine& line);
  /// Throws Error(usage) for values that are no numbers or contradict each other, before anything is read. A
  /// named view becomes its azimuth and elevation.
  void check();
  /// The camera of a preset or --camera FILE, else the view that shows the scan; single options win over
  /// both.
  Camera resolve(const Pose& pose) const;

  /// Whether it was said where the camera stands or how large things are, not only from which side.
  bool stands_somewhere() const {
    return file || position || focal_point || look_at || distance || zoom || preset || panorama;
  }
  /// The N of --scale 1:N, and what it needs; 0 where it is not given.
  double print_scale() const;
  /// Pixels an inch on paper; 0 where nobody means paper.
  double dpi() const;
  double vertical_exaggeration() const;
  /// Whether anything but the picture's size was asked for.
  bool moves_camera() const;

 private:
  ViewWishes wishes() const;
  std::optional<dvec3> vector(const char* option, const std::optional<std::string>& text) const;
};

}  // namespace sfumato::cli
