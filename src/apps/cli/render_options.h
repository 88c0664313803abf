// A request (session/request.h) as the command has it. Parameters of techniques are in parameters.h.
#pragma once

#include <string>
#include <vector>

#include "command_line.h"
#include "common_options.h"
#include "input_options.h"
#include "io/camera_json.h"
#include "parameters.h"

namespace sfumato::publish {
class Publication;
}

namespace sfumato::cli {

/// What stands in a file name for the braces of its pattern.
struct NameParts {
  int n = 0;
  std::string technique, stem;
};

/// A request of the command.
struct RenderOptions : Request {
  CommonOptions common;
  publish::Publication* publication = nullptr;  ///< takes the pictures in place of files

  io::CameraPath poses;                       ///< of --path, read by `check`
  std::vector<scene::SceneFile> scene_files;  ///< of --scene, and of --transform once files are expanded

  void declare(CommandLine& line);
  /// Everything that can be wrong before a file is opened. Throws Error(usage).
  void check(std::size_t technique_count);
  /// The files that their words name; call before `check_names`.
  void expand_files();
  /// The n-th file, or all of them, and where a scene puts their points.
  scene::SceneFile placed(std::size_t n) const;
  std::vector<scene::SceneFile> placed() const;
  /// Whether the pictures of --path are those of its poses, each in its size.
  bool shows_poses() const { return poses.are_pictures && !frames; }
  int frame_count() const {
    return path.empty() ? 1 : shows_poses() ? int(poses.cameras.size()) : frames.value_or(120);
  }
  /// What stands in the names of picture `n`.
  NameParts parts(int n, const std::string& technique = {}) const;
  /// Pictures to be made of each technique.
  int picture_count() const { return each || sequence ? int(files.size()) : frame_count(); }
  void check_outputs(std::size_t technique_count);
  /// Without any output a window opens.
  void check_window(std::size_t technique_count) const;
  bool has_output() const {
    return publication || !output.empty() || !output_panels.empty() || !output_depth.empty() ||
           !output_index.empty() || !output_normal.empty() || !output_camera.empty();
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
