#include "viewer.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "core/error.h"
#include "interface.h"
#include "window.h"

namespace sfumato::viewer {
namespace {

double now_ms() {
  using Clock = std::chrono::steady_clock;
  static const Clock::time_point start = Clock::now();
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

std::string title_of(const std::vector<std::string>& files) {
  if (files.empty()) return "sfumato";
  const std::string first = std::filesystem::path(files.front()).filename().string();
  return first + (files.size() > 1 ? " and " + std::to_string(files.size() - 1) + " more" : "") +
         " - sfumato";
}

/// --verbose: what happens, in lines.
class Teller {
 public:
  explicit Teller(view::ViewModel& model) : model_(model) {}
  void tell() {
    const auto& picture = model_.picture();
    if (!picture || picture == told_) return;
    if (!told_) say("first picture after " + std::to_string(long(model_.first_picture_ms())) + " ms");
    told_ = picture;
    const std::string what = picture->technique + " " + std::to_string(picture->image.width()) + "x" +
                             std::to_string(picture->image.height());
    if (!model_.settled()) {
      ++moving_;
      moving_ms_ += picture->took_ms;
      if (moving_ == 1) moving_since_ms_ = now_ms();
      last_ = what;
      return;
    }
    if (moving_ > 1)
      say("in motion: " + std::to_string(moving_) + " pictures in " +
          std::to_string(long(now_ms() - moving_since_ms_)) + " ms, each " +
          std::to_string(long(moving_ms_ / moving_)) + " ms, the last " + last_);
    moving_ = 0, moving_ms_ = 0;
    say("final picture: " + what + ", " + std::to_string(long(picture->took_ms)) + " ms");
  }
  static void say(const std::string& line) { std::fprintf(stderr, "sfumato: %s\n", line.c_str()); }

 private:
  view::ViewModel& model_;
  std::shared_ptr<const view::Picture> told_;
  int moving_ = 0;
  double moving_ms_ = 0, moving_since_ms_ = 0;
  std::string last_;
};

int show(view::Start start, const Settings& settings) {
  now_ms();
  Window window(settings.width, settings.height, title_of(start.request.files));
  start.wake = [] { Window::wake(); };
  view::ViewModel model(std::move(start));
  Interface interface(window, model);
  if (settings.verbose) model.on_message = [](const view::Message& message) { Teller::say(message.text); };
  Teller teller(model);
  window.on_key = [&](int key, int modifiers) {
    if (const auto action = view::action_of(key, modifiers)) interface.act(*action);
  };
  window.on_drop = [&](const std::vector<std::string>& files, bool add) { interface.drop(files, add); };

  std::vector<std::string> shown_files = model.request().files;
  // An interface settles in a few frames: what was hovered, what scrolls, what was typed.
  int lively = 3;
  while (!window.closing() && !settings.cancelled()) {
    double wait_s = 0.5;
    for (const auto& due : {model.wait_ms(now_ms()), interface.wait_ms(now_ms()), window.owed_ms(now_ms())})
      if (due) wait_s = std::min(wait_s, 1e-3 * *due);
    if (lively > 0) wait_s = std::min(wait_s, 0.004);
    const double before = now_ms();
    window.begin_frame(wait_s);
    lively = now_ms() - before < 1e3 * wait_s - 1 ? 3 : std::max(0, lively - 1);
    model.tick(now_ms());
    interface.draw(now_ms());
    model.tick(now_ms());  // what the hand just did is asked for at once
    window.end_frame(now_ms(), model.moving());
    if (settings.verbose) teller.tell();
    if (const auto& fatal = model.fatal()) throw Error(fatal->code, fatal->message);
    if (model.request().files != shown_files) window.set_title(title_of(shown_files = model.request().files));
  }
  return settings.cancelled() ? int(ErrorCode::interrupted) : 0;
}

}  // namespace

int run(view::Start start, const Settings& settings) {
  const int code = show(std::move(start), settings);
  if (!view::Loader::has_left_work()) return code;
  std::fflush(nullptr);
  std::_Exit(code);
}

}  // namespace sfumato::viewer
