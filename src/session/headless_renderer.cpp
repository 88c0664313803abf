#include "sfumato/renderer.h"

#include "core/error.h"
#include "session/choice.h"
#include "session/drawing.h"
#include "session/notes.h"
#include "session/opening.h"
#include "session/preset.h"

namespace sfumato {

PresetLook read_preset(const std::string& file, const std::string& technique) {
  const Preset preset = load_preset(file);
  PresetLook out;
  out.technique = technique.empty() ? preset.technique : technique;
  out.camera = preset.camera;
  if (out.technique.empty() || out.technique == automatic_technique) return out;
  const Look look(out.technique);
  const Look* const looks[] = {&look};
  for (const auto& [name, value] : preset.parameters_for(looks, {}))
    out.parameters.emplace_back(name.substr(name.find('.') + 1), value);  // without "TECHNIQUE."
  return out;
}

struct HeadlessRenderer::State {
  Drawing drawing;
  Session& session = drawing.session;
  std::optional<TechniqueChoice> choice;  ///< what suits the points, once somebody asked
  std::vector<std::string> notes;         ///< of reading
  bool whole = false;
  std::optional<Opening> opening;  ///< of files with levels, of which each view reads what it shows
  std::optional<std::pair<Camera, bool>> seen;  ///< what they were read for: a camera, and shadows
  SessionOptions options;
  RenderWants wants{.color_linear = true, .depth = true, .normal = true};

  /// Reads what a view of files with levels shows.
  void see(const Camera& camera, bool has_shadows, Progress& progress);
  void show(scene::Scene scene, Pose pose, Progress& progress);
  /// What `name` stands for: "auto" is what suits the points.
  TechniqueChoice resolve(const std::string& name);
};

void HeadlessRenderer::State::show(scene::Scene scene, Pose pose, Progress& progress) {
  drawing.forget_look();
  choice.reset();
  notes = notes_of_reading(scene);
  session.open(std::move(scene), std::move(pose), options, nullptr, progress);
  notes.insert(notes.end(), session.notes().begin(), session.notes().end());
}

void HeadlessRenderer::State::see(const Camera& camera, bool has_shadows, Progress& progress) {
  const std::pair view(camera, has_shadows);
  if (!opening || seen == view) return;
  scene::Scene scene = opening->read({&camera, 1}, has_shadows, progress);
  seen.reset();
  show(std::move(scene), opening->pose(), progress);
  seen = view;
}

TechniqueChoice HeadlessRenderer::State::resolve(const std::string& name) {
  if (name != automatic_technique) return {name, {}};
  if (!choice) choice = session.suggest();
  return *choice;
}

HeadlessRenderer::HeadlessRenderer() : state_(std::make_unique<State>()) {}
HeadlessRenderer::~HeadlessRenderer() = default;

void HeadlessRenderer::set_whole(bool whole) { state_->whole = whole; }

void HeadlessRenderer::open(const SceneRequest& request, Progress& progress) {
  Request wanted;
  wanted.points.read.max_points = request.max_points;
  wanted.points.up = request.up;
  wanted.vertices = request.vertices;
  wanted.hide_classes.clear();
  wanted.whole = state_->whole;
  SessionOptions& options = state_->options = {{}, request.coloring, {}};
  for (const std::string& rule : request.draw) options.draw.push_back(DrawRule::parse(rule));
  const std::vector<std::string> files = scene::expand_inputs(request.files);
  if (files.empty()) throw Error(ErrorCode::usage, "a scene needs a file: name one in SceneRequest::files");
  Opening opening(wanted, scene::files_of(files), progress);
  opening.keep_nodes();
  state_->opening.reset(), state_->seen.reset();
  state_->show(opening.take(), opening.pose(), progress);
  if (opening.has_levels()) state_->opening = std::move(opening);
}

void HeadlessRenderer::set_cloud(PointCloud cloud, const ColorSettings& coloring, Progress& progress) {
  if (cloud.empty()) throw Error(ErrorCode::bad_input, "the cloud has no points to render");
  scene::Scene scene;
  scene.cloud = std::move(cloud);
  state_->opening.reset(), state_->seen.reset();
  Request wanted;
  wanted.points.up = scene.cloud.up;  // what the caller says
  wanted.whole = state_->whole;
  state_->options = {{}, coloring, {}};
  Opening opening(wanted, std::move(scene), progress);
  state_->show(opening.take(), opening.pose(), progress);
}

Camera HeadlessRenderer::first_view(int width, int height) const {
  return state_->session.first_view(width, height);
}

void HeadlessRenderer::set_outputs(const Outputs& outputs) {
  state_->wants.color = outputs.color;
  state_->wants.color_linear = outputs.linear;
  state_->wants.depth = outputs.depth;
  state_->wants.normal = outputs.normal;
}

Pictures HeadlessRenderer::render(const std::string& wanted, const Camera& camera,
                                  const Parameters& parameters, std::optional<vec3> background,
                                  Progress& progress) {
  State& s = *state_;
  if (s.session.empty()) throw Error(ErrorCode::usage, "nothing to render: call open or set_cloud first");
  const TechniqueChoice chosen = s.resolve(wanted);
  Look* look = &s.drawing.look_of(chosen.technique, parameters);
  if (s.opening) {
    s.see(camera, casts_shadows(look->settings.shadows), progress);  // which forgets the look
    look = &s.drawing.look_of(chosen.technique, parameters);
  }
  look->settings.transparent = !background;
  s.session.set_background(background);
  RenderOutput out = s.session.render(*look, camera, s.wants, progress);

  Pictures pictures{std::move(out.rgba8), std::move(out.color_linear),
                    std::move(out.depth), std::move(out.normal),
                    chosen.technique,     chosen.reason};
  for (const auto& [param, value] : look->resolved(out.settings))
    pictures.parameters.emplace_back(param.name, value);
  pictures.notes = s.notes;
  const std::vector<std::string>& of_colors = s.session.coloring().notes;
  pictures.notes.insert(pictures.notes.end(), of_colors.begin(), of_colors.end());
  pictures.notes.insert(pictures.notes.end(), out.notes.begin(), out.notes.end());
  return pictures;
}

std::vector<std::string> HeadlessRenderer::techniques() {
  std::vector<std::string> names;
  for (const TechniqueInfo& info : all_techniques()) names.push_back(info.name);
  return names;
}

}  // namespace sfumato
