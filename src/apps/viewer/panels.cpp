// The panels beside the picture.
#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "../cli/command_line.h"
#include "core/colormap.h"
#include "core/error.h"
#include "interface.h"
#include "session/preset.h"

namespace sfumato::viewer {
namespace {

void tooltip(const std::string& text) {
  if (!ImGui::IsItemHovered()) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(28 * ImGui::GetFontSize());
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

void note(const std::string& text) {
  ImGui::PushTextWrapPos(0);
  ImGui::TextDisabled("%s", text.c_str());
  ImGui::PopTextWrapPos();
}

/// A list to choose from; what was chosen, or nothing.
std::optional<std::string> choose(const char* label, const std::string& now, const std::vector<std::string>& all) {
  std::optional<std::string> chosen;
  if (ImGui::BeginCombo(label, now.c_str())) {
    for (const std::string& each : all)
      if (ImGui::Selectable(each.c_str(), each == now)) chosen = each;
    ImGui::EndCombo();
  }
  return chosen;
}

std::string thousands(std::size_t n) {
  std::string text = std::to_string(n);
  for (int at = int(text.size()) - 3; at > 0; at -= 3) text.insert(std::size_t(at), " ");
  return text;
}

float unit(std::uint8_t v) { return float(v) / 255; }

}  // namespace

bool Interface::heading(const char* title, bool open) {
  return ImGui::CollapsingHeader(title, open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
}

std::string Interface::resolved(const std::string& parameter) const {
  const Param* param = look_ ? look_->parameters.find(parameter) : nullptr;
  if (!param) return "";
  if (param->get() == "auto" && picture() && picture()->technique == look_->name)
    for (const auto& [name, value] : picture()->resolved)
      if (name == param->name) return value;
  return param->get();
}

void Interface::set(const std::string& parameter, const std::string& value) {
  bench_.change(parameter, [&](view::Wishes& wishes) { wishes.set(parameter, value); });
}

void Interface::control(view::Control control) {
  ImGui::PushID(control.name.c_str());
  const std::string value = control.is_auto ? resolved(control.name) : control.value;
  std::vector<float> numbers = view::numbers_of(value);
  std::string text = value;
  // The label turns bright where the value is not the default; a click with the right button resets it.
  const std::string label = "##value";
  switch (control.kind) {
    case ParamKind::boolean: {
      bool on = value == "true";
      if (ImGui::Checkbox(label.c_str(), &on)) set(control.name, on ? "true" : "false");
      ImGui::SameLine();
      ImGui::Dummy({std::max(0.0f, ImGui::CalcItemWidth() - ImGui::GetFrameHeight() - ImGui::GetStyle().ItemSpacing.x), 1});
      break;
    }
    case ParamKind::integer: {
      int number = numbers.empty() ? 0 : int(numbers[0]);
      if (ImGui::SliderInt(label.c_str(), &number, int(control.low), int(std::min(control.high, 1e6)))) {
        number = int(std::clamp(double(number), control.limit_low, std::min(control.limit_high, 2e9)));
        set(control.name, std::to_string(number));
      }
      break;
    }
    case ParamKind::real: {
      float number = numbers.empty() ? 0 : numbers[0];
      if (numbers.empty()) control.high = std::max(control.high, control.low + 1);
      const ImGuiSliderFlags flags = control.logarithmic ? ImGuiSliderFlags_Logarithmic : 0;
      if (ImGui::SliderFloat(label.c_str(), &number, float(control.low), float(control.high), "%.4g", flags))
        set(control.name, view::number_text(float(std::clamp(double(number), control.limit_low, control.limit_high))));
      break;
    }
    case ParamKind::choice:
      if (const auto chosen = choose(label.c_str(), value, control.choices)) set(control.name, *chosen);
      break;
    case ParamKind::vector3:
      if (numbers.size() == 3 && ImGui::DragFloat3(label.c_str(), numbers.data(), 0.01f))
        set(control.name, view::number_text(numbers[0]) + "," + view::number_text(numbers[1]) + "," + view::number_text(numbers[2]));
      break;
    case ParamKind::text:
    case ParamKind::real_list:
      if (ImGui::InputText(label.c_str(), &text, ImGuiInputTextFlags_EnterReturnsTrue)) set(control.name, text);
      break;
  }
  tooltip(control.tooltip + (control.can_be_auto || control.kind == ParamKind::boolean ? "" : "\nCtrl+click: type a value"));
  ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
  const auto label_column = [&] { ImGui::SameLine(0.44f * ImGui::GetWindowWidth() + 46 * window_.scale()); };
  if (control.can_be_auto) {
    bool automatic = control.is_auto;
    if (automatic)
      ImGui::TextDisabled("auto");
    else if (ImGui::SmallButton("auto"))
      set(control.name, "auto");
    tooltip(automatic ? "finds its own value, shown here" : "let it find its own value");
  }
  label_column();
  if (control.is_changed)
    ImGui::TextUnformatted(control.label.c_str());
  else
    ImGui::TextDisabled("%s", control.label.c_str());
  tooltip(control.tooltip);
  if (control.is_changed) {
    ImGui::SameLine();
    if (ImGui::SmallButton("×")) bench_.change(control.name, [&](view::Wishes& wishes) { wishes.reset(control.name); });
    tooltip("back to " + control.default_value);
  }
  ImGui::PopID();
}

void Interface::controls(const std::vector<view::Control>& all) {
  for (const view::Control& each : all) control(each);
}

void Interface::technique_panel() {
  const std::string now = bench_.wishes().technique;
  const auto& techniques = all_techniques();
  const float width = (ImGui::GetContentRegionAvail().x - 3 * ImGui::GetStyle().ItemSpacing.x) / 4;
  for (std::size_t i = 0; i < techniques.size(); ++i) {
    if (i % 4) ImGui::SameLine();
    const bool chosen = techniques[i].name == now;
    if (chosen) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_SliderGrab));
    if (chosen) ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(1, 1, 1, 1));
    if (ImGui::Button(techniques[i].name.c_str(), {width, 0}))
      act(view::Action(int(view::Action::technique_1) + int(i)));
    if (chosen) ImGui::PopStyleColor(2);
    tooltip(fmt::format("{}: {}\nkey {}", techniques[i].name, techniques[i].summary, i + 1));
  }
  if (now.empty()) note("looking for the technique that suits the scan");
  if (!bench_.reason().empty()) note("chosen: " + bench_.reason());
  if (picture() && bench_.settled())
    for (const std::string& each : picture()->notes) note(each);
  ImGui::Spacing();
}

