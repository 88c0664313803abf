// Clip box, camera, camera path.
#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>

#include "../picture/saved_picture.h"
#include "core/error.h"
#include "interface.h"
#include "panel_tools.h"

namespace sfumato::viewer {

void Interface::clip_panel() {
  clip_ = heading("Clip box", false);
  const view::Loaded* scene = model_.scene.loaded();
  if (!clip_ || !scene) return;
  const auto& crop = model_.request().points.selection.crop;
  bool on = crop.has_value();
  const auto clip = [&](const std::optional<Bounds>& box) {
    model_.change("clip", [&](view::ViewRequest& next) {
      next.points.selection.crop = box;
      next.points.selection.crop_share.reset();
    });
  };
  if (ImGui::Checkbox("show only the points in a box", &on))
    clip(on ? std::optional(scene->box) : std::nullopt);
  if (!crop) return;
  Bounds box = *crop;
  for (int axis = 0; axis < 3; ++axis) {
    // Distances from the corner of the scene: floats hold them where coordinates are millions.
    const double from = scene->box.min[axis], size = std::max(1e-9, scene->box.max[axis] - from);
    float low = float(box.min[axis] - from), high = float(box.max[axis] - from);
    ImGui::PushID(axis);
    if (ImGui::DragFloatRange2(std::string(1, "xyz"[axis]).c_str(), &low, &high, float(0.003 * size), 0,
                               float(size), "%.5g", "%.5g")) {
      box.min[axis] = low <= 0 ? from : from + double(low);
      box.max[axis] = double(high) >= size ? scene->box.max[axis] : from + double(high);
      clip(box);
    }
    tooltip("drag both ends; counted from the scene's corner");
    ImGui::PopID();
  }
  // The box as a slice: one side moves, with its thickness.
  if (const auto chosen = choose("slice along", std::string(1, "xyz"[slice_axis_]), {"x", "y", "z"}))
    slice_axis_ = chosen->front() - 'x';
  const double from = scene->box.min[slice_axis_], size = std::max(1e-9, scene->box.max[slice_axis_] - from);
  const double thickness = std::min(size, box.max[slice_axis_] - box.min[slice_axis_]);
  float middle = float(0.5 * (box.min[slice_axis_] + box.max[slice_axis_]) - from), thick = float(thickness);
  const bool moved = ImGui::SliderFloat("place", &middle, 0, float(size), "%.5g");
  if (bool thinned = ImGui::SliderFloat("thickness", &thick, float(1e-3 * size), float(size), "%.4g",
                                        ImGuiSliderFlags_Logarithmic);
      moved || thinned) {
    box.min[slice_axis_] = from + double(middle) - 0.5 * double(thick);
    box.max[slice_axis_] = box.min[slice_axis_] + double(thick);
    clip(box);
  }
}

void Interface::camera_panel() {
  if (!heading("Camera", false)) return;
  const view::ViewCamera& camera = model_.request().camera;
  const double size = model_.navigator().scene_size();
  const auto row = [&](const char* name, const dvec3& v) {
    ImGui::TextDisabled("%s", name);
    ImGui::SameLine(76 * window_.scale());
    ImGui::TextUnformatted(fmt::format("{} {} {}", view::coordinate_text(v.x, size),
                                       view::coordinate_text(v.y, size), view::coordinate_text(v.z, size))
                               .c_str());
  };
  row("position", camera.position);
  row("target", camera.target);
  float angle = float(camera.fov_deg);
  if (ImGui::SliderFloat("angle", &angle, 5, 120, "%.1f°"))
    model_.move("angle", [&](view::Navigator& hand) { hand.set_angle(double(angle)); });
  bool parallel = camera.orthographic;
  if (ImGui::Checkbox("parallel", &parallel)) act(view::Action::orthographic);
  struct {
    const char* name;
    view::Action action;
  } const sides[] = {{"front", view::Action::front},      {"right", view::Action::right},
                     {"top", view::Action::top},          {"iso", view::Action::iso},
                     {"frame", view::Action::frame_view}, {"reset", view::Action::reset_view}};
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
  if (ImGui::Button(model_.saved_pictures.pending() ? "saving" : "save picture"))
    act(view::Action::screenshot);
}

void Interface::path_panel() {
  if (!heading("Camera path", false)) return;
  view::KeyFrames& path = model_.path;
  if (ImGui::Button("add this view")) act(view::Action::add_key);
  ImGui::SameLine();
  if (ImGui::Button(model_.playing() ? "stop" : "play")) act(view::Action::play);
  float seconds = float(path.seconds_per_key);
  if (ImGui::SliderFloat("s a key", &seconds, 0.2f, 10, "%.1f")) path.seconds_per_key = double(seconds);
  for (std::size_t i = 0; i < path.keys().size(); ++i) {
    ImGui::PushID(int(i));
    if (ImGui::SmallButton(fmt::format("key {}", i + 1).c_str())) {
      const view::ViewCamera key = path.keys()[i];
      model_.move("key", [&](view::Navigator& hand) { hand.set_camera(key); });
    }
    ImGui::SameLine();
    if (ImGui::SmallButton("replace")) path.replace(i, model_.request().camera);
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
      path.save(name, model_.width(), model_.height());
      // The whole of what follows draws it, with the look of now.
      std::vector<std::string> words = model_.request().words(model_.width(), model_.height());
      std::erase_if(words, [](const std::string& word) { return word.starts_with("--camera-"); });
      const int frames = int(std::lround(25 * path.duration_s())) + 1;
      words.insert(words.end(), {"--path", name, "--frames", std::to_string(frames)});
      window_.copy(command_of(words, "path.mp4"));
      model_.say("saved " + name + "; the command that makes a video of it is copied");
    } catch (const Error& error) {
      model_.say(error.what(), true);
    }
  }
}

}  // namespace sfumato::viewer
