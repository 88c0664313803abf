// Colours, classes, light.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "core/colormap.h"
#include "core/counted.h"
#include "interface.h"
#include "panel_tools.h"

namespace sfumato::viewer {
namespace {

/// Fields for two numbers that differ by about `span`: beside each other where all of their digits have room,
/// else below each other, and a small button beside them in any case. True when a hand changed one.
bool edit_range(double (&range)[2], double span) {
  const std::string format = fmt::format("%.{}f", view::decimals_of(span));
  const float speed = std::max(1e-6f, 0.005f * float(span));
  const ImGuiStyle& style = ImGui::GetStyle();
  const float gap = style.ItemInnerSpacing.x, usual = ImGui::CalcItemWidth();
  const auto width_of = [](const std::string& text) { return ImGui::CalcTextSize(text.c_str()).x; };
  const float room = ImGui::GetContentRegionAvail().x - gap - width_of("range") - style.ItemSpacing.x -
                     width_of("×") - 2 * style.FramePadding.x;
  float field = 0;
  for (const double end : range) field = std::max(field, width_of(view::coordinate_text(end, span)));
  field += 2 * style.FramePadding.x;
  const bool is_row = 2 * field + gap <= room;
  const float width = is_row ? std::max(field, 0.5f * (usual - gap)) : std::max(usual, std::min(field, room));
  // By the names behind ### a drag goes on when digits come and the fields move.
  const auto edit = [&](const char* name, double& end) {
    ImGui::SetNextItemWidth(width);
    return ImGui::DragScalar(name, ImGuiDataType_Double, &end, speed, nullptr, nullptr, format.c_str());
  };
  ImGui::BeginGroup();
  bool is_changed = edit(is_row ? "###low" : "from###low", range[0]);
  if (is_row) ImGui::SameLine(0, gap);
  is_changed |= edit(is_row ? "range###high" : "to###high", range[1]);
  ImGui::EndGroup();
  return is_changed;
}

}  // namespace

void Interface::color_panel() {
  if (!heading("Colour", false)) return;
  const view::ViewRequest& request = model_.request();
  const std::string shown = request.color.color_by == "auto" && picture()
                                ? "auto: " + picture()->coloring.source
                                : request.color.color_by;
  if (const auto chosen = choose("source", shown, view::color_sources(model_.scene.loaded())))
    model_.change("color-by", [&](view::ViewRequest& next) { next.show_source(*chosen); });
  if (picture() && picture()->coloring.kind == ColorKind::scalar) {
    const Coloring& coloring = picture()->coloring;
    std::vector<std::string> maps = Colormap::choices();
    maps.insert(maps.begin(), "auto");
    const std::string& own = request.color.colormap;
    if (const auto chosen = choose("map", own.empty() ? "auto: " + coloring.colormap : own, maps))
      model_.change("colormap",
                    [&](view::ViewRequest& next) { next.color.colormap = *chosen == "auto" ? "" : *chosen; });
    tooltip("a map of your own, or range, has equal steps; heights are spread by numbers of points else");
    // The map itself, as a bar.
    const Colormap map = coloring.ramp();
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float width = ImGui::GetContentRegionAvail().x, height = 10 * window_.scale();
    constexpr int steps = 48;
    for (int i = 0; i < steps; ++i) {
      const Rgba8 c = map.at((i + 0.5) / steps);
      ImGui::GetWindowDrawList()->AddRectFilled(
          {at.x + width * float(i) / steps, at.y}, {at.x + width * float(i + 1) / steps + 1, at.y + height},
          ImGui::GetColorU32(ImVec4(unit(c.r), unit(c.g), unit(c.b), 1)));
    }
    ImGui::Dummy({width, height});
    histogram(coloring);
    double range[2] = {coloring.low, coloring.high};
    const double span = std::abs(range[1] - range[0]);
    if (edit_range(range, span) && range[0] != range[1])
      model_.change("color-range", [&](view::ViewRequest& next) { next.color.range = {range[0], range[1]}; });
    tooltip(fmt::format("{} to {}, the ends of the colour map: drag, or Ctrl+click to type",
                        view::coordinate_text(coloring.low, span),
                        view::coordinate_text(coloring.high, span)));
    if (request.color.range) {
      ImGui::SameLine();
      if (ImGui::SmallButton("×"))
        model_.change("color-range", [](view::ViewRequest& next) { next.color.range.reset(); });
      tooltip("back to what suits the points");
    }
  }
  if (picture() && has_swatches()) {
    // What the colours stand for; a long list is scrolled.
    const auto& swatches = picture()->coloring.swatches;
    const float line = ImGui::GetTextLineHeightWithSpacing();
    ImGui::BeginChild("swatches", {0, line * float(std::min<std::size_t>(swatches.size(), 8)) + 4});
    for (const Swatch& each : swatches) {
      const ImVec2 at = ImGui::GetCursorScreenPos();
      const float side = 0.75f * ImGui::GetTextLineHeight();
      ImGui::GetWindowDrawList()->AddRectFilled({at.x, at.y + 2}, {at.x + side, at.y + 2 + side},
                                                paint(each.color.r << 16 | each.color.g << 8 | each.color.b),
                                                2);
      ImGui::Dummy({side, side});
      ImGui::SameLine();
      ImGui::TextUnformatted(each.label.c_str());
      ImGui::SameLine();
      ImGui::TextDisabled("%s", thousands(each.points).c_str());
    }
    ImGui::EndChild();
  }
  const auto color_edit = [&](const char* label, const char* option) {
    std::string value = text_of(request, option);
    if (edit_text(label, "as it suits", value))
      model_.change(label, [&](view::ViewRequest& next) { sfumato::set(next, option, value); });
    tooltip("a name (steelblue), #hex (#4682b4) or R,G,B from 0 to 1; Enter");
  };
  color_edit("background", "background-color");
  color_edit("one colour", "color");
  bool legend = request.furniture.legend;
  if (ImGui::Checkbox("legend", &legend)) act(view::Action::legend);
}

bool Interface::has_swatches() const { return !picture()->coloring.swatches.empty(); }

void Interface::histogram(const Coloring& coloring) {
  const view::Loaded* scene = model_.scene.loaded();
  if (!scene || !scene->near) return;
  constexpr std::size_t steps = 96;
  if (histogram_cloud_.lock() != scene->near || histogram_source_ != coloring.source) {
    histogram_cloud_ = scene->near, histogram_source_ = coloring.source;
    histogram_ = view::histogram_of(*scene->near, coloring.source, steps);
  }
  if (histogram_.counts.empty()) return;
  const Colormap map = coloring.ramp();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x, height = 54 * window_.scale();
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->AddRectFilled(at, {at.x + width, at.y + height}, ImGui::GetColorU32(ImGuiCol_FrameBg), 2);
  // Heights by the square root: what is rare is seen beside what is common.
  const float most = std::sqrt(float(*std::max_element(histogram_.counts.begin(), histogram_.counts.end())));
  const double span = histogram_.high - histogram_.low, colors = coloring.high - coloring.low;
  for (std::size_t i = 0; i < steps; ++i) {
    const double value = histogram_.low + (double(i) + 0.5) / steps * span;
    const Rgba8 c = map.at(std::clamp(colors != 0 ? (value - coloring.low) / colors : 0.5, 0.0, 1.0));
    const float tall = std::sqrt(float(histogram_.counts[i])) / most * (height - 2);
    list->AddRectFilled({at.x + width * float(i) / steps, at.y + height - tall},
                        {at.x + width * float(i + 1) / steps, at.y + height},
                        paint(c.r << 16 | c.g << 8 | c.b));
  }
  for (const double end : {coloring.low, coloring.high})
    if (span > 0 && end >= histogram_.low && end <= histogram_.high) {
      const float x = at.x + width * float((end - histogram_.low) / span);
      list->AddLine({x, at.y}, {x, at.y + height}, ImGui::GetColorU32(ImGuiCol_Text));
    }
  // A drag over it chooses the range.
  ImGui::InvisibleButton("histogram", {width, height});
  tooltip(fmt::format("{} from {} to {}, of a sample of the points; drag over it: the range of the colours",
                      coloring.source, view::coordinate_text(histogram_.low, span),
                      view::coordinate_text(histogram_.high, span)));
  if (ImGui::IsItemActivated()) histogram_from_ = ImGui::GetIO().MousePos.x;
  if (ImGui::IsItemActive() && std::abs(ImGui::GetIO().MousePos.x - histogram_from_) > 3) {
    const auto value_at = [&](float x) {
      return histogram_.low + double(std::clamp((x - at.x) / width, 0.0f, 1.0f)) * span;
    };
    const double a = value_at(histogram_from_), b = value_at(ImGui::GetIO().MousePos.x);
    if (a != b)
      model_.change("color-range", [&](view::ViewRequest& next) {
        next.color.range = {std::min(a, b), std::max(a, b)};
      });
  }
}

void Interface::class_panel() {
  const view::Loaded* scene = model_.scene.loaded();
  if (!scene || scene->classes.empty() || !heading("Classes", false)) return;
  const view::ViewRequest& request = model_.request();
  const auto hide = [&](const std::vector<int>& classes) {
    model_.change("classes", [&](view::ViewRequest& next) {
      next.points.selection.show_classes.clear();
      next.hide_classes = classes;
    });
  };
  for (const ClassShare& each : scene->classes) {
    ImGui::PushID(each.id);
    bool shown = request.shows_class(each.id);
    const Rgba8 c = picture() ? picture()->coloring.color_of_class(each.id) : class_color(each.id);
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float side = ImGui::GetFrameHeight();
    ImGui::GetWindowDrawList()->AddRectFilled(
        {at.x, at.y + 0.2f * side}, {at.x + 0.6f * side, at.y + 0.8f * side},
        ImGui::GetColorU32(ImVec4(unit(c.r), unit(c.g), unit(c.b), 1)), 2);
    ImGui::Dummy({0.6f * side, side});
    ImGui::SameLine();
    if (ImGui::Checkbox(fmt::format("{} {}", each.id, class_name(each.id)).c_str(), &shown))
      model_.show_class(each.id, shown);
    ImGui::SameLine();
    if (each.points > 0) {
      ImGui::TextDisabled("%s", thousands(each.points).c_str());
      ImGui::SameLine();
    }
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
  const std::string light = model_.request().settings().light_text;
  const bool by_direction = light.starts_with("dir:");
  if (const auto chosen = choose("comes from",
                                 by_direction           ? "a direction"
                                 : light == "shoulder"  ? "the upper left"
                                 : light == "headlight" ? "the eye"
                                                        : "a place",
                                 {"the upper left", "the eye", "a direction", "a place"})) {
    const dvec3 eye = model_.request().camera.position;
    if (*chosen == "the upper left") set("light", "shoulder");
    if (*chosen == "the eye") set("light", "headlight");
    if (*chosen == "a direction") {
      const dvec3 way = key_light(model_.camera(), model_.navigator().up_axis()).vector;
      set("light", fmt::format("dir:{:.3f},{:.3f},{:.3f}", way.x, way.y, way.z));
    }
    if (*chosen == "a place")
      set("light",
          view::number_text(eye.x) + "," + view::number_text(eye.y) + "," + view::number_text(eye.z));
  }
  tooltip("--light; Ctrl+Shift+drag over the picture moves it");
  if (by_direction) {
    const std::vector<float> v = view::numbers_of(light.substr(4));
    if (v.size() == 3) {
      const Compass compass(model_.navigator().up_axis());
      const dvec3 way = glm::normalize(dvec3(double(v[0]), double(v[1]), double(v[2])));
      float angles[2] = {float(glm::degrees(compass.azimuth(way))),
                         float(glm::degrees(compass.elevation(way)))};
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

}  // namespace sfumato::viewer
