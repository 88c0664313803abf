#include "interface.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "core/counted.h"
#include "panel_tools.h"

namespace sfumato::viewer {
namespace {

constexpr float panel_points = 330, status_points = 26;

}  // namespace

Interface::Interface(Window& window, view::ViewModel& model) : window_(window), model_(model) {}

void Interface::draw(double now_ms) {
  now_ms_ = now_ms;
  for (view::Message& message : model_.take_messages()) {
    const double stay = message.is_error ? 9000 : 4500;
    toasts_.push_back({std::move(message), now_ms + stay});
  }
  while (toasts_.size() > 5) toasts_.pop_front();
  if (!model_.request().technique.empty()) {
    if (view::ViewRequest now = model_.request().look(); now != look_of_ || !look_) {
      look_of_ = std::move(now);
      look_ = look_of_.make_look();
    }
  }
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  const float status = status_points * window_.scale();
  const float panel = panels_ ? std::min(panel_points * window_.scale(), 0.6f * screen.x) : 0;
  const float width = std::max(32.0f, std::floor(screen.x - panel)),
              height = std::max(32.0f, std::floor(screen.y - status));
  draw_view(now_ms, width, height);
  draw_profile(width, height);
  if (panels_) draw_panels(width, screen.x - width, height);
  draw_status(height, screen.x, screen.y - height);
  if (help_) draw_help();
  draw_messages(now_ms, height);
  take_saved();
}

void Interface::draw_panels(float x, float width, float height) {
  ImGui::SetNextWindowPos({x, 0});
  ImGui::SetNextWindowSize({width, height});
  ImGui::Begin("panels", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings);
  walk_here();
  ImGui::PushItemWidth(0.41f * width);
  technique_panel();
  if (look_) {
    parameter_panel();
    item_panel();
    color_panel();
    class_panel();
    light_panel();
    clip_panel();
    measure_panel();
    camera_panel();
    path_panel();
    scene_panel();
    timing_panel();
  }
  ImGui::PopItemWidth();
  ImGui::End();
}

/// Whoever has no mouse comes to the panels by an arrow or Tab, from wherever the focus is.
void Interface::walk_here() {
  const ImGuiIO& io = ImGui::GetIO();
  if (io.WantTextInput || io.KeyCtrl || ImGui::IsWindowFocused(ImGuiFocusedFlags_RootAndChildWindows)) return;
  for (const ImGuiKey key :
       {ImGuiKey_Tab, ImGuiKey_LeftArrow, ImGuiKey_RightArrow, ImGuiKey_UpArrow, ImGuiKey_DownArrow}) {
#if IMGUI_VERSION_NUM < 18700
    const int asked = ImGui::GetKeyIndex(key);
#else
    const ImGuiKey asked = key;
#endif
    if (ImGui::IsKeyPressed(asked, false)) ImGui::SetWindowFocus();
  }
}

void Interface::draw_status(float y, float width, float height) {
  ImGui::SetNextWindowPos({0, y});
  ImGui::SetNextWindowSize({width, height});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {10 * window_.scale(), 4 * window_.scale()});
  ImGui::Begin("status", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoNav |
                   ImGuiWindowFlags_NoSavedSettings);
  ImGui::PopStyleVar();
  std::string text;
  if (const view::Loaded* scene = model_.scene.loaded()) {
    text = counted_of(scene->points_shown, std::max(scene->points_read, scene->points_shown), "point");
  }
  if (const view::Picture* shown = picture()) {
    const view::Quality quality = model_.shown_quality();
    text += fmt::format("   {}  {}×{}", shown->technique, shown->image.width(), shown->image.height());
    if (model_.settled())
      text += fmt::format("  final, {:.0f} ms", shown->took_ms);
    else
      text += fmt::format("  {}{}", quality.whole_cloud ? "" : "a sample",
                          model_.moving() && model_.motion_ms() > 0
                              ? fmt::format("  {:.0f} pictures a second", 1000 / model_.motion_ms())
                              : "");
  }
  ImGui::TextUnformatted(text.c_str());
  const view::Activity& activity = model_.activity();
  if (!activity.text.empty() && !model_.moving()) {
    const float bar = 120 * window_.scale();
    const std::string what = activity.text;
    ImGui::SameLine(std::max(ImGui::CalcTextSize(text.c_str()).x + 30 * window_.scale(),
                             width - bar - ImGui::CalcTextSize(what.c_str()).x - 30 * window_.scale()));
    ImGui::TextDisabled("%s", what.c_str());
    ImGui::SameLine();
    ImGui::ProgressBar(float(activity.fraction), {bar, ImGui::GetTextLineHeight()}, "");
  } else {
    const std::string hint = "H help";
    ImGui::SameLine(width - ImGui::CalcTextSize(hint.c_str()).x - 14 * window_.scale());
    ImGui::TextDisabled("%s", hint.c_str());
  }
  ImGui::End();
}

void Interface::draw_help() {
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({0.5f * screen.x, 0.5f * screen.y}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSize(
      {std::min(0.96f * screen.x, 980 * window_.scale()), std::min(0.94f * screen.y, 620 * window_.scale())});
  ImGui::SetNextWindowFocus();
  ImGui::Begin("Keys and mouse", &help_,
               ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse |
                   ImGuiWindowFlags_NoSavedSettings);
  const float column = 0.5f * ImGui::GetContentRegionAvail().x;
  const auto row = [&](const std::string& left, const std::string& right) {
    const float keys = 155 * window_.scale();
    ImGui::TextUnformatted(left.c_str());
    if (ImGui::CalcTextSize(left.c_str()).x < keys - 8)
      ImGui::SameLine(keys);
    else
      ImGui::SetCursorPosX(keys);
    ImGui::PushTextWrapPos(0);
    ImGui::TextDisabled("%s", right.c_str());
    ImGui::PopTextWrapPos();
  };
  ImGui::BeginChild("keys", {column - 6, 0});
  for (const view::KeyBinding& binding : view::key_bindings())
    if (!binding.keys.empty()) row(binding.keys, binding.what);
  ImGui::EndChild();
  ImGui::SameLine();
  ImGui::BeginChild("mouse", {0, 0});
  for (const view::MouseHelp& each : view::mouse_help()) row(each.gesture, each.what);
  ImGui::EndChild();
  ImGui::End();
}

void Interface::draw_messages(double now_ms, float height) {
  while (!toasts_.empty() && toasts_.front().until_ms < now_ms) toasts_.pop_front();
  ImDrawList* list = ImGui::GetForegroundDrawList();
  float y = height - 12 * window_.scale();
  const float wrap = ImGui::GetIO().DisplaySize.x * 0.6f;
  for (auto toast = toasts_.rbegin(); toast != toasts_.rend(); ++toast) {
    std::string text = toast->message.text;
    // Long lines break at blanks.
    std::size_t begin = 0, blank = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (text[i] == ' ') blank = i;
      if (blank > begin && ImGui::CalcTextSize(text.c_str() + begin, text.c_str() + i + 1).x > wrap)
        text[blank] = '\n', begin = blank + 1;
    }
    y -= ImGui::CalcTextSize(text.c_str()).y;
    label(list, {16 * window_.scale(), y}, text, toast->message.is_error);
    y -= 12 * window_.scale();
  }
}

}  // namespace sfumato::viewer
