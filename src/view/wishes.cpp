#include "view/wishes.h"

#include <algorithm>

#include "core/furniture.h"
#include "core/option_text.h"
#include "session/request.h"
#include "view/controls.h"

namespace sfumato::view {
namespace {

std::string joined(const dvec3& v) {
  return number_text(v.x) + "," + number_text(v.y) + "," + number_text(v.z);
}

std::string text_of(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += word + '\n';
  return text;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(' ');
  return first == text.npos ? std::string_view() : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

std::string rows_text(const dmat4& matrix) {
  std::string text;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      text += (text.empty() ? "" : ",") + number_text(matrix[column][row]);
  return text;
}

}  // namespace

DrawRow DrawRow::from(const std::string& rule) {
  DrawRow row;
  const std::size_t colon = std::min(rule.find(':'), rule.size());
  row.selection = trimmed(std::string_view(rule).substr(0, colon));
  const std::string_view rest = trimmed(std::string_view(rule).substr(std::min(colon + 1, rule.size())));
  const std::size_t end = std::min(rest.find(' '), rest.size());
  row.technique = rest.substr(0, end);
  row.parameters = trimmed(rest.substr(end));
  if (row.technique == DrawRule::none) row.technique = "points", row.visible = false;
  return row;
}

std::string DrawRow::rule() const {
  if (!visible) return selection + ": " + DrawRule::none;
  return selection + ": " + technique + (parameters.empty() ? "" : " " + parameters);
}

bool is_kept_as_written(const std::string& option) {
  return option == "filter" || option == "columns" || option == "max-points" || option == "up" ||
         option == "crop-relative" || option == "vertices";
}

void Wishes::set(const std::string& parameter, const std::string& value) {
  analysis::PrepareOptions prepare;
  ParamList list;
  prepare.describe(list);
  if (Param* param = list.find(parameter)) {
    param->set(value);
    if (param->get() == param->default_text)
      analysis.erase(param->name);
    else
      analysis[param->name] = param->get();
    return;
  }
  Look look(technique.empty() ? "points" : technique);
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
}

void Wishes::reset(const std::string& parameter) {
  analysis.erase(parameter);
  shared.erase(parameter);
  if (const auto mine = own.find(technique); mine != own.end()) mine->second.erase(parameter);
}

void Wishes::reset_all() {
  shared.clear();
  own.erase(technique);
}

void Wishes::take(const Look& look) {
  for (std::size_t i = 0; i < look.parameters.all().size(); ++i) {
    const Param& param = look.parameters.all()[i];
    if (param.get() == param.default_text) continue;
    (i < look.own_count ? own[look.name] : shared)[param.name] = param.get();
  }
}

NamesAndValues Wishes::parameters_of(const std::string& technique_name) const {
  NamesAndValues values(shared.begin(), shared.end());
  if (const auto mine = own.find(technique_name); mine != own.end())
    values.insert(values.end(), mine->second.begin(), mine->second.end());
  return values;
}

ColorSettings Wishes::color() const {
  Request request;
  for (const auto& [name, value] : {std::pair("color-by", &color_by),
                                    {"colormap", &colormap},
                                    {"color-range", &color_range},
                                    {"class-colors", &class_colors},
                                    {"exposure", &exposure},
                                    {"color", &point_color}})
    sfumato::set(request, name, *value);
  return request.color;
}

std::optional<vec3> Wishes::background() const {
  Request request;
  sfumato::set(request, "background-color", background_color);
  return request.background;
}

void Wishes::take_input(const NamesAndValues& given) {
  Request request;
  input.clear();
  for (const auto& [name, value] : given) {
    sfumato::set(request, name, value);
    if (is_kept_as_written(name)) input.emplace_back(name, value);
  }
  settle_points(request);
  request.points.read.samples_faces = !request.vertices;
  scene = request.points;
}

SessionOptions Wishes::session_options() const {
  SessionOptions options;
  ParamList list;
  options.prepare.describe(list);
  for (const auto& [name, value] : analysis)
    if (Param* param = list.find(name)) param->set(value);
  options.color = color();
  options.background = background();
  for (const DrawRow& row : draw) options.draw.push_back(DrawRule::parse(row.rule()));
  return options;
}

void Wishes::set_color_range(double a, double b) { color_range = number_text(a) + "," + number_text(b); }

std::vector<scene::SceneFile> Wishes::scene_files() const {
  std::vector<scene::SceneFile> all = scene::files_of(files);
  for (std::size_t n = 0; n < std::min(all.size(), transforms.size()); ++n) all[n].transform = transforms[n];
  return all;
}

NamesAndValues Wishes::options() const {
  NamesAndValues all = input;
  const auto say = [&](const char* name, const std::string& value) { all.emplace_back(name, value); };
  for (const DrawRow& row : draw) say("draw", row.rule());
  const Selection& wanted = scene.selection;
  if (wanted.crop) say("crop", joined(wanted.crop->min) + "," + joined(wanted.crop->max));
  if (!wanted.show_classes.empty()) say("show-classes", classes_text(wanted.show_classes));
  if (const std::string hidden = classes_text(wanted.hide_classes);
      hidden != "7,18" && wanted.show_classes.empty())
    say("hide-classes", hidden);
  if (color_by != "auto" && point_color.empty()) say("color-by", color_by);
  if (!colormap.empty() && point_color.empty()) say("colormap", colormap);
  if (!color_range.empty() && point_color.empty()) say("color-range", color_range);
  if (!class_colors.empty()) say("class-colors", class_colors);
  if (!exposure.empty()) say("exposure", exposure);
  if (!point_color.empty()) say("color", point_color);
  if (!background_color.empty()) say("background-color", background_color);
  if (whole) say("whole", "true");
  if (legend && point_color.empty()) say("legend", "true");
  for (const auto& [name, value] : furniture) say(name.c_str(), value);
  return all;
}

void Wishes::take_options(const NamesAndValues& given) {
  const Wishes plain;
  color_by = plain.color_by, colormap = plain.colormap, color_range = plain.color_range;
  class_colors = plain.class_colors, exposure = plain.exposure, point_color = plain.point_color,
  background_color = plain.background_color;
  furniture.clear();
  legend = plain.legend, whole = plain.whole, draw = plain.draw;
  for (const auto& [name, value] : given) {
    if (name == "color-by") color_by = value;
    if (name == "colormap") colormap = value;
    if (name == "color-range") color_range = value;
    if (name == "class-colors") class_colors = value;
    if (name == "exposure") exposure = value;
    if (name == "color") point_color = value;
    if (name == "background-color") background_color = value;
    if (name == "legend")
      legend = value == "true";
    else if (is_furniture(name))
      furniture.emplace_back(name, value);
    if (name == "whole") whole = value == "true";
    if (name == "draw") draw.push_back(DrawRow::from(value));
  }
}

std::vector<std::string> Wishes::words(int width, int height) const {
  std::vector<std::string> words = files;
  // A value may begin with a minus: the equals sign keeps it with its option.
  const auto say = [&](const std::string& name, const std::string& value) {
    words.push_back("--" + name + "=" + value);
  };
  words.insert(words.end(), {"-t", technique.empty() ? "auto" : technique});
  for (const auto& [name, value] : parameters_of(technique)) say(with_dashes(name), value);
  for (const auto& [name, value] : analysis) say(with_dashes(name), value);
  for (std::size_t n = 0; n < std::min(files.size(), transforms.size()); ++n)
    if (transforms[n]) say("transform", std::to_string(n + 1) + ": " + rows_text(*transforms[n]));
  for (const auto& [name, value] : options())
    if (name == "whole" || name == "legend")
      words.push_back("--" + name);
    else
      say(name, value);
  say("camera-position", joined(camera.position));
  say("camera-focal-point", joined(camera.target));
  say("camera-view-up", joined(camera.up));
  if (camera.fov_deg != 45) say("camera-view-angle", number_text(camera.fov_deg));
  if (camera.orthographic) words.push_back("--camera-orthographic");
  say("resolution", std::to_string(width) + "x" + std::to_string(height));
  return words;
}

std::string Wishes::scene_key() const {
  Wishes read;
  read.whole = whole, read.files = files, read.transforms = transforms, read.draw = draw;
  read.scene = scene, read.input = input, read.analysis = analysis;
  return text_of(read.words(1, 1));
}

std::string Wishes::color_key() const {
  return color_by + '\n' + colormap + '\n' + color_range + '\n' + class_colors + '\n' + exposure + '\n' +
         point_color;
}

std::string Wishes::look_key() const {
  Wishes look = *this;
  look.camera = {};
  look.legend = false, look.furniture.clear();  // drawn over the picture
  return text_of(look.words(1, 1));
}

}  // namespace sfumato::view
