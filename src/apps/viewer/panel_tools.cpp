#include "panel_tools.h"

#include <imgui_stdlib.h>

namespace sfumato::viewer {

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

std::optional<std::string> choose(const char* label, const std::string& now,
                                  const std::vector<std::string>& all) {
  std::optional<std::string> chosen;
  if (ImGui::BeginCombo(label, now.c_str())) {
    for (const std::string& each : all)
      if (ImGui::Selectable(each.c_str(), each == now)) chosen = each;
    ImGui::EndCombo();
  }
  return chosen;
}

bool edit_text(const char* label, const char* hint, std::string& value) {
  // The text of the field that is being typed in; there is one at most.
  static std::string typed;
  static ImGuiID field = 0;
  const ImGuiID id = ImGui::GetID(label);
  if (field != id && !ImGui::IsAnyItemActive()) field = 0;
  std::string text = field == id ? typed : value;
  ImGui::InputTextWithHint(label, hint, &text);
  if (ImGui::IsItemActive()) typed = text, field = id;
  if (!ImGui::IsItemDeactivated()) return false;
  field = 0;
  if (text == value) return false;
  value = text;
  return true;
}

ImU32 paint(int rgb, float alpha) {
  return ImGui::GetColorU32(
      ImVec4(float(rgb >> 16 & 255) / 255, float(rgb >> 8 & 255) / 255, float(rgb & 255) / 255, alpha));
}

void label(ImDrawList* list, ImVec2 at, const std::string& text, bool error) {
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  const float pad = 0.35f * ImGui::GetFontSize();
  list->AddRectFilled({at.x - pad, at.y - 0.5f * pad}, {at.x + size.x + pad, at.y + size.y + 0.5f * pad},
                      error ? paint(0x8c2f2f, 0.95f) : paint(0x202428, 0.86f), 4);
  list->AddText(at, paint(0xf0f2f4), text.c_str());
}

}  // namespace sfumato::viewer
