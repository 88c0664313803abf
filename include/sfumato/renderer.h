// From a cloud to pictures without a display: what the command does, as one
// class.
//
//   sfumato::HeadlessRenderer renderer;
//   renderer.open({{"scan.laz"}});
//   const sfumato::Pictures p = renderer.render("auto", renderer.first_view(1280, 720));
//   sfumato::io::write_png("scan.png", p.color, false);
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sfumato/cloud.h"

namespace sfumato {

/// Names and values as on the command line: {"point_size", "3"}, {"shading", "albedo"}, {"s0", "auto"}.
using Parameters = std::vector<std::pair<std::string, std::string>>;

/// Input of a scene of several files; the fields are options of the command.
struct SceneRequest {
  std::vector<std::string> files;  ///< names, folders, patterns with * ? [ ]
  std::vector<std::string> draw =
      {};  ///< rules, the first that selects a point draws it: "classification 6: surface"
  ColorSettings coloring = {};
  std::optional<std::uint64_t> max_points = {};  ///< a deterministic subsample of the whole scene
  std::optional<UpAxis> up = {};                 ///< nullopt: from the files, else guessed from the shape
  bool vertices = false;                         ///< of meshes the vertices, instead of points on the faces
};

/// The look in a preset or scene of the command.
struct PresetLook {
  std::string technique;  ///< empty: it names none
  Parameters parameters;  ///< those that the technique has
  std::optional<Camera> camera;
};
/// `technique` empty: that of the preset. Throws Error(bad_input) that names file and key, Error(usage) for
/// an unknown technique.
PresetLook read_preset(const std::string& file, const std::string& technique = {});

/// Which outputs are read back from the GPU; fewer are faster.
struct Outputs {
  bool color = true, linear = true, depth = true, normal = true;
};

/// One view, top row first; outputs that were not requested are empty.
struct Pictures {
  Image<Rgba8> color;              ///< sRGB, straight alpha
  Image<vec4> linear;              ///< linear, premultiplied; alpha is coverage when transparent, else 1
  Image<float> depth;              ///< along the view axis, scene units, +inf where nothing
  Image<vec3> normal;              ///< world, unit, facing the camera, 0 where none
  std::string technique, reason;   ///< the technique used; the reason of "auto"
  Parameters parameters;           ///< every value used, automatic ones resolved
  std::vector<std::string> notes;  ///< notes of reading, automatic choices and drawing
};

/// Owns an OpenGL context: use each instance on the thread that made it. Several instances, on one thread or
/// on several, are independent; another context that is current on the thread (EGL) stays current.
class HeadlessRenderer {
 public:
  /// Throws Error(no_gl) that says what is missing where there is no OpenGL 4.5.
  HeadlessRenderer();
  ~HeadlessRenderer();
  HeadlessRenderer(const HeadlessRenderer&) = delete;
  HeadlessRenderer& operator=(const HeadlessRenderer&) = delete;

  /// Keeps the walls of rooms between them and the camera (--whole), from the next scene on.
  void set_whole(bool whole);
  /// Reads files as the scene. Of COPC files with more points than 40 million, or than `max_points`, each
  /// picture reads what it shows, as the command does. Throws Error(io) or Error(bad_input) that names the
  /// file, Error(usage) for rules and colours that the points cannot have.
  void open(const SceneRequest& request, Progress& progress = no_progress());
  /// Sorts the cloud, measures its spacing and colours it. Throws Error(bad_input) for a cloud without
  /// points, Error(usage) for a colour source that it does not have.
  void set_cloud(PointCloud cloud, const ColorSettings& coloring = {}, Progress& progress = no_progress());
  /// The first view that the command chooses (docs/first_look.md), from azimuth -30 and elevation 30 degrees
  /// where nothing tells another. It shows all but outliers.
  Camera first_view(int width, int height) const;
  /// Applies to the following pictures.
  void set_outputs(const Outputs& outputs);
  /// `technique`: a name, or "auto" for what suits the points. `background` is sRGB 0..1 (white; the
  /// command chooses its own), or nothing for a transparent picture. Attributes that the technique needs and
  /// the cloud does not have are computed once and kept. Throws Error(usage) for an unknown technique or
  /// parameter and before a cloud was set; Cancelled when `progress` asks for it.
  Pictures render(const std::string& technique, const Camera& camera, const Parameters& parameters = {},
                  std::optional<vec3> background = vec3(1), Progress& progress = no_progress());

  /// Names of the techniques, in the order of the documentation.
  static std::vector<std::string> techniques();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sfumato
