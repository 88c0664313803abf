#include "render_request.h"

#include "core/error.h"
#include "core/param.h"

namespace sfumato::cli {
namespace {

/// The parameters and options of a preset as words of a command line.
Words words_of(const Preset& preset, const Choice& choice) {
  Words words;
  for (const auto& values :
       {preset.options, preset.parameters_for(choice.looks(), choice.prepare_parameters)})
    for (const auto& [name, value] : values) words.push_back("--" + name + "=" + value);
  return words;
}

std::pair<Preset, Preset> presets_of(const Words& words) {
  std::pair<Preset, Preset> found;
  if (!CommandLine::listener) found.second = load_config();
  for (const char* option : {"preset", "scene"})
    if (const std::string file = peek(words, 0, option); !file.empty()) found.first = load_preset(file);
  return found;
}

std::string names_of(const Words& words, const std::pair<Preset, Preset>& presets) {
  std::string names = peek(words, 't', "technique");
  for (const std::string& other : {presets.first.technique, presets.second.technique, default_technique()})
    if (names.empty()) names = other;
  if (names != "all") return names;
  names.clear();
  for (const TechniqueInfo& info : all_techniques()) names += (names.empty() ? "" : ",") + info.name;
  return names;
}

}  // namespace

RenderRequest::RenderRequest(const Words& words, const std::string& command, const std::string& description)
    : RenderRequest(words, command, description, presets_of(words)) {}

RenderRequest::RenderRequest(const Words& words, const std::string& command, const std::string& description,
                             std::pair<Preset, Preset> presets)
    : preset(presets.first),
      choice(names_of(words, presets)),
      line(command, description),
      defaults_(presets.second) {
  options.declare(line);
  declare(choice, line);
  options.technique = names_of(words, presets);
}

bool RenderRequest::parse(const Words& words) {
  if (CommandLine::listener) return line.parse({}), false;
  // A layer each: what comes later wins, also over names qualified by a technique.
  for (const Words& layer : {words_of(defaults_, choice), words_of(preset, choice)})
    if (!layer.empty()) line.parse(layer);
  for (const char* name : excluded_) find_option(name)->reset(options);
  const std::string names = options.technique;
  if (!line.parse(words)) return false;
  options.technique = names;
  options.view.start = preset.camera;
  options.scene_files = preset.files;
  if (!preset.files.empty() && options.scene.empty())
    throw Error(ErrorCode::usage, preset.file + " names files, so it is a scene: --scene " + preset.file);
  if (!options.scene.empty() && options.files.empty())
    for (const scene::SceneFile& file : preset.files) options.files.push_back(file.name);
  return true;
}

void RenderRequest::exclude(std::vector<const char*> names, std::string reason) {
  line.hide(names);
  excluded_ = std::move(names), why_excluded_ = std::move(reason);
}

void RenderRequest::check() {
  for (const char* name : excluded_)
    if (!find_option(name)->texts(options).empty())
      throw Error(ErrorCode::usage,
                  "--" + std::string(name) + " does not go with " + why_excluded_ + ": leave it out");
  choice.given = line.given();
  options.check(choice.count);
  for (const auto& chosen : choice.techniques) chosen->check();
  // A wrong camera file should not cost the time of reading a large scan.
  read_camera_file(options);
  options.expand_files();
}

view::Start view_start(const RenderOptions& options, const Choice& choice) {
  view::Start start;
  view::ViewRequest& request = start.request = view::ViewRequest(options, options.placed());
  if (options.sequence) {
    start.frames = options.placed();
    request.files.resize(1);
  }
  for (const Param& param : choice.prepare_parameters.all())
    if (param.get() != param.default_text) request.analysis[param.name] = param.get();
  for (const auto& chosen : choice.techniques) request.take(*chosen);
  if (!choice.automatic()) request.technique = choice.techniques.front()->name;
  start.memory = options.memory;
  start.watch = options.watch;
  start.shader_folder = options.shader_folder;
  start.given = choice.given;
  start.first_view = options.view;
  return start;
}

}  // namespace sfumato::cli
