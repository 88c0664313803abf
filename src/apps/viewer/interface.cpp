#include "interface.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "../cli/command_line.h"
#include "core/error.h"
#include "core/version.h"
#include "io/camera_json.h"
#include "io/image_png.h"
#include "labels/legend.h"
#include "session/preset.h"

namespace sfumato::viewer {
namespace {

using view::Action;

constexpr float panel_points = 330, status_points = 26;
constexpr int flying_keys[] = {'W', 'S', 'A', 'D', 'E', 'Q'};
constexpr int left_shift = 340, right_shift = 344, left_control = 341, right_control = 345;  // as GLFW numbers them

ImU32 paint(int rgb, float alpha = 1) {
  return ImGui::GetColorU32(
      ImVec4(float(rgb >> 16 & 255) / 255, float(rgb >> 8 & 255) / 255, float(rgb & 255) / 255, alpha));
}

/// Dark letters with a light rim, or the other way round: read on any picture.
void label(ImDrawList* list, ImVec2 at, const std::string& text, bool error = false) {
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  const float pad = 0.35f * ImGui::GetFontSize();
  list->AddRectFilled({at.x - pad, at.y - 0.5f * pad}, {at.x + size.x + pad, at.y + size.y + 0.5f * pad},
                      error ? paint(0x8c2f2f, 0.95f) : paint(0x202428, 0.86f), 4);
  list->AddText(at, paint(0xf0f2f4), text.c_str());
}

}  // namespace

std::string free_name(const std::string& stem, const std::string& extension) {
  for (int n = 1;; ++n) {
    const std::string name = fmt::format("{}_{:04}{}", stem, n, extension);
    std::error_code error;
    if (!std::filesystem::exists(std::filesystem::symlink_status(name, error))) return name;
  }
}

Interface::Interface(Window& window, view::Workbench& bench) : window_(window), bench_(bench) {}

std::optional<double> Interface::wait_ms(double) const {
  for (const int key : flying_keys)
    if (window_.is_down(key) && !ImGui::GetIO().WantTextInput) return 0;
  if (!toasts_.empty() || !writers_.empty()) return 100;
  if (ImGui::GetIO().WantTextInput) return 300;  // the cursor blinks
  return std::nullopt;
}

void Interface::draw(double now_ms) {
  now_ms_ = now_ms;
  for (view::Message& message : bench_.take_messages()) {
    const double stay = message.is_error ? 9000 : 4500;
    toasts_.push_back({std::move(message), now_ms + stay});
  }
  while (toasts_.size() > 5) toasts_.pop_front();
  if (!bench_.wishes().technique.empty()) {
    if (const std::string key = bench_.wishes().look_key(); key != look_key_ || !look_) {
      look_key_ = key;
      look_ = std::make_unique<Look>(bench_.wishes().technique);
      for (const auto& [name, value] : bench_.wishes().parameters_of(look_->name)) look_->set(name, value);
    }
  }
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  const float status = status_points * window_.scale();
  const float panel = panels_ ? std::min(panel_points * window_.scale(), 0.6f * screen.x) : 0;
  const float width = std::max(32.0f, std::floor(screen.x - panel)), height = std::max(32.0f, std::floor(screen.y - status));
  bench_.set_timings(timings_);
  draw_view(now_ms, width, height);
  if (panels_) draw_panels(width, screen.x - width, height);
  draw_status(height, screen.x, screen.y - height);
  if (help_) draw_help();
  draw_messages(now_ms, height);
  take_shots();
}

void Interface::show_picture() {
  const auto& picture = bench_.picture();
  if (!picture || (picture == uploaded_ && uploaded_legend_ == bench_.wishes().legend)) return;
  uploaded_ = picture;
  uploaded_legend_ = bench_.wishes().legend;
  const bool exact = picture->image.width() == bench_.width() && picture->image.height() == bench_.height();
  if (!uploaded_legend_ || !exact) return window_.upload(picture->image, exact);
  Image<Rgba8> explained = picture->image;
  labels::draw_legend(explained, picture->coloring, picture->background);
  window_.upload(explained, exact);
}

void Interface::draw_view(double now_ms, float width, float height) {
  ImGui::SetNextWindowPos({0, 0});
  ImGui::SetNextWindowSize({width, height});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
  ImGui::Begin("view", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoBringToFrontOnFocus |
                   ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoScrollWithMouse | ImGuiWindowFlags_NoSavedSettings);
  ImGui::PopStyleVar();
  const ImVec2 pixels = ImGui::GetIO().DisplayFramebufferScale;
  bench_.set_size(int(std::lround(width * pixels.x)), int(std::lround(height * pixels.y)));
  show_picture();
  ImDrawList* list = ImGui::GetWindowDrawList();
  ImGui::InvisibleButton("hand", {width, height},
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                             ImGuiButtonFlags_MouseButtonMiddle);
  const bool hovered = ImGui::IsItemHovered();
  if (uploaded_) list->AddImage(ImTextureID(window_.texture()), {0, 0}, {width, height});
  navigate(now_ms, pixels.x, pixels.y, hovered);
  draw_box(pixels.x, pixels.y);
  draw_marks(pixels.x, pixels.y);
  if (!uploaded_) {
    const std::string text = bench_.activity().text.empty() ? "opening" : bench_.activity().text;
    const ImVec2 size = ImGui::CalcTextSize(text.c_str());
    const float bar = 220 * window_.scale(), x = 0.5f * width, y = 0.5f * height;
    list->AddText({x - 0.5f * size.x, y - 1.6f * size.y}, ImGui::GetColorU32(ImGuiCol_Text), text.c_str());
    list->AddRectFilled({x - 0.5f * bar, y}, {x + 0.5f * bar, y + 4 * window_.scale()},
                        ImGui::GetColorU32(ImGuiCol_FrameBg), 2);
    list->AddRectFilled({x - 0.5f * bar, y}, {x + bar * (float(bench_.activity().fraction) - 0.5f), y + 4 * window_.scale()},
                        ImGui::GetColorU32(ImGuiCol_PlotHistogram), 2);
  }
  ImGui::End();
}

void Interface::navigate(double now_ms, float sx, float sy, bool hovered) {
  const ImGuiIO& io = ImGui::GetIO();
  const double x = double(io.MousePos.x * sx), y = double(io.MousePos.y * sy);
  const int height = bench_.height();
  if (!bench_.picture()) return;
  bool began = false;  // the way to where the button went down is no drag
  const auto clicked = [&](ImGuiMouseButton button) { return hovered && ImGui::IsMouseClicked(button); };
  if (drag_ == Drag::none &&
      (clicked(ImGuiMouseButton_Left) || clicked(ImGuiMouseButton_Right) || clicked(ImGuiMouseButton_Middle))) {
    drag_ = clicked(ImGuiMouseButton_Left) && !io.KeyShift ? Drag::rotate : Drag::pan;
    drag_px_ = 0;
    began = true;
    pivot_ = drag_ == Drag::rotate ? bench_.pivot_at(x, y) : bench_.place_at(x, y);
    swallow_click_ = false;
    if (drag_ == Drag::rotate && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) {
      swallow_click_ = true;
      const dvec3 place = pivot_;
      bench_.move("pivot", [&](view::Navigator& hand) { hand.look_at(place); });
    }
  }
  if (drag_ != Drag::none) {
    const double dx = began ? 0 : double(io.MouseDelta.x * sx), dy = began ? 0 : double(io.MouseDelta.y * sy);
    drag_px_ += std::abs(dx) + std::abs(dy);
    // A click trembles by a pixel or two and moves nothing.
    if ((dx != 0 || dy != 0) && drag_px_ > 3) {
      bench_.move(drag_ == Drag::rotate ? "rotate" : "pan", [&](view::Navigator& hand) {
        if (drag_ == Drag::rotate)
          hand.rotate(dx, dy, height, pivot_);
        else
          hand.pan(dx, dy, height, pivot_);
      });
    }
    if (!io.MouseDown[0] && !io.MouseDown[1] && !io.MouseDown[2]) {
      if (drag_ == Drag::rotate && drag_px_ <= 3 && !swallow_click_) bench_.pick(x, y);
      drag_ = Drag::none;
    }
  }
  if (hovered && io.MouseWheel != 0) {
    const double steps = double(io.MouseWheel);
    if (io.KeyShift) {
      bench_.move("angle", [&](view::Navigator& hand) { hand.set_angle(hand.camera().fov_deg - 2 * steps); });
    } else {
      const dvec3 place = bench_.place_at(x, y);
      bench_.move("zoom", [&](view::Navigator& hand) { hand.zoom(steps, place); });
    }
  }
  const double seconds = std::clamp(1e-3 * (now_ms - last_fly_ms_), 0.0, 0.1);
  last_fly_ms_ = now_ms;
  const bool control = window_.is_down(left_control) || window_.is_down(right_control);
  if (io.WantTextInput || control) return;
  const auto axis = [&](int plus, int minus) { return double(window_.is_down(plus)) - double(window_.is_down(minus)); };
  const dvec3 way(axis('D', 'A'), axis('E', 'Q'), axis('W', 'S'));
  const bool fast = window_.is_down(left_shift) || window_.is_down(right_shift);
  if (way != dvec3(0)) bench_.move("fly", [&](view::Navigator& hand) { hand.fly(way, seconds, fast ? 5 : 1); });
}

void Interface::draw_marks(float sx, float sy) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  const Camera camera = bench_.camera();
  const auto place = [&](const dvec3& world) {
    const dvec3 p = view::project(camera, world);
    return std::pair(ImVec2(float(p.x) / sx, float(p.y) / sy), p.z > 0 || camera.orthographic());
  };
  const float r = 4 * window_.scale();
  const ImU32 accent = paint(0xffb000), rim = paint(0x101010, 0.8f);
  if (drag_ != Drag::none && drag_px_ > 3)
    if (const auto [at, seen] = place(pivot_); seen) {
      list->AddCircle(at, r + 1, rim, 24, 3.5f);
      list->AddCircle(at, r + 1, paint(0xffffff), 24, 1.5f);
    }
  const auto& picked = bench_.picked();
  if (picked.size() == 2) {
    const auto [a, seen_a] = place(picked[0].world);
    const auto [b, seen_b] = place(picked[1].world);
    if (seen_a && seen_b) {
      list->AddLine(a, b, rim, 3.5f);
      list->AddLine(a, b, accent, 1.5f);
      const view::Measure m = view::measure(picked[0].world, picked[1].world, bench_.navigator().up_axis());
      const std::string unit = view::unit_of(bench_.scene() ? bench_.scene()->crs : "");
      const double size = bench_.navigator().scene_size();
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
  const double size = bench_.navigator().scene_size();
  std::string text = fmt::format("x {}  y {}  z {}\npoint {}", view::coordinate_text(last.world.x, size),
                                 view::coordinate_text(last.world.y, size), view::coordinate_text(last.world.z, size), last.source);
  for (const auto& [name, value] : last.attributes) text += "\n" + name + "  " + value;
  if (picked.size() == 2) {
    const view::Measure m = view::measure(picked[0].world, last.world, bench_.navigator().up_axis());
    const std::string unit = view::unit_of(bench_.scene() ? bench_.scene()->crs : "");
    text += fmt::format("\ndistance {} {}\nheight {} {}\nhorizontal {} {}", view::coordinate_text(m.distance, size), unit,
                        view::coordinate_text(m.height, size), unit, view::coordinate_text(m.horizontal, size), unit);
  }
  label(list, {12 * window_.scale(), 12 * window_.scale()}, text);
}

void Interface::draw_box(float sx, float sy) {
  const auto& crop = bench_.wishes().scene.selection.crop;
  if (!clip_ || !crop) return;
  const Camera camera = bench_.camera();
  ImDrawList* list = ImGui::GetWindowDrawList();
  const auto corner = [&](int i) {
    return dvec3(i & 1 ? crop->max.x : crop->min.x, i & 2 ? crop->max.y : crop->min.y, i & 4 ? crop->max.z : crop->min.z);
  };
  for (int i = 0; i < 8; ++i)
    for (int bit : {1, 2, 4}) {
      if (i & bit) continue;
      const dvec3 a = view::project(camera, corner(i)), b = view::project(camera, corner(i | bit));
      if (!camera.orthographic() && (a.z <= 0 || b.z <= 0)) continue;
      list->AddLine({float(a.x) / sx, float(a.y) / sy}, {float(b.x) / sx, float(b.y) / sy}, paint(0xffb000, 0.8f), 1);
    }
}

void Interface::draw_panels(float x, float width, float height) {
  ImGui::SetNextWindowPos({x, 0});
  ImGui::SetNextWindowSize({width, height});
  ImGui::Begin("panels", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings);
  ImGui::PushItemWidth(0.44f * width);
  technique_panel();
  if (look_) {
    parameter_panel();
    color_panel();
    class_panel();
    light_panel();
    clip_panel();
    camera_panel();
    path_panel();
    scene_panel();
    timing_panel();
  }
  ImGui::PopItemWidth();
  ImGui::End();
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
  if (const view::Loaded* scene = bench_.scene()) {
    text = fmt::format("{} points", scene->points_shown);
    if (scene->points_read > scene->points_shown) text += fmt::format(" of {}", scene->points_read);
  }
  if (const view::Picture* shown = picture()) {
    const view::Quality quality = bench_.shown_quality();
    text += fmt::format("   {}  {}×{}", shown->technique, shown->image.width(), shown->image.height());
    if (bench_.settled())
      text += fmt::format("  final, {:.0f} ms", shown->took_ms);
    else
      text += fmt::format("  {}{}", quality.whole_cloud ? "" : "a sample", bench_.moving() && bench_.motion_ms() > 0
                                        ? fmt::format("  {:.0f} pictures a second", 1000 / bench_.motion_ms())
                                        : "");
  }
  ImGui::TextUnformatted(text.c_str());
  const view::Activity& activity = bench_.activity();
  if (!activity.text.empty() && !bench_.moving()) {
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
  ImGui::SetNextWindowSize({std::min(0.96f * screen.x, 980 * window_.scale()), std::min(0.94f * screen.y, 620 * window_.scale())});
  ImGui::SetNextWindowFocus();
  ImGui::Begin("Keys and mouse", &help_,
               ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings);
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

void Interface::take_shots() {
  for (view::Shot& shot : bench_.take_shots()) {
    const std::string name = free_name("sfumato", ".png");
    // Taken at once, so that two pictures in a row do not get one name.
    if (std::FILE* file = std::fopen(name.c_str(), "wx")) std::fclose(file);
    writers_.push_back(std::async(std::launch::async, [shot = std::move(shot), name]() mutable -> view::Message {
      try {
        cli::Words command = shot.words;
        command.insert(command.begin(), "sfumato");
        command.insert(command.end(), {"-o", name});
        if (shot.legend) labels::draw_legend(shot.picture.image, shot.picture.coloring, shot.picture.background);
        io::write_png(name, shot.picture.image, false,
                      {{"Software", std::string("sfumato ") + version()},
                       {"Command", cli::quote(command)},
                       {"Camera", io::camera_to_json(shot.picture.camera)}});
        return {"saved " + name, false};
      } catch (const std::exception& error) {
        return {error.what(), true};
      }
    }));
  }
  std::erase_if(writers_, [&](auto& writer) {
    if (writer.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return false;
    const view::Message message = writer.get();
    bench_.say(message.text, message.is_error);
    return true;
  });
}

void Interface::drop(const std::vector<std::string>& files, bool add) {
  std::vector<std::string> clouds;
  for (const std::string& file : files) {
    if (std::filesystem::path(file).extension() != ".json") {
      clouds.push_back(file);
      continue;
    }
    preset_name_ = path_name_ = file;
    try {
      bench_.path.load(file);
      bench_.say(fmt::format("{}: a path of {} keys; Space plays it", file, bench_.path.keys().size()));
    } catch (const Error&) {
      take_preset(file);
    }
  }
  if (!clouds.empty()) bench_.open(clouds, add);
}

void Interface::act(Action action) {
  const auto show = [&](view::NamedView side) {
    bench_.move("side", [&](view::Navigator& hand) { hand.show(side, bench_.width(), bench_.height()); });
  };
  const auto parameter = [&](const std::string& name, const std::string& value) {
    bench_.change(name, [&](view::Wishes& wishes) { wishes.set(name, value); });
  };
  const auto resize_points = [&](double factor) {
    if (!look_) return;
    for (const char* name : {"point_size", "radius_scale", "disc_scale", "brush_scale"})
      if (const Param* param = look_->parameters.find(name)) {
        const std::vector<float> now = view::numbers_of(resolved(name));
        if (now.size() != 1) continue;
        const float wanted = std::clamp(float(double(now[0]) * factor), float(param->min.value_or(0)),
                                        float(param->max.value_or(1e9)));
        return parameter(name, view::number_text(std::round(wanted * 1000) / 1000));
      }
    bench_.say(bench_.wishes().technique + " has no size of points");
  };
  switch (action) {
    case Action::reset_view: bench_.move("reset", [](view::Navigator& hand) { hand.reset(); }); break;
    case Action::frame_view: bench_.move("frame", [&](view::Navigator& hand) { hand.frame(bench_.width(), bench_.height()); }); break;
    case Action::orthographic: bench_.move("parallel", [](view::Navigator& hand) { hand.toggle_orthographic(); }); break;
    case Action::front: show(view::NamedView::front); break;
    case Action::back: show(view::NamedView::back); break;
    case Action::right: show(view::NamedView::right); break;
    case Action::left: show(view::NamedView::left); break;
    case Action::top: show(view::NamedView::top); break;
    case Action::bottom: show(view::NamedView::bottom); break;
    case Action::fullscreen: window_.toggle_fullscreen(); break;
    case Action::panels: panels_ = !panels_; break;
    case Action::help: help_ = !help_; break;
    case Action::quit: window_.close(); break;
    case Action::screenshot: {
      int width = 0, height = 0;
      if (screenshot_size_.empty()) {
        bench_.shoot(bench_.width(), bench_.height());
      } else if (std::sscanf(screenshot_size_.c_str(), "%dx%d", &width, &height) == 2 && width > 0 && height > 0 &&
                 width <= 16384 && height <= 16384) {
        bench_.shoot(width, height);
      } else {
        bench_.say("'" + screenshot_size_ + "' is not WIDTHxHEIGHT, such as 3840x2160", true);
      }
      break;
    }
    case Action::copy_command: {
      cli::Words words = bench_.wishes().words(bench_.width(), bench_.height());
      words.insert(words.begin(), "sfumato");
      words.insert(words.end(), {"-o", "picture.png"});
      window_.copy(cli::quote(words));
      bench_.say("the command is copied");
      break;
    }
    case Action::copy_camera:
      window_.copy(io::camera_to_json(bench_.camera()));
      bench_.say("the camera is copied");
      break;
    case Action::paste_camera:
      try {
        const view::ViewCamera camera = view::ViewCamera::from(io::camera_from_json(window_.pasted(), "the clipboard"));
        bench_.move("paste", [&](view::Navigator& hand) { hand.set_camera(camera); });
      } catch (const Error& error) {
        bench_.say(error.what(), true);
      }
      break;
    case Action::undo: bench_.undo(); break;
    case Action::redo: bench_.redo(); break;
    case Action::larger_points: resize_points(1.15); break;
    case Action::smaller_points: resize_points(1 / 1.15); break;
    case Action::eye_dome: {
      if (!look_) break;
      parameter("edl", resolved("edl") == "true" ? "false" : "true");
      break;
    }
    case Action::shadows: {
      if (!look_) break;
      const std::string now = look_->parameters.find("shadows")->get();
      parameter("shadows", now == "off" ? "hard" : now == "hard" ? "soft" : "off");
      break;
    }
    case Action::legend: bench_.change("legend", [](view::Wishes& wishes) { wishes.legend = !wishes.legend; }); break;
    case Action::clear_picks:
      help_ = false;
      bench_.clear_picked();
      bench_.play(false);
      break;
    case Action::add_key:
      bench_.path.add(bench_.wishes().camera);
      bench_.say(fmt::format("key {} of the camera path", bench_.path.keys().size()));
      break;
    case Action::play: bench_.play(!bench_.playing()); break;
    case Action::larger_interface: window_.zoom_interface(1.125f); break;
    case Action::smaller_interface: window_.zoom_interface(1 / 1.125f); break;
    case Action::theme: window_.set_dark(!window_.is_dark()); break;
    default: {
      const std::size_t i = std::size_t(action) - std::size_t(Action::technique_1);
      if (i < all_techniques().size())
        bench_.change("technique", [&](view::Wishes& wishes) { wishes.technique = all_techniques()[i].name; });
    }
  }
}

}  // namespace sfumato::viewer
