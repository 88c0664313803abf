// The fixed options of rendering. Parameters of techniques are in parameters.h, the camera in
// camera_options.h.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "camera_options.h"
#include "command_line.h"
#include "common_options.h"
#include "core/coloring.h"
#include "input_options.h"
#include "io/camera_json.h"
#include "parameters.h"
#include "scene/leveled_scene.h"
#include "labels/furniture.h"
#include "session/draw_rule.h"

namespace sfumato::publish {
class Publication;
}

namespace sfumato::cli {

/// What stands in a file name for the braces of its pattern.
struct NameParts {
  int n = 0;
  std::string technique, stem;
};

struct RenderOptions {
  Words files;
  std::string technique, output, output_panels, output_depth, output_normal, output_camera;
  CameraOptions camera;
  InputOptions input{"7,18", true};
  CommonOptions common;
  std::string background_color, color_range, exposure_text, point_color, quality_text;
  ColorSettings color;
  bool no_background = false, world_file = false, timings = false, json = false, watch = false;
  Furniture furniture;
  bool sequence = false;  ///< every file is a picture, all from the camera of the first
  bool each = false;      ///< every file is a picture of its own
  std::string path, frames, degrees, preset, save_preset, scene, save_scene, shader_folder,
      memory_text = "4G", gpu_memory_text;
  Words transforms;  ///< "N: 16 numbers"
  Words draw;        ///< "SELECTION: TECHNIQUE [name=value ...]"

  publish::Publication* publication = nullptr;  ///< takes the pictures in place of files

  // Parsed by `check`.
  io::CameraPath poses;  ///< of --path
  std::vector<DrawRule> rules;
  std::vector<scene::SceneFile> scene_files;  ///< of --scene, and of --transform once files are expanded
  vec3 background{1};
  int frame_count = 1, quality = 90;
  double orbit_degrees = 360;
  std::uint64_t memory = scene::default_memory;  ///< of the points of COPC files

  void declare(CommandLine& line);
  /// Everything that can be wrong before a file is opened. Throws Error(usage).
  void check(std::size_t technique_count);
  /// The files that their words name; call before `check_names`.
  void expand_files();
  /// The n-th file, or all of them, and where a scene puts their points.
  scene::SceneFile placed(std::size_t n) const;
  std::vector<scene::SceneFile> placed() const;
  /// Whether the pictures of --path are those of its poses, each in its size.
  bool shows_poses() const { return poses.are_pictures && frames.empty(); }
  /// What stands in the names of picture `n`.
  NameParts parts(int n, const std::string& technique = {}) const;
  /// Pictures to be made of each technique.
  int picture_count() const { return each || sequence ? int(files.size()) : path.empty() ? 1 : frame_count; }
  void check_outputs(std::size_t technique_count);
  /// Without any output a window opens.
  void check_window(std::size_t technique_count) const;
  bool has_output() const {
    return publication || !output.empty() || !output_panels.empty() || !output_depth.empty() ||
           !output_normal.empty() || !output_camera.empty();
  }
};

/// Lower-case extension: ".png".
std::string extension_of(const std::string& file);
/// "frame_{n:04}.png" for frame 7: "frame_0007.png"; {technique} is the technique, {stem} the input's name
/// without folder and extension. Throws Error(usage) for a broken pattern.
std::string file_name(const std::string& pattern, const NameParts& parts);
/// "scans/a.copc.laz": "a".
std::string stem_of(const std::string& file);
/// The last value of an option, found before the line is parsed; empty when it is not given.
std::string peek(const Words& words, char short_name, const std::string& long_name);

}  // namespace sfumato::cli
