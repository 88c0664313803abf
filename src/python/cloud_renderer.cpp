#include "cloud_renderer.h"

#include <algorithm>

#include "core/error.h"
#include "passes/light.h"
#include "session/notes.h"
#include "session/point_index.h"

namespace sfumato::python {
namespace {

/// The names that a parameter may have been meant to be.
std::vector<std::string> names_of(Choice& choice) {
  std::vector<std::string> names;
  for (const auto& look : choice.techniques)
    for (const Param& param : look->parameters.all()) names.push_back(param.name);
  for (const Param& param : choice.prepare_parameters.all()) names.push_back(param.name);
  return names;
}

[[noreturn]] void refuse_parameter(const std::string& name, const std::string& technique,
                                   const std::vector<std::string>& names) {
  if (const std::string owners = techniques_with(name); !owners.empty())
    throw Error(ErrorCode::usage, name + " is a parameter of " + owners + ", not of " + technique);
  refuse_name(technique == automatic_technique ? "no technique has a parameter"
                                               : "the technique " + technique + " has no parameter",
              name, names);
}

/// "points.size" of the technique points is its "size"; of other techniques, nothing.
std::optional<std::string> own_name(const std::string& name, const std::string& technique) {
  const std::size_t dot = name.find('.');
  if (dot == std::string::npos) return name;
  if (name.substr(0, dot) != technique) return std::nullopt;
  return name.substr(dot + 1);
}

}  // namespace

CloudRenderer::CloudRenderer(CloudRendererOptions options)
    : options_(std::move(options)), choice_(options_.request.technique) {
  if (choice_.count != 1)
    throw Error(ErrorCode::usage,
                "technique: '" + options_.request.technique + "' names several; render them one by one");
  const auto find = [&](const std::string& name) {
    std::vector<Param*> found = choice_.find(name);
    for (const auto& look : choice_.techniques)
      if (const auto own = own_name(name, look->name); own && *own != name)
        if (Param* param = look->parameters.find(*own)) found.push_back(param);
    return found;
  };
  // What is given wins over the preset, whose parameters of techniques that are not drawn wait.
  for (const auto& [name, value] : options_.preset.parameters)
    for (Param* param : find(name)) param->set(value);
  for (const auto& [name, value] : options_.parameters) {
    const std::vector<Param*> found = find(name);
    if (found.empty()) refuse_parameter(name, options_.request.technique, names_of(choice_));
    for (Param* param : found) param->set(value);
  }
  choice_.given = options_.parameters;
  for (const auto& each : options_.preset.parameters_for(choice_.looks(), choice_.prepare_parameters))
    choice_.given.push_back(each);
  for (const auto& look : choice_.techniques) look->check();
}

void CloudRenderer::open(gl::Context& context, scene::Scene scene, const Pose& pose, Progress& progress) {
  has_all_points_ = !scene.levels;
  notes_ = notes_of_reading(scene);
  const auto add = [&](const std::string& note) {
    if (!note.empty()) notes_.push_back(note);
  };
  add(note_on_levels(scene, FrontEnd::python));
  add(note_on_hidden(scene, {}, FrontEnd::python));
  crs_ = scene.cloud.crs;
  const Request& request = options_.request;
  const Camera first = sfumato::first_view(pose, 1280, 720);
  for (const Note& note : notes_on(pose, {&first, 1})) add(worded(note, FrontEnd::python));
  session_ = std::make_unique<Session>(context);
  session_->open(std::move(scene), pose, {choice_.prepare, request.color, request.background, request.draw},
                 &choice_, progress);
  notes_.insert(notes_.end(), session_->notes().begin(), session_->notes().end());
  ChosenTechnique& chosen = *choice_.techniques.front();
  if (!chosen.reason.empty()) add(worded(note_on_technique(chosen.name, chosen.reason), FrontEnd::python));
  add(note_on_left_out(session_->left_out(), FrontEnd::python));
  points_ = 0;
  for (std::size_t part = 0; part < session_->parts().size(); ++part) points_ += session_->cloud(part).size();
}

bool CloudRenderer::has_shadows(const Settings& parameters) const {
  // Asked before anything is read for what is not resolved yet.
  RenderSettings settings;
  ParamList shared;
  settings.describe(shared);
  for (const auto* each : {&options_.preset.parameters, &options_.parameters, &parameters})
    for (const auto& [name, value] : *each)
      if (name.substr(name.find('.') + 1) == "shadows") shared.find("shadows")->set(value);
  return casts_shadows(settings.shadows);
}

void CloudRenderer::set_color(const ColorSettings& color) { session_->set_color(color); }

void CloudRenderer::clear() {
  looks_.clear();
  // What techniques hold on the GPU goes before its context does.
  for (const auto* each : {&choice_.techniques, &choice_.passed_over})
    for (const auto& look : *each) look->technique.reset();
  session_.reset();
}

void CloudRenderer::set(ChosenTechnique& look, const std::string& name, const std::string& value) const {
  if (const auto own = own_name(name, look.name))
    if (Param* param = look.parameters.find(*own)) return param->set(value);
  if (choice_.prepare_parameters.find(name))
    throw Error(ErrorCode::usage,
                name + " says how points are measured before rendering; give it to Renderer(...)");
  std::vector<std::string> names;
  for (const Param& param : look.parameters.all()) names.push_back(param.name);
  refuse_parameter(name, look.name, names);
}

ChosenTechnique& CloudRenderer::look_for(const PictureRequest& request) {
  ChosenTechnique& first = *choice_.techniques.front();
  std::string name = request.technique.value_or(first.name);
  if (name == automatic_technique) name = first.reason.empty() ? session_->suggest().technique : first.name;
  ChosenTechnique* look = name == first.name ? &first : nullptr;
  if (!look) {
    auto& other = looks_[name];
    if (!other) other = std::make_unique<ChosenTechnique>(find_technique(name));
    look = other.get();
  }
  look->reset();
  // What was given to the renderer for its own technique is not meant for another one that lacks it.
  for (const auto* each : {&options_.preset.parameters, &options_.parameters})
    for (const auto& [key, value] : *each) {
      const auto own = own_name(key, look->name);
      if (Param* param = own ? look->parameters.find(*own) : nullptr) param->set(value);
    }
  for (const auto& [key, value] : request.parameters) set(*look, key, value);
  look->check();
  look->settings.transparent = options_.request.no_background;
  return *look;
}

void CloudRenderer::render(const PictureRequest& request, RenderedPicture& picture, Progress& progress) {
  if (!session_) throw Error(ErrorCode::usage, "the renderer is closed");
  ChosenTechnique& look = look_for(request);
  const UpAxis up = session_->pose().upright.up;
  picture.camera = request.camera.value_or(session_->first_view(request.width, request.height));
  if (request.panorama && picture.camera.width != 2 * picture.camera.height)
    throw Error(ErrorCode::usage, "size: a panorama is twice as wide as high: (" +
                                      std::to_string(2 * picture.camera.height) + ", " +
                                      std::to_string(picture.camera.height) + ")");
  constexpr int limit = Renderer::largest_side;
  if (picture.camera.width > limit || picture.camera.height > limit)
    throw Error(ErrorCode::usage, std::to_string(picture.camera.width) + "x" +
                                      std::to_string(picture.camera.height) +
                                      " is beyond the largest picture (" + std::to_string(limit) +
                                      " px a side): give a smaller size");
  if (request.index && (request.panorama || !has_all_points_))
    throw Error(ErrorCode::usage, request.panorama
                                      ? "index: it is of one view, not of a panorama"
                                      : "index: it needs all points in memory: give more memory");
  labels::check(request.furniture, picture.camera, up, request.panorama);
  if (request.light_from) fix_light(look.settings, *request.light_from, up);
  progress.update(0, "rendering " + look.name);
  picture.images = request.panorama ? session_->render_panorama(look, picture.camera, request.wants, progress)
                                    : session_->render(look, picture.camera, request.wants, progress);
  if (request.index) picture.index = PointIndex(*session_).of(picture.camera, picture.images.depth);
  picture.transparent = options_.request.no_background;
  picture.up = up, picture.crs = crs_;
  picture.technique = look.name;
  picture.reason = look.reason;
  picture.color_by = session_->coloring().source;
  picture.background = session_->background();
  picture.notes = notes_;
  for (const std::string& note : session_->coloring().notes) picture.notes.push_back(note);
  picture.coloring = session_->coloring();
  const std::string of_legend = note_on_legend(picture.coloring, FrontEnd::python);
  if (request.furniture.legend && !of_legend.empty()) picture.notes.push_back(of_legend);
  if (!picture.images.rgba8.empty())
    labels::draw_furniture(picture.images.rgba8, request.furniture,
                           {picture.camera, up, crs_, picture.coloring, picture.background, request.panorama,
                            session_->pose().vertical_exaggeration});
  for (const std::string& note : picture.images.notes) picture.notes.push_back(look.name + ": " + note);
  for (const auto& [param, value] : look.resolved(picture.images.settings))
    picture.parameters.push_back({param.name, param.kind, param.can_be_auto, value});
  picture.analysis_parameters = resolved(choice_.prepare_parameters);
}

}  // namespace sfumato::python
