// Files, presets, timings.
#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>

#include "core/counted.h"
#include "core/error.h"
#include "interface.h"
#include "panel_tools.h"
#include "session/preset.h"

namespace sfumato::viewer {

void Interface::take_preset(const std::string& file) {
  model_.change("preset", [&](view::ViewRequest& next) { next.take(load_preset(file)); });
}

void Interface::save_look(bool with_files) {
  const std::string name = free_name(with_files ? "scene" : "look", ".json");
  try {
    model_.request().save(name, with_files ? std::optional(model_.camera()) : std::nullopt);
    model_.say(with_files ? fmt::format("saved {0}: --scene {0} shows all of this again", name)
                          : fmt::format("saved {0}: --preset {0} brings this look to any scan", name));
  } catch (const Error& error) {
    model_.say(error.what(), true);
  }
}

void Interface::file_list() {
  const view::ViewRequest& view_request = model_.request();
  if (view_request.files.size() < 2) {
    for (const std::string& file : view_request.files) ImGui::BulletText("%s", file.c_str());
    return;
  }
  // A file that is not shown is an item like others: "file 2: none".
  for (std::size_t n = 0; n < view_request.files.size(); ++n) {
    const std::string selection = fmt::format("file {}", n + 1);
    const auto of_file = [&](const view::DrawRow& row) { return row.selection == selection; };
    const auto row = std::find_if(view_request.items.begin(), view_request.items.end(), of_file);
    bool shown = row == view_request.items.end() || row->visible;
    ImGui::PushID(int(n));
    if (ImGui::Checkbox(view_request.files[n].c_str(), &shown))
      model_.change("file shown", [&](view::ViewRequest& next) {
        const auto same = std::find_if(next.items.begin(), next.items.end(), of_file);
        if (same == next.items.end())
          next.items.insert(next.items.begin(), {selection, next.technique, "", false});
        else
          same->visible = shown;
        // What draws as the rest does needs no row.
        std::erase_if(next.items, [&](const view::DrawRow& each) {
          return of_file(each) && each.visible && each.technique == next.technique && each.parameters.empty();
        });
      });
    ImGui::PopID();
  }
}

void Interface::scene_panel() {
  if (!heading("Scene", false)) return;
  const view::Loaded* scene = model_.scene.loaded();
  if (!scene) return;
  if (const int frames = int(model_.sequence.frames().size()); frames > 1) {
    int frame = int(model_.sequence.frame()) + 1;
    if (ImGui::Button(model_.sequence.playing() ? "pause" : "play"))
      model_.sequence.play(!model_.sequence.playing());
    ImGui::SameLine();
    if (ImGui::SliderInt("frame", &frame, 1, frames)) model_.show_frame(std::size_t(frame - 1));
    float rate = float(model_.sequence.frames_per_second);
    if (ImGui::SliderFloat("a second", &rate, 0.2f, 30, "%.1f", ImGuiSliderFlags_Logarithmic))
      model_.sequence.frames_per_second = double(rate);
    tooltip("frames a second, as far as whole pictures keep up");
  }
  file_list();
  note(fmt::format(
      "{}: {} points, {} shown{}", scene->formats, thousands(scene->points_read),
      thousands(scene->points_shown),
      model_.scene.left_out() ? fmt::format(", {} in places with others", model_.scene.left_out()) : ""));
  note(fmt::format("up {} ({})", to_string(scene->pose.upright.up), scene->pose.upright.reason));
  if (bool whole = model_.request().whole; scene->pose.subject.room || whole) {
    if (ImGui::Checkbox("whole room", &whole))
      model_.change("whole room", [&](view::ViewRequest& next) { next.whole = whole; });
    tooltip("with its ceiling and the walls before the camera, as --whole");
  }
  if (!scene->crs.empty()) note(scene->crs.substr(0, 120));
  ImGui::Checkbox("read again when files change", &model_.watch);
  note("drop files on the window to open them, with Ctrl beside these");
  ImGui::SetNextItemWidth(-60 * window_.scale());
  ImGui::InputTextWithHint("##preset", "file, preset or scene to open", &preset_name_);
  ImGui::SameLine();
  if (ImGui::Button("open") && !preset_name_.empty()) drop({preset_name_}, ImGui::GetIO().KeyCtrl);
  tooltip("a point cloud (with Ctrl beside what is open), a folder, or a .json that was saved");
  if (ImGui::Button("save look")) save_look(false);
  tooltip("technique, parameters, items and colours, for --preset");
  ImGui::SameLine();
  if (ImGui::Button("save scene")) save_look(true);
  tooltip("the files and the view as well, for --scene");
}

void Interface::timing_panel() {
  const bool open = heading("Timings and memory", false);
  if (open && !model_.timings) model_.repaint();
  model_.timings = open;
  if (!open) return;
  note(model_.renderer_name());
  if (!picture()) return;
  if (model_.first_picture_ms() > 0)
    note(fmt::format("first picture after {:.0f} ms", model_.first_picture_ms()));
  if (model_.motion_ms() > 0)
    note(fmt::format("in motion {:.1f} pictures a second", 1000 / model_.motion_ms()));
  const auto row = [&](const std::string& name, double ms) {
    ImGui::TextDisabled("%s", name.c_str());
    ImGui::SameLine(ImGui::GetContentRegionAvail().x - 80 * window_.scale());
    ImGui::Text("%9.2f ms", ms);
  };
  for (const PassTiming& pass : picture()->timings) row(pass.name, pass.ms);
  row("request to picture", picture()->took_ms);
  ImGui::Spacing();
  const auto mega = [&](const char* name, double bytes) {
    if (bytes == 0) return;
    ImGui::TextDisabled("%s", name);
    ImGui::SameLine(ImGui::GetContentRegionAvail().x - 80 * window_.scale());
    ImGui::Text("%9.0f MB", bytes / 1e6);
  };
  const view::Memory memory = model_.memory();
  mega("the process", double(memory.process));
  mega("at most so far", double(memory.process_peak));
  mega("points and their attributes", double(memory.points));
}

}  // namespace sfumato::viewer
