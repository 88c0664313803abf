// The fixed options of rendering. Parameters of techniques are in parameters.h, the camera in
// camera_options.h.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "camera_options.h"
#include "command_line.h"
#include "core/coloring.h"
#include "io/io.h"
#include "parameters.h"

namespace sfumato::cli {

struct RenderOptions {
  Words files;
  std::string technique, output, output_panels, output_depth, output_normal, output_camera;
  CameraOptions camera;
  std::string up, background_color, color_range, hide_classes = "7,18", columns, max_points;
  ColorSettings color;
  bool no_background = false, legend = false, timings = false, json = false, quiet = false, version = false;
  bool sequence = false;  ///< every file is a picture, not a part of one scene
  std::string path, frames, degrees, preset, save_preset;

  // Parsed by `check`.
  std::optional<UpAxis> up_axis;
  vec3 background{1};
  std::vector<int> hidden_classes;
  io::ReadOptions read;
  int frame_count = 1;
  double orbit_degrees = 360;

  void declare(CommandLine& line);
  /// Everything that can be wrong before a file is opened. Throws Error(usage).
  void check(std::size_t technique_count);
  bool has_output() const {
    return !output.empty() || !output_panels.empty() || !output_depth.empty() || !output_normal.empty() ||
           !output_camera.empty();
  }
};

/// Lower-case extension: ".png".
std::string extension_of(const std::string& file);
/// "frame_{n:04}.png" for frame 7: "frame_0007.png"; {technique} is the technique. Throws Error(usage) for a
/// broken template.
std::string frame_name(const std::string& pattern, int n, const std::string& technique = {});
/// The last value of an option, found before the line is parsed; empty when it is not given.
std::string peek(const Words& words, char short_name, const std::string& long_name);

}  // namespace sfumato::cli