void Interface::parameter_panel() {
  if (!heading("Parameters", true)) return;
  ImGui::SetNextItemWidth(-60 * window_.scale());
  ImGui::InputTextWithHint("##search", "search all parameters", &search_);
  ImGui::SameLine();
  if (ImGui::Button("reset")) bench_.change("reset", [](view::Wishes& wishes) { wishes.reset_all(); });
  tooltip("every parameter of this technique back to its default");
  // A search finds parameters of all groups; without one the shared ones have panels of their own.
  std::string group;
  for (const view::Control& each : view::controls_of(*look_, search_)) {
    if (search_.empty() && each.group != look_->name) continue;
    if (!search_.empty() && each.group != group) note(group = each.group);
    control(each);
  }
  if (!search_.empty()) return;
  if (ImGui::TreeNode("finish")) {
    for (const view::Control& each : view::controls_of(*look_))
      if (each.group == "Eye-dome lighting" || each.group == "Picture") control(each);
    ImGui::TreePop();
  }
  if (ImGui::TreeNode("analysis before drawing")) {
    analysis::PrepareOptions options;
    ParamList list;
    options.describe(list);
    for (const auto& [name, value] : bench_.wishes().analysis) list.find(name)->set(value);
    controls(view::controls_of(list, "analysis"));
    ImGui::TreePop();
  }
}

