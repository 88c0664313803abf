// Files, presets, timings.
#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>

#include "core/error.h"
#include "interface.h"
#include "panel_tools.h"
#include "session/preset.h"

namespace sfumato::viewer {

void Interface::take_preset(const std::string& file) {
  bench_.change("preset", [&](view::Wishes& next) { next.take(load_preset(file)); });
}

void Interface::save_look(bool with_files) {
  const std::string name = free_name(with_files ? "scene" : "look", ".json");
  try {
    bench_.wishes().save(name, with_files ? std::optional(bench_.camera()) : std::nullopt);
    bench_.say(with_files ? fmt::format("saved {0}: --scene {0} shows all of this again", name)
                          : fmt::format("saved {0}: --preset {0} brings this look to any scan", name));
  } catch (const Error& error) {
    bench_.say(error.what(), true);
  }
}

void Interface::file_list() {
  const view::Wishes& wishes = bench_.wishes();
  if (wishes.files.size() < 2) {
    for (const std::string& file : wishes.files) ImGui::BulletText("%s", file.c_str());
    return;
  }
  // A file that is not shown is an item like others: "file 2: none".
  for (std::size_t n = 0; n < wishes.files.size(); ++n) {
    const std::string selection = fmt::format("file {}", n + 1);
    const auto of_file = [&](const view::DrawRow& row) { return row.selection == selection; };
    const auto row = std::find_if(wishes.items.begin(), wishes.items.end(), of_file);
    bool shown = row == wishes.items.end() || row->visible;
    ImGui::PushID(int(n));
    if (ImGui::Checkbox(wishes.files[n].c_str(), &shown))
      bench_.change("file shown", [&](view::Wishes& next) {
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
  const view::Loaded* scene = bench_.scene.loaded();
  if (!scene) return;
  if (const int frames = int(bench_.sequence.frames().size()); frames > 1) {
    int frame = int(bench_.sequence.frame()) + 1;
    if (ImGui::Button(bench_.sequence.playing() ? "pause" : "play"))
      bench_.sequence.play(!bench_.sequence.playing());
    ImGui::SameLine();
    if (ImGui::SliderInt("frame", &frame, 1, frames)) bench_.show_frame(std::size_t(frame - 1));
    float rate = float(bench_.sequence.frames_per_second);
    if (ImGui::SliderFloat("a second", &rate, 0.2f, 30, "%.1f", ImGuiSliderFlags_Logarithmic))
      bench_.sequence.frames_per_second = double(rate);
    tooltip("frames a second, as far as whole pictures keep up");
  }
  file_list();
  note(fmt::format(
      "{}: {} points, {} shown{}", scene->formats, thousands(scene->points_read),
      thousands(scene->points_shown),
      bench_.scene.left_out() ? fmt::format(", {} in places with others", bench_.scene.left_out()) : ""));
  note(fmt::format("up {} ({})", to_string(scene->pose.upright.up), scene->pose.upright.reason));
  if (bool whole = bench_.wishes().whole; scene->pose.subject.room || whole) {
    if (ImGui::Checkbox("whole room", &whole))
      bench_.change("whole room", [&](view::Wishes& next) { next.whole = whole; });
    tooltip("with its ceiling and the walls before the camera, as --whole");
  }
  if (!scene->crs.empty()) note(scene->crs.substr(0, 120));
  ImGui::Checkbox("read again when files change", &bench_.watch);
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
  if (open && !bench_.timings) bench_.repaint();
  bench_.timings = open;
  if (!open) return;
  note(bench_.renderer_name());
  if (!picture()) return;
  if (bench_.first_picture_ms() > 0)
    note(fmt::format("first picture after {:.0f} ms", bench_.first_picture_ms()));
  if (bench_.motion_ms() > 0)
    note(fmt::format("in motion {:.1f} pictures a second", 1000 / bench_.motion_ms()));
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
  const view::Memory memory = bench_.memory();
  mega("the process", double(memory.process));
  mega("at most so far", double(memory.process_peak));
  mega("points and their attributes", double(memory.points));
}

}  // namespace sfumato::viewer
