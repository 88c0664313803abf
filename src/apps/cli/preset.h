// Presets: everything that decides how a picture looks, as a JSON file that reproduces it.
//
//   {"technique": "points", "parameters": {"point_size": 2}, "options": {"color-by": "elevation"}, "camera":
//   {...}}
//
// Keys of `parameters` may be qualified ("points.point_size"). A preset acts like its options written before
// those of the command line, which therefore win.
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
  Words words;            ///< its options and parameters as words of a command line
  std::optional<Camera> camera;
};

/// Throws Error(bad_input) that names file and key.
Preset load_preset(const std::filesystem::path& file);

/// `given`: the options of the command line (and of a preset it loaded); those that name files are left out.
/// Every parameter is written, also those at their default, so that the picture outlives a change of
/// defaults.
void save_preset(const std::filesystem::path& file, const Choice& choice,
                 const std::vector<std::pair<std::string, std::string>>& given,
                 const std::optional<Camera>& camera);

}  // namespace sfumato::cli