void Interface::color_panel() {
  if (!heading("Colour", false)) return;
  const view::Wishes& wishes = bench_.wishes();
  std::vector<std::string> sources{"auto", "rgb", "elevation", "normal", "clay"};
  if (const view::Loaded* scene = bench_.scene())
    for (const std::string& scalar : scene->scalars)
      if (std::find(sources.begin(), sources.end(), scalar) == sources.end()) sources.push_back(scalar);
  const std::string shown = wishes.color_by == "auto" && picture() ? "auto: " + picture()->coloring.source : wishes.color_by;
  if (const auto chosen = choose("source", shown, sources))
    bench_.change("color-by", [&](view::Wishes& next) { next.color_by = *chosen, next.color_range.clear(), next.point_color.clear(); });
  if (picture() && picture()->coloring.kind == ColorKind::scalar) {
    const Coloring& coloring = picture()->coloring;
    if (const auto chosen = choose("map", wishes.colormap.empty() ? coloring.colormap : wishes.colormap, Colormap::names()))
      bench_.change("colormap", [&](view::Wishes& next) { next.colormap = *chosen; });
    // The map itself, as a bar.
    const Colormap map = Colormap::named(coloring.colormap);
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float width = ImGui::GetContentRegionAvail().x, height = 10 * window_.scale();
    constexpr int steps = 48;
    for (int i = 0; i < steps; ++i) {
      const Rgba8 c = map.at((i + 0.5) / steps);
      ImGui::GetWindowDrawList()->AddRectFilled({at.x + width * float(i) / steps, at.y}, {at.x + width * float(i + 1) / steps + 1, at.y + height},
                                                ImGui::GetColorU32(ImVec4(unit(c.r), unit(c.g), unit(c.b), 1)));
    }
    ImGui::Dummy({width, height});
    float range[2] = {float(coloring.low), float(coloring.high)};
    const float speed = std::max(1e-6f, 0.005f * std::abs(range[1] - range[0]));
    if (ImGui::DragFloat2("range", range, speed, 0, 0, "%.5g") && range[0] != range[1])
      bench_.change("color-range", [&](view::Wishes& next) {
        next.color_range = view::number_text(range[0]) + "," + view::number_text(range[1]);
      });
    tooltip("values at the ends of the colour map: drag, or Ctrl+click to type");
    if (!wishes.color_range.empty()) {
      ImGui::SameLine();
      if (ImGui::SmallButton("×")) bench_.change("color-range", [](view::Wishes& next) { next.color_range.clear(); });
      tooltip("back to 2-98 % of the points");
    }
  }
  const auto color_edit = [&](const char* label, std::string& typed, const std::string& value, auto assign) {
    if (!ImGui::IsAnyItemActive()) typed = value;
    if (ImGui::InputTextWithHint(label, "as it suits", &typed, ImGuiInputTextFlags_EnterReturnsTrue))
      bench_.change(label, [&](view::Wishes& next) { assign(next, typed); });
    tooltip("a name (steelblue), #hex (#4682b4) or R,G,B from 0 to 1; Enter");
  };
  color_edit("background", typed_background_, wishes.background_color,
             [](view::Wishes& next, const std::string& text) { next.background_color = text; });
  color_edit("one colour", typed_point_color_, wishes.point_color,
             [](view::Wishes& next, const std::string& text) { next.point_color = text; });
  bool legend = wishes.legend;
  if (ImGui::Checkbox("legend", &legend)) act(view::Action::legend);
}

void Interface::class_panel() {
  const view::Loaded* scene = bench_.scene();
  if (!scene || scene->classes.empty() || !heading("Classes", false)) return;
  const Selection& selection = bench_.wishes().scene.selection;
  const auto hidden = [&](int id) {
    const auto in = [&](const std::vector<int>& all) { return std::find(all.begin(), all.end(), id) != all.end(); };
    return selection.show_classes.empty() ? in(selection.hide_classes) : !in(selection.show_classes);
  };
  const auto hide = [&](const std::vector<int>& classes) {
    bench_.change("classes", [&](view::Wishes& next) {
      Selection& wanted = next.scene.selection;
      wanted.show_classes.clear();
      wanted.hide_classes = classes;
      wanted.hide_withheld = !classes.empty();
    });
  };
  std::vector<int> now;
  // Noise that this scan lacks stays hidden by default, so that the command stays short.
  for (int id : selection.hide_classes)
    if (std::none_of(scene->classes.begin(), scene->classes.end(), [&](const ClassShare& c) { return c.id == id; }))
      now.push_back(id);
  for (const ClassShare& each : scene->classes)
    if (hidden(each.id)) now.push_back(each.id);
  std::sort(now.begin(), now.end());
  for (const ClassShare& each : scene->classes) {
    ImGui::PushID(each.id);
    bool shown = !hidden(each.id);
    const Rgba8 c = class_color(each.id);
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float side = ImGui::GetFrameHeight();
    ImGui::GetWindowDrawList()->AddRectFilled({at.x, at.y + 0.2f * side}, {at.x + 0.6f * side, at.y + 0.8f * side},
                                              ImGui::GetColorU32(ImVec4(unit(c.r), unit(c.g), unit(c.b), 1)), 2);
    ImGui::Dummy({0.6f * side, side});
    ImGui::SameLine();
    if (ImGui::Checkbox(fmt::format("{} {}", each.id, class_name(each.id)).c_str(), &shown)) {
      std::vector<int> wanted = now;
      std::erase(wanted, each.id);
      if (!shown) wanted.push_back(each.id);
      std::sort(wanted.begin(), wanted.end());
      hide(wanted);
    }
    ImGui::SameLine();
    ImGui::TextDisabled("%s", thousands(each.points).c_str());
    ImGui::SameLine();
    if (ImGui::SmallButton("only")) {
      std::vector<int> others;
      for (const ClassShare& other : scene->classes)
        if (other.id != each.id) others.push_back(other.id);
      hide(others);
    }
    ImGui::PopID();
  }
  if (ImGui::SmallButton("all")) hide({});
}

