#include "view/view_request.h"

#include <algorithm>

#include "analysis/prepare.h"
#include "core/option_text.h"

namespace sfumato::view {
namespace {

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(' ');
  return first == text.npos ? std::string_view() : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

std::string rows_text(const dmat4& matrix) {
  std::string text;
  for (const double number : rows_of(matrix)) text += (text.empty() ? "" : ",") + number_text(number);
  return text;
}

/// Whether windows show what it says, other than by their camera.
bool is_shown(const Option& option) {
  return (option.scope == Option::Scope::look || option.scope == Option::Scope::place) &&
         option.name() != "vertical-exaggeration" && option.name() != "no-background";
}

/// The list of what the analysis is told.
struct AnalysisParameters {
  explicit AnalysisParameters(const ViewRequest::Values& values = {}) {
    options.describe(list);
    for (const auto& [name, value] : values)
      if (Param* param = list.find(name)) param->set(value);
  }
  AnalysisParameters(const AnalysisParameters&) = delete;  // the list points into the options
  AnalysisParameters& operator=(const AnalysisParameters&) = delete;

  analysis::PrepareOptions options;
  ParamList list;
};

void drop_if_empty(std::map<std::string, ViewRequest::Values>& own, const std::string& technique) {
  if (const auto mine = own.find(technique); mine != own.end() && mine->second.empty()) own.erase(mine);
}

}  // namespace

ViewRequest::ViewRequest(const Request& request, const std::vector<scene::SceneFile>& files_of_request)
    : Request(request) {
  for (const DrawRule& rule : std::exchange(draw, {})) items.push_back(DrawRow::from(rule.text));
  for (const scene::SceneFile& file : files_of_request) placed.push_back(file.transform);
  technique.clear(), transforms.clear(), view = {};
  furniture.print_scale = furniture.dpi = 0;  // of paper
}

DrawRow DrawRow::from(const std::string& rule) {
  DrawRow row;
  const std::size_t colon = std::min(rule.find(':'), rule.size());
  row.selection = trimmed(std::string_view(rule).substr(0, colon));
  const std::string_view rest = trimmed(std::string_view(rule).substr(std::min(colon + 1, rule.size())));
  const std::size_t end = std::min(rest.find(' '), rest.size());
  row.technique = rest.substr(0, end);
  row.parameters = trimmed(rest.substr(end));
  if (row.technique == DrawRule::none) row.technique = stand_in_technique, row.visible = false;
  return row;
}

std::string DrawRow::rule() const {
  if (!visible) return selection + ": " + DrawRule::none;
  return selection + ": " + technique + (parameters.empty() ? "" : " " + parameters);
}

void ViewRequest::set(const std::string& parameter, const std::string& value) {
  AnalysisParameters defaults;
  if (Param* param = defaults.list.find(parameter)) {
    param->set(value);
    if (param->get() == param->default_text)
      analysis.erase(param->name);
    else
      analysis[param->name] = param->get();
    return;
  }
  Look look(technique.empty() ? stand_in_technique : technique);
  look.set(parameter, value);
  const auto& all = look.parameters.all();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (&all[i] != look.parameters.find(parameter)) continue;
    Values& values = i < look.own_count ? own[look.name] : shared;
    if (all[i].get() == all[i].default_text)
      values.erase(all[i].name);
    else
      values[all[i].name] = all[i].get();
  }
  drop_if_empty(own, look.name);
}

void ViewRequest::reset(const std::string& parameter) {
  analysis.erase(parameter);
  shared.erase(parameter);
  if (const auto mine = own.find(technique); mine != own.end()) mine->second.erase(parameter);
  drop_if_empty(own, technique);
}

void ViewRequest::reset_all() {
  shared.clear();
  own.erase(technique);
}

void ViewRequest::take(const Look& look) {
  for (std::size_t i = 0; i < look.parameters.all().size(); ++i) {
    const Param& param = look.parameters.all()[i];
    if (param.get() == param.default_text) continue;
    (i < look.own_count ? own[look.name] : shared)[param.name] = param.get();
  }
}

NamesAndValues ViewRequest::parameters_of(const std::string& technique_name) const {
  NamesAndValues values(shared.begin(), shared.end());
  if (const auto mine = own.find(technique_name); mine != own.end())
    values.insert(values.end(), mine->second.begin(), mine->second.end());
  return values;
}

SessionOptions ViewRequest::session_options() const {
  SessionOptions options;
  options.prepare = AnalysisParameters(analysis).options;
  options.color = color;
  options.background = background;
  for (const DrawRow& row : items) options.draw.push_back(DrawRule::parse(row.rule()));
  return options;
}

std::vector<scene::SceneFile> ViewRequest::scene_files() const {
  std::vector<scene::SceneFile> all = scene::files_of(files);
  for (std::size_t n = 0; n < std::min(all.size(), placed.size()); ++n) all[n].transform = placed[n];
  return all;
}

NamesAndValues ViewRequest::options() const {
  Request said = *this;
  for (const DrawRow& row : items) said.draw.push_back(DrawRule::parse(row.rule()));
  if (color.solid)  // which wins over these, and the command refuses them beside it
    said.color.color_by = "auto", said.color.colormap.clear(), said.color.range.reset(),
    said.furniture.legend = false;
  NamesAndValues all;
  for (const Option& option : request_options())
    if (is_shown(option))
      for (const std::string& text : option.texts(said)) all.emplace_back(option.name(), text);
  return all;
}

