// Which points are drawn how: the rules of --draw as rows.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "interface.h"
#include "panel_tools.h"

namespace sfumato::viewer {
namespace {

/// What a new row selects: something that the scan has and no row draws yet.
std::string suggested_selection(const view::Loaded& scene, const view::ViewRequest& request) {
  const auto is_new = [&](const std::string& selection) {
    return std::none_of(request.items.begin(), request.items.end(),
                        [&](const view::DrawRow& row) { return row.selection == selection; });
  };
  for (const ClassShare& each : scene.classes)
    if (const std::string selection = fmt::format("class {}", each.id); is_new(selection)) return selection;
  if (request.files.size() > 1)
    for (std::size_t n = 1; n <= request.files.size(); ++n)
      if (const std::string selection = fmt::format("file {}", n); is_new(selection)) return selection;
  const int up = int(scene.pose.upright.up) / 2;
  const double middle = 0.5 * (scene.box.min[up] + scene.box.max[up]);
  return fmt::format("{} {}..", "xyz"[up], view::coordinate_text(middle, scene.box.diagonal()));
}

}  // namespace

void Interface::item_panel() {
  const view::Loaded* scene = model_.scene.loaded();
  const std::vector<view::DrawRow>& rows = model_.request().items;
  if (!scene || !heading("Items", !rows.empty())) return;
  std::vector<std::string> techniques;
  for (const TechniqueInfo& info : all_techniques()) techniques.push_back(info.name);
  const auto edit = [&](const char* what, const auto& change) {
    model_.change(what, [&](view::ViewRequest& next) { change(next.items); });
  };
  const float full = ImGui::GetContentRegionAvail().x, gap = ImGui::GetStyle().ItemSpacing.x;
  const float check = ImGui::GetFrameHeight() + gap;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const view::DrawRow row = rows[i];
    ImGui::PushID(int(i));
    bool visible = row.visible;
    if (ImGui::Checkbox("##visible", &visible))
      edit("item shown", [&](auto& all) { all[i].visible = visible; });
    tooltip("draw these points, or leave them out");
    ImGui::SameLine();
    std::string text = row.selection;
    ImGui::SetNextItemWidth(full - check - 3 * (ImGui::GetFrameHeight() + 0.5f * gap));
    if (edit_text("##selection", "which points", text))
      edit("item selection", [&](auto& all) { all[i].selection = text; });
    tooltip(
        "which points: class ground,building   intensity 10..200   z 3..   file 2   box x0,y0,z0,x1,y1,z1\n"
        "joined by 'and', before each maybe 'not'. The first row that selects a point draws it. Enter");
    const auto button = [&](const char* label, const char* help) {
      ImGui::SameLine(0, 0.5f * gap);
      const bool pressed = ImGui::Button(label, {ImGui::GetFrameHeight(), 0});
      tooltip(help);
      return pressed;
    };
    if (button("↑", "before the row above") && i > 0)
      edit("item order", [&](auto& all) { std::swap(all[i], all[i - 1]); });
    if (button("↓", "after the row below") && i + 1 < rows.size())
      edit("item order", [&](auto& all) { std::swap(all[i], all[i + 1]); });
    const bool remove =
        button("×", "remove the row: its points are drawn by the rows below, or with the rest");
    ImGui::Dummy({check - gap, 1});
    ImGui::SameLine();
    ImGui::SetNextItemWidth(0.32f * full);
    if (const auto chosen = choose("##technique", row.technique, techniques))
      edit("item technique", [&](auto& all) { all[i].technique = *chosen, all[i].parameters.clear(); });
    ImGui::SameLine();
    std::string parameters = row.parameters;
    ImGui::SetNextItemWidth(-1);
    if (edit_text("##parameters", "name=value ...", parameters))
      edit("item parameters", [&](auto& all) { all[i].parameters = parameters; });
    tooltip("parameters of its technique, such as opacity=0.2; Enter");
    ImGui::PopID();
    if (remove) {
      edit("item removed", [&](auto& all) { all.erase(all.begin() + std::ptrdiff_t(i)); });
      break;
    }
  }
  if (ImGui::Button("add a row")) {
    const std::string selection = suggested_selection(*scene, model_.request());
    edit("item added", [&](auto& all) { all.push_back({selection, "splats", "", true}); });
  }
  ImGui::SameLine();
  ImGui::TextDisabled("the rest: %s", model_.request().technique.c_str());
}

}  // namespace sfumato::viewer