void Interface::light_panel() {
  if (!heading("Light and shadows", false)) return;
  // A light by direction is dragged over the sky: azimuth and height above the horizon.
  const std::string light = bench_.wishes().shared.contains("light") ? bench_.wishes().shared.at("light") : "headlight";
  const bool by_direction = light.starts_with("dir:");
  if (const auto chosen = choose("comes from", by_direction ? "a direction" : light == "headlight" ? "the eye" : "a place",
                                 {"the eye", "a direction", "a place"})) {
    const dvec3 eye = bench_.wishes().camera.position;
    if (*chosen == "the eye") set("light", "headlight");
    if (*chosen == "a direction") {
      const Light key = key_light(bench_.camera(), bench_.navigator().up_axis());
      dvec3 way = key.kind == Light::Kind::directional ? key.vector : glm::normalize(key.vector - bench_.wishes().camera.target);
      set("light", fmt::format("dir:{:.3f},{:.3f},{:.3f}", way.x, way.y, way.z));
    }
    if (*chosen == "a place")
      set("light", view::number_text(eye.x) + "," + view::number_text(eye.y) + "," + view::number_text(eye.z));
  }
  tooltip("--light");
  if (by_direction) {
    const std::vector<float> v = view::numbers_of(light.substr(4));
    if (v.size() == 3) {
      const Compass compass(bench_.navigator().up_axis());
      const dvec3 way = glm::normalize(dvec3(double(v[0]), double(v[1]), double(v[2])));
      float angles[2] = {float(glm::degrees(compass.azimuth(way))), float(glm::degrees(compass.elevation(way)))};
      bool moved = ImGui::SliderFloat("azimuth", &angles[0], -180, 180, "%.0f°");
      moved |= ImGui::SliderFloat("height", &angles[1], -89, 89, "%.0f°");
      if (moved) {
        const dvec3 to = compass.from(glm::radians(double(angles[0])), glm::radians(double(angles[1])));
        set("light", fmt::format("dir:{:.4f},{:.4f},{:.4f}", to.x, to.y, to.z));
      }
    }
  }
  for (const view::Control& each : view::controls_of(*look_))
    if ((each.group == "Light" || each.group == "Shadows") && each.name != "light") control(each);
}

void Interface::clip_panel() {
  clip_ = heading("Clip box", false);
  const view::Loaded* scene = bench_.scene();
  if (!clip_ || !scene) return;
  const auto& crop = bench_.wishes().scene.selection.crop;
  bool on = crop.has_value();
  const auto clip = [&](const std::optional<Bounds>& box) {
    bench_.change("clip", [&](view::Wishes& next) {
      next.scene.selection.crop = box;
      next.scene.selection.crop_share.reset();
      std::erase_if(next.input, [](const auto& each) { return each.first == "crop-relative"; });
    });
  };
  if (ImGui::Checkbox("show only the points in a box", &on)) clip(on ? std::optional(scene->box) : std::nullopt);
  if (!crop) return;
  Bounds box = *crop;
  for (int axis = 0; axis < 3; ++axis) {
    // Distances from the corner of the scene: floats hold them where coordinates are millions.
    const double from = scene->box.min[axis], size = std::max(1e-9, scene->box.max[axis] - from);
    float low = float(box.min[axis] - from), high = float(box.max[axis] - from);
    ImGui::PushID(axis);
    if (ImGui::DragFloatRange2(std::string(1, "xyz"[axis]).c_str(), &low, &high, float(0.003 * size), 0, float(size), "%.5g", "%.5g")) {
      box.min[axis] = low <= 0 ? from : from + double(low);
      box.max[axis] = double(high) >= size ? scene->box.max[axis] : from + double(high);
      clip(box);
    }
    tooltip("drag both ends; counted from the scene's corner");
    ImGui::PopID();
  }
}