void ViewRequest::take_options(const NamesAndValues& given, bool with_points) {
  const auto of_points = [](const Option& option) { return option.group == "Points"; };
  std::vector<std::pair<const Option*, std::string>> shown;
  for (const auto& [name, value] : given)
    if (const Option* option = find_option(name); option && is_shown(*option)) {
      shown.emplace_back(option, value);
      with_points = with_points || of_points(*option);
    }
  for (const Option& option : request_options())
    if (is_shown(option) && (with_points || !of_points(option))) option.reset(*this);
  for (const auto& [option, value] : shown) option->set(*this, "--" + option->name(), value);
  items.clear();
  for (const DrawRule& rule : std::exchange(draw, {})) items.push_back(DrawRow::from(rule.text));
  (void)scene_options();
}

std::vector<Control> ViewRequest::analysis_controls(const std::string& group) const {
  return controls_of(AnalysisParameters(analysis).list, group);
}

bool ViewRequest::shows_class(int id) const {
  const std::vector<int>& only = points.selection.show_classes;
  const std::vector<int>& named = only.empty() ? hide_classes : only;
  return (std::find(named.begin(), named.end(), id) != named.end()) != only.empty();
}

std::unique_ptr<Look> ViewRequest::make_look() const {
  auto look = std::make_unique<Look>(technique.empty() ? stand_in_technique : technique);
  for (const auto& [name, value] : parameters_of(look->name)) look->set(name, value);
  return look;
}

std::unique_ptr<Choice> ViewRequest::make_choice(const NamesAndValues& given) const {
  auto choice = std::make_unique<Choice>(technique.empty() ? automatic_technique : technique);
  for (const auto& chosen : choice->techniques)
    for (const auto& [name, value] : parameters_of(chosen->name)) chosen->set(name, value);
  choice->given = given;
  return choice;
}

RenderSettings ViewRequest::settings() const {
  RenderSettings settings;
  ParamList parameters;
  settings.describe(parameters);
  for (const auto& [name, value] : shared) parameters.find(name)->set(value);
  return settings;
}

void ViewRequest::take(const Preset& from) {
  const SceneKey before = scene_key();
  if (!from.technique.empty() && from.technique != "auto") technique = find_technique(from.technique).name;
  reset_all();
  const std::unique_ptr<Look> look = make_look();
  const Look* const looks[] = {look.get()};
  for (const auto& [name, value] : from.parameters_for(looks, AnalysisParameters().list))
    set(name.substr(name.find('.') + 1), value);  // without "TECHNIQUE."
  const bool is_scene = !from.files.empty();
  take_options(from.options, is_scene);
  if (!is_scene) return;
  files.clear(), placed.clear();
  for (const scene::SceneFile& file : from.files)
    files.push_back(file.name), placed.push_back(file.transform);
  if (from.camera)
    place(ViewCamera::from(*from.camera));
  else if (scene_key() != before)
    frame_on_load = true;
}

void ViewRequest::save(const std::string& file, const std::optional<Camera>& seen) const {
  const std::unique_ptr<Look> look = make_look();
  const Look* const looks[] = {look.get()};
  sfumato::save_preset(file, looks, AnalysisParameters(analysis).list, options(), seen,
                       seen ? scene_files() : std::vector<scene::SceneFile>());
}

std::vector<std::string> ViewRequest::words(int width, int height) const {
  std::vector<std::string> words = files;
  // A value may begin with a minus: the equals sign keeps it with its option.
  const auto say = [&](const std::string& name, const std::string& value) {
    const Option* option = find_option(name);
    words.push_back("--" + name + (option && option->kind == Option::Kind::flag ? "" : "=" + value));
  };
  words.insert(words.end(), {"-t", technique.empty() ? "auto" : technique});
  for (const auto& [name, value] : parameters_of(technique)) say(with_dashes(name), value);
  for (const auto& [name, value] : analysis) say(with_dashes(name), value);
  for (std::size_t n = 0; n < std::min(files.size(), placed.size()); ++n)
    if (placed[n]) say("transform", std::to_string(n + 1) + ": " + rows_text(*placed[n]));
  for (const auto& [name, value] : options()) say(name, value);
  Request seen;
  seen.view.position = camera.position, seen.view.focal_point = camera.target;
  seen.view.view_up = camera.up, seen.view.orthographic = camera.orthographic;
  if (camera.fov_deg != 45) seen.view.fov = camera.fov_deg;
  seen.view.size = {width, height};
  for (const Option& option : request_options())
    for (const std::string& text : option.texts(seen)) say(option.name(), text);
  return words;
}

SceneKey ViewRequest::scene_key() const {
  SceneKey key{scene_files(), {}, points, hide_classes, vertices, whole, analysis};
  for (const DrawRow& row : items) key.draw.push_back(row.rule());
  key.points.read.strict = false;  // the same points, or none
  return key;
}

ViewRequest ViewRequest::look() const {
  ViewRequest look = *this;
  look.camera = look.home = {};
  look.frame_on_load = false;
  look.furniture = {};
  return look;
}

}  // namespace sfumato::view
