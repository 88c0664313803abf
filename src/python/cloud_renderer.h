// One cloud on the thread of the OpenGL context, and pictures of it.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cloud.h"
#include "labels/furniture.h"
#include "run.h"
#include "session/choice.h"
#include "session/preset.h"
#include "session/session.h"
#include "session/opening.h"

namespace sfumato::python {

struct CloudRendererOptions {
  Request request;
  Settings parameters;
  Preset preset;  ///< its parameters hold where the technique has them
};

struct PictureRequest {
  std::optional<Camera> camera;          ///< nothing: the first view
  int width = 1280, height = 720;        ///< of the first view
  std::optional<std::string> technique;  ///< nothing: that of the renderer
  Settings parameters;                   ///< on top of those of the renderer
  std::optional<Camera> light_from;      ///< the light stays where it is for this camera, as along a path
  bool panorama = false;                 ///< everything around the camera
  Furniture furniture;                   ///< drawn into the sRGB picture
  RenderWants wants;
  bool index = false;
};

/// A picture and what is known of it. Arrays of Python are views of its images.
struct RenderedPicture {
  RenderOutput images;
  Image<std::int64_t> index;  ///< session/point_index.h
  Camera camera;
  bool transparent = false;
  std::string technique, reason;
  std::vector<Setting> parameters, analysis_parameters;
  std::string color_by;
  vec3 background{1};
  std::vector<std::string> notes;
  Coloring coloring;  ///< without `colors`
  UpAxis up = UpAxis::pos_z;
  std::string crs;
};

/// Writes a picture in the format of its extension. Throws Error(usage) for others.
void save(const RenderedPicture& picture, const std::string& file, const std::string& extension, int quality,
          double dpi);

class CloudRenderer final : public OnGl {
 public:
  /// Everything that can be wrong before points are touched.
  explicit CloudRenderer(CloudRendererOptions options);

  // All of these on the thread of the context.
  void open(gl::Context& context, scene::Scene scene, const Pose& pose, Progress& progress);
  void set_color(const ColorSettings& color);
  void clear() override;
  void render(const PictureRequest& request, RenderedPicture& picture, Progress& progress);

  /// Whether anything is drawn with shadows, with these parameters on top.
  bool has_shadows(const Settings& parameters) const;
  std::size_t points() const { return points_; }
  Choice& choice() { return choice_; }

 private:
  ChosenTechnique& look_for(const PictureRequest& request);
  /// Sets one parameter of a look, or throws Error(usage) that says who has it.
  void set(ChosenTechnique& look, const std::string& name, const std::string& value) const;

  CloudRendererOptions options_;
  Choice choice_;
  std::map<std::string, std::unique_ptr<ChosenTechnique>> looks_;  ///< of the techniques that were asked for
  std::unique_ptr<Session> session_;
  std::vector<std::string> notes_;  ///< of reading and selecting
  std::size_t points_ = 0;
  bool has_all_points_ = true;  ///< else those that a view shows
  std::string crs_;
};

}  // namespace sfumato::python