void Interface::camera_panel() {
  if (!heading("Camera", false)) return;
  const view::ViewCamera& camera = bench_.wishes().camera;
  const double size = bench_.navigator().scene_size();
  const auto row = [&](const char* name, const dvec3& v) {
    ImGui::TextDisabled("%s", name);
    ImGui::SameLine(76 * window_.scale());
    ImGui::TextUnformatted(fmt::format("{} {} {}", view::coordinate_text(v.x, size), view::coordinate_text(v.y, size),
                                       view::coordinate_text(v.z, size)).c_str());
  };
  row("position", camera.position);
  row("target", camera.target);
  float angle = float(camera.fov_deg);
  if (ImGui::SliderFloat("angle", &angle, 5, 120, "%.1f°"))
    bench_.move("angle", [&](view::Navigator& hand) { hand.set_angle(double(angle)); });
  bool parallel = camera.orthographic;
  if (ImGui::Checkbox("parallel", &parallel)) act(view::Action::orthographic);
  struct { const char* name; view::Action action; } const sides[] = {{"front", view::Action::front}, {"right", view::Action::right},
                                                                   {"top", view::Action::top}, {"frame", view::Action::frame_view},
                                                                   {"reset", view::Action::reset_view}};
  for (const auto& side : sides) {
    if (side.action != view::Action::front) ImGui::SameLine();
    if (ImGui::Button(side.name)) act(side.action);
  }
  if (ImGui::Button("copy")) act(view::Action::copy_camera);
  tooltip("the camera as JSON (Ctrl+C)");
  ImGui::SameLine();
  if (ImGui::Button("paste")) act(view::Action::paste_camera);
  tooltip("a copied camera (Ctrl+V)");
  ImGui::SameLine();
  if (ImGui::Button("copy as command")) act(view::Action::copy_command);
  tooltip("the command that makes the same pixels (Ctrl+Shift+C)");
  ImGui::InputTextWithHint("##size", "size of the view", &screenshot_size_);
  tooltip("size of saved pictures: 3840x2160, or empty for that of the view");
  ImGui::SameLine();
  if (ImGui::Button(bench_.shooting() ? "saving" : "save picture")) act(view::Action::screenshot);
}

void Interface::path_panel() {
  if (!heading("Camera path", false)) return;
  view::KeyFrames& path = bench_.path;
  if (ImGui::Button("add this view")) act(view::Action::add_key);
  ImGui::SameLine();
  if (ImGui::Button(bench_.playing() ? "stop" : "play")) act(view::Action::play);
  float seconds = float(path.seconds_per_key);
  if (ImGui::SliderFloat("s a key", &seconds, 0.2f, 10, "%.1f")) path.seconds_per_key = double(seconds);
  for (std::size_t i = 0; i < path.keys().size(); ++i) {
    ImGui::PushID(int(i));
    if (ImGui::SmallButton(fmt::format("key {}", i + 1).c_str())) {
      const view::ViewCamera key = path.keys()[i];
      bench_.move("key", [&](view::Navigator& hand) { hand.set_camera(key); });
    }
    ImGui::SameLine();
    if (ImGui::SmallButton("replace")) path.replace(i, bench_.wishes().camera);
    ImGui::SameLine();
    if (ImGui::SmallButton("up") && i > 0) path.move(i, i - 1);
    ImGui::SameLine();
    const bool remove = ImGui::SmallButton("remove");
    ImGui::PopID();
    if (remove) {
      path.remove(i);
      break;
    }
  }
  if (path.empty()) return;
  if (ImGui::Button("save path")) {
    const std::string name = free_name("path", ".json");
    try {
      path.save(name, bench_.width(), bench_.height());
      // The whole of what follows draws it, with the look of now.
      cli::Words words = bench_.wishes().words(bench_.width(), bench_.height());
      std::erase_if(words, [](const std::string& word) { return word.starts_with("--camera-"); });
      words.insert(words.begin(), "sfumato");
      words.insert(words.end(), {"--path", name, "--frames", std::to_string(int(std::lround(25 * path.duration_s())) + 1), "-o", "path.mp4"});
      window_.copy(cli::quote(words));
      bench_.say("saved " + name + "; the command that makes a video of it is copied");
    } catch (const Error& error) {
      bench_.say(error.what(), true);
    }
  }
}

