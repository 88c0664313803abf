// All that a person can ask of a rendering, as a value: what is read, what is kept of it, how it is drawn,
// from where, and what is written. Parameters of techniques are in looks (session/look.h); everything else is
// here, and one table says what it is called.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/coloring.h"
#include "core/furniture.h"
#include "core/units.h"
#include "scene/leveled_scene.h"
#include "session/draw_rule.h"
#include "session/camera_request.h"

namespace sfumato {

struct Request {
  // What is read.
  std::vector<std::string> files;
  std::vector<std::string> transforms;  ///< "N: 16 numbers", of the N-th file
  std::string preset, scene;            ///< files with more of a request, or all of it
  bool each = false;                    ///< every file is a picture of its own
  bool sequence = false;                ///< every file is a picture, all from the camera of the first
  bool watch = false;                   ///< a window reads files again when they change
  std::uint64_t memory = scene::default_memory;  ///< of the points of COPC files
  std::optional<std::uint64_t> gpu_memory;

  // What is kept of it; `scene_options` says all of it to whoever reads.
  scene::SceneOptions points;
  std::vector<int> hide_classes{7, 18};  ///< with withheld points; none: nothing is left out
  bool vertices = false;                 ///< of meshes, in place of points on the faces

  // How it is drawn.
  std::string technique;
  std::vector<DrawRule> draw;
  ColorSettings color;
  std::optional<vec3> background;  ///< sRGB; nothing: what contrasts with the colours
  bool no_background = false;
  Furniture furniture;
  std::string shader_folder;

  // From where.
  CameraRequest view;
  std::string camera_file;  ///< wins over the `view.start` of a preset
  bool whole = false;       ///< rooms with the walls before them
  bool panorama = false;
  std::optional<double> exaggeration;  ///< of heights
  std::string path;                    ///< a file of key frames, or "orbit"
  std::optional<int> frames;
  std::optional<double> degrees;  ///< of the orbit

  // What is written.
  std::string output, output_panels, output_depth, output_index, output_normal, output_camera, save_preset,
      save_scene;
  LengthUnit depth_unit;  ///< of a step of depth as PNG; of no length: the range of depths is 65535 steps
  std::optional<int> quality;
  bool world_file = false, timings = false, json = false;

  bool operator==(const Request&) const = default;
  /// Noise is left out unless somebody wants to see just that. Throws Error(usage) for what contradicts
  /// itself.
  scene::SceneOptions scene_options() const;
  double vertical_exaggeration() const { return exaggeration.value_or(1); }
  /// Pixels an inch on paper; 0 where nobody means paper.
  double dpi() const { return view.dpi.value_or(view.print_scale ? 300 : 0); }
  /// Whether a place, a distance or a zoom was given, or a whole camera, and not only a side.
  bool stands_somewhere() const;
  /// Whether an option was given that may turn or move the camera away from the points.
  bool moves_camera() const;
};

/// A row of the table: --help, presets and scenes, completions, the window and Python are made of it.
struct Option {
  enum class Kind { flag, text, texts };  ///< texts: may be given several times
  /// command: of the command line alone. file: how a picture is written. place: of a scene, for it holds for
  /// its files only. look: of any scan. view, camera: from where; a scene's camera has in it what `camera`
  /// says.
  enum class Scope { command, file, place, look, view, camera };

  std::string names;  ///< "-o,--output"
  std::string metavar, help, group;
  Kind kind = Kind::text;
  Scope scope = Scope::command;
  bool served = false;  ///< may be asked for over a network: it names no file, and does not outlive a picture
  std::string keyword, value;  ///< of Python, and what kind of value it takes there; empty: none
  /// Throws Error(usage) for values that are none.
  std::function<void(Request&, const std::string& option, const std::string& text)> set;
  std::function<void(Request&)> reset;  ///< to what it is by default
  /// As `set` takes them, so that another request becomes the same; none where it is as by default.
  std::function<std::vector<std::string>(const Request&)> texts;

  std::string name() const { return names.substr(names.find("--") + 2); }
};

const std::vector<Option>& request_options();
/// By its long name; null when there is none.
const Option* find_option(std::string_view name);

/// Sets the option of that name, "color-range". Throws Error(usage) for values that are none.
void set(Request& request, std::string_view name, const std::string& value);
/// The value of the option of that name as `set` takes it; empty: as by default.
std::string text_of(const Request& request, std::string_view name);

/// Refuses what contradicts itself, before anything is read; a named side becomes its angles, a panorama gets
/// its size.
void resolve_view(Request& request);
void check_color(const Request& request);
/// `whose`: the camera that `view.start` is.
void check_camera(const Request& request, const std::string& whose);
/// Reads --camera FILE into `view.start`: a wrong one should not cost the time of reading a large scan.
void read_camera_file(Request& request);

}  // namespace sfumato
