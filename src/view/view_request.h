// All that decides what a window shows, as a value: what is read, how it is drawn, from where. It can be said
// as a command that writes the same picture.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "session/look.h"
#include "session/preset.h"
#include "session/session.h"
#include "session/request.h"
#include "view/controls.h"
#include "view/navigator.h"

namespace sfumato::view {

/// A row of the list of items: a rule of --draw that can be switched off without being forgotten.
struct DrawRow {
  std::string selection, technique, parameters;  ///< as in "SELECTION: TECHNIQUE [name=value ...]"
  bool visible = true;                           ///< else its points are drawn by nothing
  bool operator==(const DrawRow&) const = default;

  static DrawRow from(const std::string& rule);
  /// As --draw takes it.
  std::string rule() const;
};

/// What must be read or sorted anew when it changes.
struct SceneKey {
  std::vector<scene::SceneFile> files;
  std::vector<std::string> draw;  ///< rules, as --draw takes them
  scene::SceneOptions points;
  std::vector<int> hide_classes;
  bool vertices = false, whole = false;
  std::map<std::string, std::string> analysis;  ///< parameters
  bool operator==(const SceneKey&) const = default;
};

/// A request whose technique, items, places of files and camera a hand changes: `draw`, `transforms` and
/// `view` of the request are empty here.
struct ViewRequest : Request {
  using Values = std::map<std::string, std::string>;  ///< parameters that are not at their defaults

  ViewRequest() = default;
  /// What a window shows of it; `placed`: its files.
  ViewRequest(const Request& request, const std::vector<scene::SceneFile>& placed);

  std::vector<std::optional<dmat4>> placed;  ///< of the first files: world from file
  Values analysis;
  std::map<std::string, Values> own;  ///< by technique
  Values shared;                      ///< those that every technique has
  std::vector<DrawRow>
      items;  ///< the first that selects a point draws it; the others are drawn by `technique`
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

  /// Takes over colours, items and what else `given` says of the picture; what is not given is as by default.
  /// Which points there are only where it says so, or `with_points`.
  void take_options(const NamesAndValues& given, bool with_points = false);
  /// A preset, or a scene with its files and its camera.
  void take(const Preset& from);
  /// As a file that reads back so: the look alone, or, with a camera, the files seen from there.
  void save(const std::string& file, const std::optional<Camera>& seen) const;

  /// Whether the points of a class are drawn.
  bool shows_class(int id) const;
  /// Another source of colours, over the range that suits it.
  void show_source(const std::string& color_by) {
    color.color_by = color_by;
    color.range.reset(), color.solid.reset();
  }

  /// Of the technique, of `stand_in_technique` where none is chosen yet.
  std::unique_ptr<Look> make_look() const;
  /// `auto` where no technique is chosen yet, which must have the parameters `given`.
  std::unique_ptr<Choice> make_choice(const NamesAndValues& given) const;
  /// Parameters of the analysis.
  std::vector<Control> analysis_controls(const std::string& group) const;
  /// What a Look of that technique must be given.
  NamesAndValues parameters_of(const std::string& technique_name) const;
  RenderSettings settings() const;  ///< `shared`, as values
  /// Throws Error(usage) for what is not understood.
  SessionOptions session_options() const;
  std::vector<scene::SceneFile> scene_files() const;

  /// The words after `sfumato` that draw this at a size: -o and its file are not among them.
  std::vector<std::string> words(int width, int height) const;
  /// The options among them that a preset keeps: what is not a parameter.
  NamesAndValues options() const;
  SceneKey scene_key() const;
  /// Without the camera and what is drawn over the picture.
  ViewRequest look() const;
  bool operator==(const ViewRequest&) const = default;
};

}  // namespace sfumato::view
