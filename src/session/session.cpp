#include "session/session.h"

#include "analysis/find_room.h"
#include "analysis/survey.h"
#include "core/error.h"
#include "io/says_up.h"
#include "passes/shadows.h"
#include "session/standpoint.h"
#include "techniques/panorama.h"

namespace sfumato {

Pose stand_upright(scene::Scene& scene, const std::string& file, const std::optional<UpAxis>& asked, bool cutaway) {
  analysis::Upright upright;
  if (asked)
    upright = {*asked, "--up"};
  else if (!file.empty() && io::says_up(file))
    upright = {scene.cloud.up, "the file says so"};
  else
    upright = analysis::guess_upright(scene.cloud);
  scene.cloud.up = upright.up;
  Pose pose{upright, subject_of(scene.cloud)};
  if (!upright.is_camera_view) {
    if (cutaway) pose.subject.room = analysis::find_room(scene.cloud);
    const Standpoint from = standpoint_for(pose.subject, upright.up);
    pose.upright.azimuth_deg = from.azimuth_deg, pose.upright.elevation_deg = from.elevation_deg;
  }
  return pose;
}

Camera first_view(const Pose& pose, int width, int height) {
  Camera camera = frame(pose.subject.box, pose.upright.up, width, height, glm::radians(pose.upright.azimuth_deg),
                        glm::radians(pose.upright.elevation_deg));
  fit(camera, pose.subject);
  return camera;
}

void Session::set_scene(scene::Scene scene, Pose pose, const SessionOptions& options, const ChooseNeeds& needs,
                        Progress& progress) {
  options_ = options;
  pose_ = std::move(pose);
  file_names_ = std::move(scene.file_names);
  const auto needs_of = [&](const PreparedCloud& sorted, const analysis::NeighborTree& tree) {
    Attributes all = needs([&] { return choose_technique(sorted, tree); });
    if (options.color.color_by == "normal") all = all | Attribute::normal;
    return all;
  };
  const std::size_t given = scene.cloud.size();
  PreparedCloud prepared =
      analysis::prepare_by_shape(std::move(scene.cloud), needs_of, options.prepare, progress);
  left_out_ = given - prepared.cloud.size();
  ColorSettings color = options.color;
  color.file_names = file_names_;
  coloring_ = color_points(prepared.cloud, color);
  background_ = options.background.value_or(contrasting_background(coloring_.colors));
  renderer_.set_cloud(std::move(prepared), std::move(coloring_.colors));
  renderer_.set_room(pose_.subject.room);
  coloring_.colors.clear();
  is_empty_ = false;
}

void Session::set_color(const ColorSettings& color) {
  options_.color = color;
  if (color.color_by == "normal")
    analysis::complete(renderer_.prepared(), Attribute::normal, options_.prepare, no_progress());
  ColorSettings named = color;
  named.file_names = file_names_;
  coloring_ = color_points(cloud(), named);
  background_ = options_.background.value_or(contrasting_background(coloring_.colors));
  renderer_.set_colors(std::move(coloring_.colors));
  coloring_.colors.clear();
}

void Session::set_background(const std::optional<vec3>& background) {
  options_.background = background;
  background_ = background.value_or(contrasting_background(renderer_.colors()));
}

void Session::settle(Look& look, Progress& progress) {
  if (is_empty_) throw Error(ErrorCode::usage, "nothing to render: there is no scene yet");
  RenderSettings& settings = look.settings;
  settings.background = background_;
  settings.edl.resolve(look.technique->wants_edl());
  settings.smooth_outlines.resolve(settings.samples == 1 && !look.technique->has_soft_edges());
  resolve_shadow_sizes(settings, bounds(cloud()), prepared().median_spacing);
  analysis::complete(renderer_.prepared(), look.technique->needs(), options_.prepare, progress);
}

RenderOutput Session::render(Look& look, const Camera& camera, const RenderWants& wants, Progress& progress) {
  settle(look, progress);
  return renderer_.render(*look.technique, camera, look.settings, wants, progress);
}

RenderOutput Session::render_panorama(Look& look, const Camera& camera, const RenderWants& wants,
                                      Progress& progress) {
  settle(look, progress);
  return sfumato::render_panorama(renderer_, *look.technique, camera, up_vector(pose_.upright.up), look.settings, wants,
                                  progress);
}

}  // namespace sfumato
