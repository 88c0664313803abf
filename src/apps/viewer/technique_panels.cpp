// Technique and parameters.
#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>

#include "interface.h"
#include "panel_tools.h"

namespace sfumato::viewer {

bool Interface::heading(const char* title, bool open) {
  return ImGui::CollapsingHeader(title, open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
}

std::string Interface::resolved(const std::string& parameter) const {
  const Param* param = look_ ? look_->parameters.find(parameter) : nullptr;
  if (!param) return "";
  return param->get() == "auto" ? model_.resolved(param->name).value_or("auto") : param->get();
}

void Interface::set(const std::string& parameter, const std::string& value) {
  model_.change(parameter, [&](view::ViewRequest& request) { request.set(parameter, value); });
}

void Interface::control(view::Control control) {
  ImGui::PushID(control.name.c_str());
  const std::string value = control.is_auto ? resolved(control.name) : control.value;
  std::vector<float> numbers = view::numbers_of(value);
  std::string text = value;
  // The label turns bright where the value is not the default; × behind it takes that back.
  const std::string label = "##value";
  switch (control.kind) {
    case ParamKind::boolean: {
      bool on = value == "true";
      if (ImGui::Checkbox(label.c_str(), &on)) set(control.name, on ? "true" : "false");
      ImGui::SameLine();
      ImGui::Dummy(
          {std::max(0.0f, ImGui::CalcItemWidth() - ImGui::GetFrameHeight() - ImGui::GetStyle().ItemSpacing.x),
           1});
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
        set(control.name,
            view::number_text(float(std::clamp(double(number), control.limit_low, control.limit_high))));
      break;
    }
    case ParamKind::choice:
      if (const auto chosen = choose(label.c_str(), value, control.choices)) set(control.name, *chosen);
      break;
    case ParamKind::vector3:
      if (numbers.size() == 3 && ImGui::DragFloat3(label.c_str(), numbers.data(), 0.01f))
        set(control.name, view::number_text(numbers[0]) + "," + view::number_text(numbers[1]) + "," +
                              view::number_text(numbers[2]));
      break;
    case ParamKind::text:
    case ParamKind::real_list:
      if (edit_text(label.c_str(), "", text)) set(control.name, text);
      break;
  }
  tooltip(control.tooltip +
          (control.can_be_auto || control.kind == ParamKind::boolean ? "" : "\nCtrl+click: type a value"));
  ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
  const auto label_column = [&] { ImGui::SameLine(0.41f * ImGui::GetWindowWidth() + 46 * window_.scale()); };
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
    if (ImGui::SmallButton("×"))
      model_.change(control.name, [&](view::ViewRequest& request) { request.reset(control.name); });
    tooltip("back to " + control.default_value);
  }
  ImGui::PopID();
}

void Interface::controls(const std::vector<view::Control>& all) {
  for (const view::Control& each : all) control(each);
}

void Interface::technique_panel() {
  const std::string now = model_.request().technique;
  const auto& techniques = all_techniques();
  const float width = (ImGui::GetContentRegionAvail().x - 3 * ImGui::GetStyle().ItemSpacing.x) / 4;
  for (std::size_t i = 0; i < techniques.size(); ++i) {
    if (i % 4) ImGui::SameLine();
    const bool chosen = techniques[i].name == now;
    if (chosen) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_SliderGrab));
    if (chosen) ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(1, 1, 1, 1));
    if (ImGui::Button(techniques[i].name.c_str(), {width, 0}))
      model_.change("technique", [&](view::ViewRequest& request) { request.technique = techniques[i].name; });
    if (chosen) ImGui::PopStyleColor(2);
    tooltip(fmt::format("{}: {}\nkey {}", techniques[i].name, techniques[i].summary, i + 1));
  }
  if (now.empty()) note("looking for the technique that suits the scan");
  if (!model_.scene.reason().empty()) note("chosen: " + model_.scene.reason());
  if (picture() && model_.settled())
    for (const std::string& each : picture()->notes) note(each);
  ImGui::Spacing();
}

void Interface::parameter_panel() {
  if (!heading("Parameters", true)) return;
  ImGui::SetNextItemWidth(-60 * window_.scale());
  ImGui::InputTextWithHint("##search", "search all parameters", &search_);
  ImGui::SameLine();
  if (ImGui::Button("reset")) model_.change("reset", [](view::ViewRequest& request) { request.reset_all(); });
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
    controls(model_.request().analysis_controls("analysis"));
    ImGui::TreePop();
  }
}

}  // namespace sfumato::viewer
