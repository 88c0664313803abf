// Presets: everything that decides how a picture looks, as a JSON file that reproduces it.
//
//   {"technique": "points", "parameters": {"shadows": "hard", "points": {"point_size": 2}},
//    "options": {"color-by": "elevation"}, "camera": {...}}
//
// Parameters of a technique stand under its name (or as "points.point_size"); those of techniques that are
// not chosen wait. A preset acts like its options written before those of the command line, which therefore
// win. Defaults of the user's own have the same form.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/camera.h"
#include "scene/scene.h"
#include "session/look.h"

namespace sfumato {

using NamesAndValues = std::vector<std::pair<std::string, std::string>>;

struct Preset {
  std::string technique;      ///< empty: the preset names none
  NamesAndValues options;     ///< with dashes; values as on a command line
  NamesAndValues parameters;  ///< names, maybe qualified, and values
  std::optional<Camera> camera;
  std::vector<scene::SceneFile> files;  ///< of a scene; relative ones start at the folder of the preset
  std::string file;                     ///< for messages

  /// The parameters that the looks have, and those of the analysis. Throws Error(bad_input) for a parameter
  /// that no technique has.
  NamesAndValues parameters_for(std::span<const Look* const> looks, const ParamList& analysis) const;
};

/// World from file, of 16 numbers row by row; nothing where the last row is not 0 0 0 1 or space is
/// flattened.
std::optional<dmat4> transform_of_rows(std::span<const double> rows);
/// Back again.
std::array<double, 16> rows_of(const dmat4& matrix);

/// Throws Error(bad_input) that names file and key.
Preset load_preset(const std::filesystem::path& file);

/// $SFUMATO_CONFIG (empty: none), else config.json in $XDG_CONFIG_HOME/sfumato or ~/.config/sfumato when it
/// is there.
Preset load_config();

/// `given`: the options of the command line (and of a preset it loaded); those that name files are left out.
/// `automatic`: the technique is "auto", and only parameters that are not at their defaults are written, for
/// they choose it. `files` make it a scene, their names relative to the folder of `file`. Every parameter is
/// written, also those at their default, so that the picture outlives a change of defaults.
void save_preset(const std::filesystem::path& file, std::span<const Look* const> looks,
                 const ParamList& analysis, const NamesAndValues& given, const std::optional<Camera>& camera,
                 const std::vector<scene::SceneFile>& files = {}, bool automatic = false);

}  // namespace sfumato
