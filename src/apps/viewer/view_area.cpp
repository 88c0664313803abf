// The picture, the hand that moves it, and what is drawn over it.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "../picture/saved_picture.h"
#include "interface.h"
#include "panel_tools.h"
#include "view/light_hand.h"

namespace sfumato::viewer {

using view::Drag;

namespace {

constexpr int flying_keys[] = {'W', 'S', 'A', 'D', 'E', 'Q'};
constexpr int left_shift = 340, right_shift = 344, left_control = 341,
              right_control = 345;  // as GLFW numbers them

}  // namespace

std::optional<double> Interface::wait_ms(double) const {
  for (const int key : flying_keys)
    if (window_.is_down(key) && !ImGui::GetIO().WantTextInput) return 0;
  if (!toasts_.empty() || !writers_.empty()) return 100;
  if (ImGui::GetIO().WantTextInput) return 300;  // the cursor blinks
  return std::nullopt;
}

void Interface::show_picture() {
  const auto& picture = model_.picture();
  const Furniture& furniture = model_.request().furniture;
  if (!picture || (picture == uploaded_ && uploaded_furniture_ == furniture)) return;
  uploaded_ = picture;
  uploaded_furniture_ = furniture;
  const bool exact = picture->image.width() == model_.width() && picture->image.height() == model_.height();
  if (furniture.empty() || !exact) return window_.upload(picture->image, exact);
  Image<Rgba8> explained = picture->image;
  draw_furniture(explained, *picture, furniture, model_.scene.up(), model_.scene.crs());
  window_.upload(explained, exact);
}

void Interface::draw_view(double now_ms, float width, float height) {
  ImGui::SetNextWindowPos({0, 0});
  ImGui::SetNextWindowSize({width, height});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
  ImGui::Begin("view", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoNav |
                   ImGuiWindowFlags_NoScrollWithMouse | ImGuiWindowFlags_NoBackground |
                   ImGuiWindowFlags_NoSavedSettings);
  ImGui::PopStyleVar();
  const ImVec2 pixels = ImGui::GetIO().DisplayFramebufferScale;
  model_.set_size(int(std::lround(width * pixels.x)), int(std::lround(height * pixels.y)));
  show_picture();
  ImDrawList* list = ImGui::GetWindowDrawList();
  ImGui::InvisibleButton("hand", {width, height},
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                             ImGuiButtonFlags_MouseButtonMiddle);
  const bool hovered = ImGui::IsItemHovered();
  window_.place_picture(model_.width(), model_.height());
  navigate(now_ms, pixels.x, pixels.y, hovered);
  draw_box(pixels.x, pixels.y);
  draw_marks(pixels.x, pixels.y);
  if (!uploaded_) {
    const std::string text = model_.activity().text.empty() ? "opening" : model_.activity().text;
    const ImVec2 size = ImGui::CalcTextSize(text.c_str());
    const float bar = 220 * window_.scale(), x = 0.5f * width, y = 0.5f * height;
    list->AddText({x - 0.5f * size.x, y - 1.6f * size.y}, ImGui::GetColorU32(ImGuiCol_Text), text.c_str());
    list->AddRectFilled({x - 0.5f * bar, y}, {x + 0.5f * bar, y + 4 * window_.scale()},
                        ImGui::GetColorU32(ImGuiCol_FrameBg), 2);
    list->AddRectFilled({x - 0.5f * bar, y},
                        {x + bar * (float(model_.activity().fraction) - 0.5f), y + 4 * window_.scale()},
                        ImGui::GetColorU32(ImGuiCol_PlotHistogram), 2);
  }
  ImGui::End();
}

void Interface::navigate(double now_ms, float sx, float sy, bool hovered) {
  const ImGuiIO& io = ImGui::GetIO();
  const double x = double(io.MousePos.x * sx), y = double(io.MousePos.y * sy);
  if (!model_.picture()) return;
  bool began = false;  // the way to where the button went down is no drag
  const auto clicked = [&](ImGuiMouseButton button) { return hovered && ImGui::IsMouseClicked(button); };
  if (drag_ == Drag::none && (clicked(ImGuiMouseButton_Left) || clicked(ImGuiMouseButton_Right) ||
                              clicked(ImGuiMouseButton_Middle))) {
    const bool left = clicked(ImGuiMouseButton_Left);
    drag_ = left && io.KeyShift && io.KeyCtrl ? Drag::light : left && !io.KeyShift ? Drag::rotate : Drag::pan;
    drag_px_ = 0;
    began = true;
    pivot_ = model_.grab(drag_, x, y);
    swallow_click_ = false;
    if (drag_ == Drag::rotate && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) {
      swallow_click_ = true;
      const dvec3 place = pivot_;
      model_.move("pivot", [&](view::Navigator& hand) { hand.look_at(place); });
    }
  }
  if (drag_ != Drag::none) {
    const double dx = began ? 0 : double(io.MouseDelta.x * sx), dy = began ? 0 : double(io.MouseDelta.y * sy);
    drag_px_ += std::abs(dx) + std::abs(dy);
    // A click trembles by a pixel or two and moves nothing.
    if ((dx != 0 || dy != 0) && drag_px_ > 3) model_.drag(drag_, pivot_, dx, dy);
    if (!io.MouseDown[0] && !io.MouseDown[1] && !io.MouseDown[2]) {
      if (drag_ == Drag::rotate && drag_px_ <= 3 && !swallow_click_) model_.pick(x, y, io.KeyCtrl);
      drag_ = Drag::none;
    }
  }
  if (hovered && io.MouseWheel != 0) {
    const double steps = double(io.MouseWheel);
    if (io.KeyShift) {
      model_.move("angle", [&](view::Navigator& hand) { hand.set_angle(hand.camera().fov_deg - 2 * steps); });
    } else {
      const dvec3 place = model_.place_at(x, y);
      model_.move("zoom", [&](view::Navigator& hand) { hand.zoom(steps, place); });
    }
  }
  const double seconds = std::clamp(1e-3 * (now_ms - last_fly_ms_), 0.0, 0.1);
  last_fly_ms_ = now_ms;
  const bool control = window_.is_down(left_control) || window_.is_down(right_control);
  if (io.WantTextInput || control) return;
  const auto axis = [&](int plus, int minus) {
    return double(window_.is_down(plus)) - double(window_.is_down(minus));
  };
  const dvec3 way(axis('D', 'A'), axis('E', 'Q'), axis('W', 'S'));
  const bool fast = window_.is_down(left_shift) || window_.is_down(right_shift);
  if (way != dvec3(0))
    model_.move("fly", [&](view::Navigator& hand) { hand.fly(way, seconds, fast ? 5 : 1); });
}

void Interface::draw_marks(float sx, float sy) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  const Camera camera = model_.camera();
  const auto place = [&](const dvec3& world) {
    const dvec3 p = view::project(camera, world);
    return std::pair(ImVec2(float(p.x) / sx, float(p.y) / sy), p.z > 0 || camera.orthographic());
  };
  const float r = 4 * window_.scale();
  const ImU32 accent = paint(0xffb000), rim = paint(0x101010, 0.8f);
  if (drag_ == Drag::light) draw_light_ball(sx, sy);
  if (drag_ != Drag::none && drag_ != Drag::light && drag_px_ > 3)
    if (const auto [at, seen] = place(pivot_); seen) {
      list->AddCircle(at, r + 1, rim, 24, 3.5f);
      list->AddCircle(at, r + 1, paint(0xffffff), 24, 1.5f);
    }
  const auto& picked = model_.picks.points();
  for (std::size_t i = 1; i < picked.size(); ++i) {
    const auto [a, seen_a] = place(picked[i - 1].world);
    const auto [b, seen_b] = place(picked[i].world);
    if (seen_a && seen_b) {
      list->AddLine(a, b, rim, 3.5f);
      list->AddLine(a, b, accent, 1.5f);
      const view::Measure m =
          view::measure(picked[i - 1].world, picked[i].world, model_.navigator().up_axis());
      const std::string unit = view::unit_of(model_.scene.crs());
      const double size = model_.navigator().scene_size();
      if (picked.size() <= 12)
        label(list, {0.5f * (a.x + b.x) + 3 * r, 0.5f * (a.y + b.y)},
              fmt::format("{} {}", view::coordinate_text(m.distance, size), unit));
    }
  }
  for (const view::Picked& each : picked)
    if (const auto [at, seen] = place(each.world); seen) {
      list->AddCircleFilled(at, r + 1.5f, rim, 24);
      list->AddCircleFilled(at, r, accent, 24);
    }
  // What the newest picked point holds, in the corner.
  if (picked.empty()) return;
  const view::Picked& last = picked.back();
  const double size = model_.navigator().scene_size();
  std::string text = fmt::format("x {}  y {}  z {}\npoint {}", view::coordinate_text(last.world.x, size),
                                 view::coordinate_text(last.world.y, size),
                                 view::coordinate_text(last.world.z, size), last.source);
  for (const auto& [name, value] : last.attributes) text += "\n" + name + "  " + value;
  if (picked.size() == 2) {
    const view::Measure m = view::measure(picked[0].world, last.world, model_.navigator().up_axis());
    const std::string unit = view::unit_of(model_.scene.crs());
    text += fmt::format("\ndistance {} {}\nheight {} {}\nhorizontal {} {}",
                        view::coordinate_text(m.distance, size), unit, view::coordinate_text(m.height, size),
                        unit, view::coordinate_text(m.horizontal, size), unit);
  }
  label(list, {12 * window_.scale(), 12 * window_.scale()}, text);
}