void Interface::take_preset(const std::string& file) {
  bench_.change("preset", [&](view::Wishes& next) {
    const Preset preset = load_preset(file);
    if (!preset.technique.empty() && preset.technique != "auto") next.technique = find_technique(preset.technique).name;
    Look look(next.technique);
    const Look* const looks[] = {&look};
    analysis::PrepareOptions options;
    ParamList list;
    options.describe(list);
    next.reset_all();
    for (const auto& [name, value] : preset.parameters_for(looks, list)) {
      const std::size_t dot = name.find('.');
      next.set(dot == std::string::npos ? name : name.substr(dot + 1), value);
    }
    for (const auto& [name, value] : preset.options) {
      if (name == "color-by") next.color_by = value;
      if (name == "colormap") next.colormap = value;
      if (name == "color-range") next.color_range = value;
      if (name == "color") next.point_color = value;
      if (name == "background-color") next.background_color = value;
      if (name == "legend") next.legend = value == "true";
    }
  });
}

void Interface::scene_panel() {
  if (!heading("Scene", false)) return;
  const view::Loaded* scene = bench_.scene();
  if (!scene) return;
  for (const std::string& file : bench_.wishes().files) ImGui::BulletText("%s", file.c_str());
  note(fmt::format("{}: {} points, {} shown{}", scene->formats, thousands(scene->points_read), thousands(scene->points_shown),
                   bench_.left_out() ? fmt::format(", {} in places with others", bench_.left_out()) : ""));
  note(fmt::format("up {} ({})", to_string(scene->pose.upright.up), scene->pose.upright.reason));
  if (!scene->crs.empty()) note(scene->crs.substr(0, 120));
  ImGui::Checkbox("read again when files change", &bench_.watch);
  note("drop files on the window to open them, with Ctrl beside these");
  ImGui::InputTextWithHint("##preset", "preset file", &preset_name_);
  ImGui::SameLine();
  if (ImGui::Button("load") && !preset_name_.empty()) take_preset(preset_name_);
  ImGui::SameLine();
  if (ImGui::Button("save look")) {
    const std::string name = free_name("look", ".json");
    try {
      const view::Wishes& now = bench_.wishes();
      NamesAndValues given;
      const auto say = [&](const char* option, const std::string& value) { if (!value.empty()) given.emplace_back(option, value); };
      say("color-by", now.color_by == "auto" ? "" : now.color_by);
      say("colormap", now.colormap);
      say("color-range", now.color_range);
      say("color", now.point_color);
      say("background-color", now.background_color);
      say("legend", now.legend ? "true" : "");
      analysis::PrepareOptions options;
      ParamList list;
      options.describe(list);
      for (const auto& [parameter, value] : now.analysis) list.find(parameter)->set(value);
      const Look* const looks[] = {look_.get()};
      save_preset(name, looks, list, given, {});
      bench_.say("saved " + name + ": --preset " + name + " brings this look to any scan");
    } catch (const Error& error) {
      bench_.say(error.what(), true);
    }
  }
}

void Interface::timing_panel() {
  const bool open = heading("Timings", false);
  if (open && !timings_) {
    timings_ = true;
    bench_.set_timings(true);
    bench_.repaint();
  }
  timings_ = open;
  if (!open) return;
  note(bench_.renderer_name());
  if (!picture()) return;
  if (bench_.first_picture_ms() > 0) note(fmt::format("first picture after {:.0f} ms", bench_.first_picture_ms()));
  if (bench_.motion_ms() > 0) note(fmt::format("in motion {:.1f} pictures a second", 1000 / bench_.motion_ms()));
  const auto row = [&](const std::string& name, double ms) {
    ImGui::TextDisabled("%s", name.c_str());
    ImGui::SameLine(ImGui::GetContentRegionAvail().x - 80 * window_.scale());
    ImGui::Text("%9.2f ms", ms);
  };
  for (const PassTiming& pass : picture()->timings) row(pass.name, pass.ms);
  row("request to picture", picture()->took_ms);
}

}  // namespace sfumato::viewer
