// What keys and buttons do, and what leaves the window as files.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "../picture/saved_picture.h"
#include "core/error.h"
#include "core/option_text.h"
#include "interface.h"
#include "io/camera_json.h"

namespace sfumato::viewer {

using view::Action;

std::string free_name(const std::string& stem, const std::string& extension) {
  for (int n = 1;; ++n) {
    const std::string name = fmt::format("{}_{:04}{}", stem, n, extension);
    std::error_code error;
    if (!std::filesystem::exists(std::filesystem::symlink_status(name, error))) return name;
  }
}

void Interface::take_saved() {
  for (view::SavedPicture& saved : model_.saved_pictures.take()) {
    const std::string name = free_name("sfumato", ".png");
    // Taken at once, so that two pictures in a row do not get one name.
    if (std::FILE* file = std::fopen(name.c_str(), "wx")) std::fclose(file);
    writers_.push_back(
        std::async(std::launch::async, [saved = std::move(saved), name]() mutable -> view::Message {
          try {
            const io::PngTexts texts = finish(saved, name);
            io::write_png(name, saved.picture.image, false, texts);
            return {"saved " + name, false};
          } catch (const std::exception& error) {
            // The name is free again, where nobody else has written there.
            std::error_code none;
            if (std::filesystem::file_size(name, none) == 0) std::filesystem::remove(name, none);
            return {error.what(), true};
          }
        }));
  }
  std::erase_if(writers_, [&](auto& writer) {
    if (writer.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return false;
    const view::Message message = writer.get();
    model_.say(message.text, message.is_error);
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
      model_.path.load(file);
      model_.say(fmt::format("{}: a path of {} keys; Space plays it", file, model_.path.keys().size()));
    } catch (const Error&) {
      take_preset(file);
    }
  }
  if (!clouds.empty()) model_.open(clouds, add);
}

void Interface::act(Action action) {
  const auto show = [&](const char* side) {
    model_.move("side", [&](view::Navigator& hand) {
      hand.show(find_view(side, "view"), model_.width(), model_.height());
    });
  };
  const auto parameter = [&](const std::string& name, const std::string& value) {
    model_.change(name, [&](view::ViewRequest& request) { request.set(name, value); });
  };
  const auto resize_points = [&](double factor) {
    if (!look_) return;
    for (const Param& param : look_->parameters.all())
      if (param.is_point_size) {
        const std::vector<float> now = view::numbers_of(resolved(param.name));
        if (now.size() != 1 || now[0] == 0) continue;  // 0: as small as it can be
        const float wanted = std::clamp(float(double(now[0]) * factor), float(param.min.value_or(0)),
                                        float(param.max.value_or(1e9)));
        return parameter(param.name, view::number_text(std::round(wanted * 1000) / 1000));
      }
    model_.say(model_.request().technique + " has no size of points");
  };
  switch (action) {
    case Action::reset_view:
      model_.move("reset", [&](view::Navigator& hand) { hand.set_camera(model_.request().home); });
      break;
    case Action::frame_view:
      model_.move("frame", [&](view::Navigator& hand) { hand.frame(model_.width(), model_.height()); });
      break;
    case Action::orthographic:
      model_.move("parallel", [](view::Navigator& hand) { hand.toggle_orthographic(); });
      break;
    case Action::front: show("front"); break;
    case Action::back: show("back"); break;
    case Action::right: show("right"); break;
    case Action::left: show("left"); break;
    case Action::top: show("top"); break;
    case Action::bottom: show("bottom"); break;
    case Action::iso: show("iso"); break;
    case Action::fullscreen: window_.toggle_fullscreen(); break;
    case Action::panels: panels_ = !panels_; break;
    case Action::help: help_ = !help_; break;
    case Action::quit: window_.close(); break;
    case Action::screenshot: {
      if (screenshot_size_.empty()) {
        model_.save_picture(model_.width(), model_.height());
        break;
      }
      try {
        const auto [width, height] = parse_resolution("size of the view", screenshot_size_);
        if (std::max(width, height) > 16384)
          throw Error(ErrorCode::usage, "size of the view: at most 16384 pixels a side");
        model_.save_picture(width, height);
      } catch (const Error& error) {
        model_.say(error.what(), true);
      }
      break;
    }
    case Action::copy_command: {
      window_.copy(command_of(model_.request().words(model_.width(), model_.height()), "picture.png"));
      model_.say("the command is copied");
      break;
    }
    case Action::copy_camera:
      window_.copy(io::camera_to_json(model_.camera()));
      model_.say("the camera is copied");
      break;
    case Action::paste_camera:
      try {
        const view::ViewCamera camera =
            view::ViewCamera::from(io::camera_from_json(window_.pasted(), "the clipboard"));
        model_.move("paste", [&](view::Navigator& hand) { hand.set_camera(camera); });
      } catch (const Error& error) {
        model_.say(error.what(), true);
      }
      break;
    case Action::undo: model_.undo(); break;
    case Action::redo: model_.redo(); break;
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
    case Action::legend:
      model_.change("legend",
                    [](view::ViewRequest& request) { request.furniture.legend = !request.furniture.legend; });
      break;
    case Action::clear_picks:
      help_ = false;
      model_.picks.clear();
      model_.picks.close_profile();
      model_.play(false);
      break;
    case Action::profile: model_.cut_profile(double(corridor())); break;
    case Action::add_key:
      model_.path.add(model_.request().camera);
      model_.say(fmt::format("key {} of the camera path", model_.path.keys().size()));
      break;
    case Action::play:
      if (model_.sequence.frames().size() > 1 && model_.path.keys().size() < 2)
        model_.sequence.play(!model_.sequence.playing());
      else
        model_.play(!model_.playing());
      break;
    case Action::larger_interface: window_.zoom_interface(1.125f); break;
    case Action::smaller_interface: window_.zoom_interface(1 / 1.125f); break;
    case Action::theme: window_.set_dark(!window_.is_dark()); break;
    default: {
      const std::size_t i = std::size_t(action) - std::size_t(Action::technique_1);
      if (i < all_techniques().size())
        model_.change("technique",
                      [&](view::ViewRequest& request) { request.technique = all_techniques()[i].name; });
    }
  }
}

}  // namespace sfumato::viewer
