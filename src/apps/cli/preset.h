// Presets: everything that decides how a picture looks, as a JSON file that reproduces it.
//
//   {"technique": "points", "parameters": {"shadows": "hard", "points": {"point_size": 2}},
//    "options": {"color-by": "elevation"}, "camera": {...}}
//
// Parameters of a technique stand under its name (or as "points.point_size"); those of techniques that are not chosen
// wait. A preset acts like its options written before those of the command line, which therefore win. Defaults of the
// user's own have the same form.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "command_line.h"
#include "core/camera.h"
#include "parameters.h"

namespace sfumato::cli {

struct Preset {
  std::string technique;  ///< empty: the preset names none
  Words options;          ///< as words of a command line
  std::vector<std::pair<std::string, std::string>> parameters;  ///< names, maybe qualified, and values
  std::optional<Camera> camera;
  std::string file;  ///< for messages

  /// Options, and the parameters that the chosen techniques have. Throws Error(bad_input) for a parameter that no
  /// technique has.
  Words words_for(const Choice& choice) const;
};

/// Throws Error(bad_input) that names file and key.
Preset load_preset(const std::filesystem::path& file);

/// $SFUMATO_CONFIG (empty: none), else config.json in $XDG_CONFIG_HOME/sfumato or ~/.config/sfumato when it is there.
Preset load_config();

/// `given`: the options of the command line (and of a preset it loaded); those that name files are left out.
/// Every parameter is written, also those at their default, so that the picture outlives a change of
/// defaults.
void save_preset(const std::filesystem::path& file, const Choice& choice,
                 const std::vector<std::pair<std::string, std::string>>& given,
                 const std::optional<Camera>& camera);

}  // namespace sfumato::cli
