// All that decides what a window shows, as a value: what is read, how it is drawn, from where. It can be said
// as a command that writes the same picture, and two of them are the same when their commands are.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analysis/prepare.h"
#include "scene/scene.h"
#include "session/look.h"
#include "session/preset.h"
#include "session/session.h"
#include "view/navigator.h"

namespace sfumato::view {

/// A row of the list of items: a rule of --draw that can be switched off without being forgotten.
struct DrawRow {
  std::string selection, technique, parameters;  ///< as in "SELECTION: TECHNIQUE [name=value ...]"
  bool visible = true;                           ///< else its points are drawn by nothing

  static DrawRow from(const std::string& rule);
  /// As --draw takes it.
  std::string rule() const;
};

struct Wishes {
  using Values = std::map<std::string, std::string>;  ///< parameters that are not at their defaults

  std::vector<std::string> files;
  std::vector<std::optional<dmat4>> transforms;  ///< of the first files: world from file
  scene::SceneOptions scene;
  /// Options of the command line that say what `scene` says in ways that no panel changes (--filter,
  /// --columns, --up,
  /// --max-points, --crop-relative): kept as they were written.
  NamesAndValues input;
  Values analysis;
  std::string technique;              ///< empty: what suits the scan
  std::map<std::string, Values> own;  ///< by technique
  Values shared;                      ///< those that every technique has
  std::string color_by = "auto", colormap, color_range, class_colors, exposure, point_color,
              background_color;  ///< as options
  bool legend = false;
  NamesAndValues furniture;  ///< other options of labels/furniture.h
  bool whole = false;        ///< rooms with the walls before them
  std::vector<DrawRow>
      draw;  ///< the first that selects a point draws it; the others are drawn by `technique`
  ViewCamera camera;
  ViewCamera home;            ///< the first view of these files
  bool frame_on_load = true;  ///< both are yet to be found, by what the files hold

  /// The files are seen from there first.
  void place(const ViewCamera& first) { camera = home = first, frame_on_load = false; }

  /// A parameter of `technique`, of all techniques, or of the analysis. Throws Error(usage) as Look::set
  /// does.
  void set(const std::string& parameter, const std::string& value);
  /// Back to what it is by default.
  void reset(const std::string& parameter);
  /// Every parameter of the technique and the shared ones.
  void reset_all();
  /// Takes over what is not at its default in a look.
  void take(const Look& look);

  /// So that not even the time of a GPS loses a digit.
  void set_color_range(double a, double b);
  /// Takes over colours, items and what else `options` says of the picture; what is not given is as by
  /// default.
  void take_options(const NamesAndValues& given);
  /// Takes over which points there are, likewise.
  void take_input(const NamesAndValues& given);

  /// What a Look of that technique must be given.
  NamesAndValues parameters_of(const std::string& technique_name) const;
  /// Throws Error(usage) for what is not understood.
  SessionOptions session_options() const;
  std::vector<scene::SceneFile> scene_files() const;
  ColorSettings color() const;             ///< throws so as well
  std::optional<vec3> background() const;  ///< likewise

  /// The words after `sfumato` that draw this at a size: -o and its file are not among them.
  std::vector<std::string> words(int width, int height) const;
  /// The options among them that a preset keeps: what is not a parameter.
  NamesAndValues options() const;
  /// What must be read or sorted anew when it changes; what must be coloured anew.
  std::string scene_key() const;
  std::string color_key() const;
  /// Everything but the camera.
  std::string look_key() const;
  bool operator==(const Wishes& other) const { return words(1, 1) == other.words(1, 1); }
};

/// Whether an option that says which points there are is kept in `Wishes::input`.
bool is_kept_as_written(const std::string& option);

}  // namespace sfumato::view