/// The ball that the light hangs on, and where: a full dot before it, a ring behind.
void Interface::draw_light_ball(float sx, float sy) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  const Camera camera = model_.camera();
  const dvec3 right = glm::normalize(glm::cross(camera.direction(), camera.up)),
              above = glm::cross(right, camera.direction());
  const dvec3 way = view::towards_light(model_.request().settings(), camera, model_.navigator().up_axis());
  const float ball = 0.25f * float(std::min(model_.width() / sx, model_.height() / sy)),
              r = 6 * window_.scale();
  const ImVec2 middle{0.5f * float(model_.width()) / sx, 0.5f * float(model_.height()) / sy};
  const ImVec2 at{middle.x + ball * float(glm::dot(way, right)),
                  middle.y - ball * float(glm::dot(way, above))};
  const ImU32 amber = paint(0xffb000), rim = paint(0x101010, 0.6f);
  list->AddCircle(middle, ball, rim, 64, 3);
  list->AddCircle(middle, ball, paint(0xffffff, 0.8f), 64, 1);
  list->AddLine(middle, at, rim, 3.5f);
  list->AddLine(middle, at, amber, 1.5f);
  const bool is_before = glm::dot(way, camera.direction()) <= 0;
  list->AddCircleFilled(at, r + 1.5f, rim, 24);
  if (is_before)
    list->AddCircleFilled(at, r, amber, 24);
  else
    list->AddCircle(at, r - 1, amber, 24, 2);
}

void Interface::draw_box(float sx, float sy) {
  const auto& crop = model_.request().points.selection.crop;
  if (!clip_ || !crop) return;
  const Camera camera = model_.camera();
  ImDrawList* list = ImGui::GetWindowDrawList();
  const std::array<dvec3, 8> corners = crop->corners();
  for (unsigned i = 0; i < 8; ++i)
    for (const unsigned bit : {1u, 2u, 4u}) {
      if (i & bit) continue;
      const dvec3 a = view::project(camera, corners[i]), b = view::project(camera, corners[i | bit]);
      if (!camera.orthographic() && (a.z <= 0 || b.z <= 0)) continue;
      list->AddLine({float(a.x) / sx, float(a.y) / sy}, {float(b.x) / sx, float(b.y) / sy},
                    paint(0xffb000, 0.8f), 1);
    }
}

}  // namespace sfumato::viewer
