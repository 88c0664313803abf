// Picked points, the line through them, and its vertical profile.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "core/error.h"
#include "core/counted.h"
#include "interface.h"
#include "io/image_png.h"
#include "labels/plot.h"
#include "panel_tools.h"

namespace sfumato::viewer {
namespace {

Image<Rgba8> picture_of(const view::Profile& profile, const std::string& unit, int width, int height) {
  std::vector<labels::PlotPoint> points;
  points.reserve(profile.points.size());
  for (const view::ProfilePoint& each : profile.points)
    points.push_back({each.along, each.height, each.color});
  labels::PlotLook look;
  look.title =
      fmt::format("{} within {:.4g} {}", counted(profile.points.size(), "point"), profile.width, unit);
  look.x_label = fmt::format("distance ({})", unit);
  look.high_x = profile.length;
  return labels::draw_plot(points, look, width, height);
}

}  // namespace

void Interface::measure_panel() {
  if (!heading("Measure", false)) return;
  const auto& picked = model_.picks.points();
  const double size = model_.navigator().scene_size();
  const std::string unit = view::unit_of(model_.scene.crs());
  if (picked.empty()) note("click two points: distance and height; Ctrl+click goes on, as a line");
  double length = 0;
  for (std::size_t i = 1; i < picked.size(); ++i)
    length += glm::length(picked[i].world - picked[i - 1].world);
  if (picked.size() > 1)
    note(fmt::format("{} points, {} {} long, {} {} horizontally", picked.size(),
                     view::coordinate_text(length, size), unit, view::coordinate_text(line_length(), size),
                     unit));
  float width = corridor();
  if (ImGui::SliderFloat("corridor", &width, float(1e-4 * size), float(0.2 * size), "%.4g",
                         ImGuiSliderFlags_Logarithmic))
    corridor_ = width;
  tooltip("width of what stands along the line and comes into its profile: " + unit);
  if (ImGui::Button("profile")) act(view::Action::profile);
  tooltip("all points in the corridor along the picked line, from the side (V)");
  ImGui::SameLine();
  if (ImGui::Button("forget points")) model_.picks.clear();
}

float Interface::corridor() const {
  return corridor_ > 0 ? corridor_ : float(0.01 * model_.navigator().scene_size());
}

double Interface::line_length() const {
  return view::horizontal_length(model_.picks.line(), model_.navigator().up_axis());
}

void Interface::draw_profile(float width, float height) {
  const auto& profile = model_.picks.profile();
  if (!profile) return;
  const float pad = 8 * window_.scale();
  const float tall = std::max(160 * window_.scale(), 0.42f * height);
  ImGui::SetNextWindowPos({pad, height - tall - pad});
  ImGui::SetNextWindowSize({width - 2 * pad, tall});
  bool open = true;
  ImGui::Begin("Profile", &open,
               ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoScrollbar);
  const std::string unit = view::unit_of(model_.scene.crs());
  const auto save = [&](const char* extension, const auto& write) {
    const std::string name = free_name("profile", extension);
    try {
      write(name);
      model_.say("saved " + name);
    } catch (const Error& error) {
      model_.say(error.what(), true);
    }
  };
  if (ImGui::Button("save picture"))
    save(".png", [&](const std::string& name) {
      io::write_png(name, picture_of(*profile, unit, 1600, 700), false, {});
    });
  ImGui::SameLine();
  if (ImGui::Button("save table"))
    save(".csv", [&](const std::string& name) {
      view::write_profile(name, *profile, model_.navigator().scene_size());
    });
  tooltip("distance, height, coordinates and number of each point, as CSV");
  const ImVec2 pixels = ImGui::GetIO().DisplayFramebufferScale, room = ImGui::GetContentRegionAvail();
  const int w = int(room.x * pixels.x), h = int(room.y * pixels.y);
  const std::tuple wanted(profile->id, w, h);
  if (w > 0 && h > 0) {
    if (wanted != plotted_) window_.upload_plot(picture_of(*profile, unit, w, h));
    plotted_ = wanted;
    ImGui::Image(window_.plot(), room);
  }
  ImGui::End();
  if (!open) model_.picks.close_profile();
}

}  // namespace sfumato::viewer
