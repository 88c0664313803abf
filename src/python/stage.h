// One cloud on the thread of the OpenGL context, and pictures of it.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cloud.h"
#include "run.h"
#include "session/choice.h"
#include "session/session.h"

namespace sfumato::python {

struct StageOptions {
  std::string technique = automatic_technique;
  Settings parameters;
  ColorSettings color;
  std::optional<vec3> background;  ///< sRGB; nothing: what contrasts with the colours
  bool transparent = false;
  std::optional<UpAxis> up;
  bool whole = false;  ///< rooms with the walls that hide them from outside
  Selection selection;
  std::vector<DrawRule> draw = {};
};

struct ShotRequest {
  std::optional<Camera> camera;          ///< nothing: the first view
  int width = 1280, height = 720;        ///< of the first view
  std::optional<std::string> technique;  ///< nothing: that of the stage
  Settings parameters;                   ///< on top of those of the stage
  std::optional<Camera> light_from;      ///< the light stays where it is for this camera, as along a path
  RenderWants wants;
};

/// A picture and what is known of it. Arrays of Python are views of its images.
struct Shot {
  RenderOutput images;
  Camera camera;
  bool transparent = false;
  std::string technique, reason;
  std::vector<Setting> parameters, analysis_parameters;
  std::string color_by;
  vec3 background{1};
  std::vector<std::string> notes;
};

/// How to look at a cloud; angles in degrees.
struct ViewWishes {
  std::optional<double> azimuth, elevation, fov, distance;
  std::optional<dvec3> look_at;
  double zoom = 1, roll = 0;
  bool orthographic = false, upright = false;
  int width = 1280, height = 720;
};
/// As the options of the command with these names (src/apps/cli/camera_options.h).
Camera view_of(const Pose& pose, const ViewWishes& wishes);

class Stage final : public OnGl {
 public:
  /// Everything that can be wrong before points are touched.
  explicit Stage(StageOptions options);

  // All of these on the thread of the context.
  void open(gl::Context& context, scene::Scene scene, const std::string& file, Progress& progress);
  void set_color(const ColorSettings& color);
  void clear() override;
  void render(gl::Context& context, const ShotRequest& request, Shot& shot, Progress& progress);

  /// The cloud's; once `open`.
  const Pose& pose() const { return pose_; }
  std::size_t points() const { return points_; }
  Choice& choice() { return choice_; }

 private:
  ChosenTechnique& look_for(const ShotRequest& request);
  /// Sets one parameter of a look, or throws Error(usage) that says who has it.
  void set(ChosenTechnique& look, const std::string& name, const std::string& value) const;

  StageOptions options_;
  Choice choice_;
  std::map<std::string, std::unique_ptr<ChosenTechnique>> looks_;  ///< of the techniques that were asked for
  std::unique_ptr<Session> session_;
  Pose pose_;
  std::vector<std::string> notes_;  ///< of reading and selecting
  std::string up_note_;
  std::size_t points_ = 0;
};

}  // namespace sfumato::python
