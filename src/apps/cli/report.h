// What the commands print with --json.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "copc/tree.h"
#include "core/classes.h"
#include "io/io.h"
#include "parameters.h"
#include "scene/scene.h"
#include "techniques/renderer.h"

namespace sfumato::cli {

std::string info_json(const io::ReadReport& report, double median_spacing,
                      const std::vector<ClassShare>& classes);

/// What header and hierarchy of a COPC file or of tiles tell, without its points.
io::ReadReport report_of(const copc::Tree& tree);

/// Of a COPC file, without reading its points: no values of attributes, no median spacing, but levels.
std::string tree_json(const copc::Tree& tree);

/// One technique as an object when `name` is given, else the list of all.
std::string techniques_json(const std::string& name);

/// What one technique did, over all frames.
struct TechniqueReport {
  std::vector<PassTiming> passes;  ///< of the last frame
  double total_ms = 0;             ///< GPU, of the last frame
  std::uint64_t points_drawn = 0;
  std::uint64_t outliers = 0;  ///< points that it left out as such
  std::vector<std::string> notes;
};

struct RenderReport {
  std::vector<std::string> outputs;
  std::uint64_t points_read = 0, points_hidden = 0, points_rendered = 0;
  std::uint64_t points_left_out = 0;  ///< by crop, classes to show and filters
  int blank_pictures = 0;             ///< that show nothing but background
  std::string color_by;
  double exposure = 1;  ///< of the file's colours
  vec3 background{1};
  bool cutaway = false;                       ///< a room is drawn without the walls before it
  std::string up, up_reason;                  ///< the axis and why it is that one
  bool up_is_noted = false;                   ///< with how to turn it
  std::optional<double> share_outside;        ///< of the points, that the first view does not hold
  std::optional<scene::LevelsReport> levels;  ///< of the last scene that was read by its levels
  std::uint64_t points_missing = 0;           ///< of those read, in damaged parts
  bool is_partial = false;                    ///< parts of files were damaged and left out
  int frames = 1;
  struct Draw {
    std::string rule, technique;
    std::size_t points;  ///< of all rules that draw alike
  };
  std::vector<Draw> draw;
  std::vector<TechniqueReport> techniques;                ///< in the order of the choice
  std::map<std::string, RenderSettings> settings;         ///< of the last picture by each technique
  std::vector<std::pair<std::string, double>> stages_ms;  ///< wall time: read, prepare, render, write
};

/// The value of each parameter of the look (Look::resolved) in its last picture.
ParamValues last_values(const RenderReport& report, const Look& look);

/// One technique: `technique` is its name, `parameters` and `timings_ms` are flat. Several: `technique` is
/// the list, and both are keyed by technique.
std::string render_json(const RenderReport& report, const Choice& choice, const std::string& camera_json);

}  // namespace sfumato::cli
