// An hour in the life of a window, or as many minutes as one has: a hand that drags, clicks, types and
// presses keys at random, but the same for the same seed. Nothing may crash, the driver may not complain,
// memory may not grow.
//
// usage: sfumato_soak --minutes M [--seed S] [--scratch FOLDER]     on a display (xvfb-run)
#include <fmt/format.h>
#include <imgui.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>

#include "apps/viewer/interface.h"
#include "apps/viewer/window.h"
#include "core/error.h"

namespace {

using namespace sfumato;
using namespace sfumato::viewer;

double now_ms() {
  using Clock = std::chrono::steady_clock;
  static const Clock::time_point start = Clock::now();
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Memory of the process that is in use, MB; what is free goes back to the system first.
double memory_mb() {
  malloc_trim(0);
  std::ifstream statm("/proc/self/statm");
  double pages = 0, resident = 0;
  statm >> pages >> resident;
  return resident * double(sysconf(_SC_PAGESIZE)) / (1 << 20);
}

/// What a hand does next, a step a frame.
class Hand {
 public:
  Hand(unsigned seed, Window& window, view::ViewModel& model, Interface& interface,
       std::vector<std::string> files)
      : random_(seed), window_(window), model_(model), interface_(interface), files_(std::move(files)) {}

  /// In place of the input of this frame.
  void move() {
    ImGuiIO& io = ImGui::GetIO();
    if (steps_ <= 0) choose();
    --steps_;
    x_ = std::clamp(x_ + dx_, 1.0f, io.DisplaySize.x - 2),
    y_ = std::clamp(y_ + dy_, 1.0f, io.DisplaySize.y - 2);
    io.MousePos = {x_, y_};
    for (int button = 0; button < 3; ++button) io.MouseDown[button] = button == button_ && steps_ > 0;
    io.MouseWheel = std::exchange(wheel_, 0.0f);
    io.KeyCtrl = control_, io.KeyShift = shift_;
    if (!typed_.empty()) {
      io.AddInputCharacter(unsigned(typed_.back()));
      typed_.pop_back();
    }
    for (const ImGuiKey key : {ImGuiKey_Enter, ImGuiKey_Tab, ImGuiKey_Escape}) {
      const bool is_down = key == key_ && steps_ > 0;
#if IMGUI_VERSION_NUM < 18700
      io.KeysDown[io.KeyMap[key]] = is_down;
#else
      io.AddKeyEvent(key, is_down);
#endif
    }
  }
  long done() const { return done_; }
  const std::string& last() const { return last_; }
  /// Lets everything go.
  void rest() {
    steps_ = 1 << 30, dx_ = dy_ = 0, button_ = -1, key_ = -1, control_ = shift_ = false, typed_.clear();
  }
  void go_on() { steps_ = 0; }

 private:
  int dice(int sides) { return int(random_() % unsigned(sides)); }
  float share() { return float(random_() % 10'001u) / 10'000.0f; }
  void jump(float x0, float x1) {
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    x_ = screen.x * (x0 + (x1 - x0) * share()), y_ = screen.y * share();
  }
  void choose() {
    ++done_;
    dx_ = dy_ = 0, button_ = -1, key_ = -1, wheel_ = 0, control_ = shift_ = false, typed_.clear(), steps_ = 2;
    const int what = dice(100);
    const auto name = [&](std::string text) { last_ = std::move(text); };
    if (what < 22) {  // turn, move along
      name("drag");
      jump(0, 0.74f);
      button_ = dice(3), shift_ = dice(3) == 0, control_ = dice(3) == 0, steps_ = 4 + dice(20);
      dx_ = 16 * (share() - 0.5f), dy_ = 16 * (share() - 0.5f);
    } else if (what < 30) {
      name("wheel");
      jump(0, 0.74f);
      wheel_ = share() < 0.5f ? -1.0f : 1.0f, shift_ = dice(5) == 0;
    } else if (what < 38) {
      name("pick");
      jump(0, 0.74f);
      button_ = 0, control_ = dice(2) == 0;
    } else if (what < 62) {  // whatever is there in the panels: buttons, sliders, lists, headings
      name("panel");
      jump(0.75f, 0.99f);
      button_ = 0, control_ = dice(10) == 0, steps_ = 2 + dice(4);
      if (dice(3) == 0) dx_ = 6 * (share() - 0.5f), steps_ = 8;
    } else if (what < 66) {
      name("wheel in the panels");
      jump(0.75f, 0.99f);
      wheel_ = share() < 0.5f ? -2.0f : 2.0f;
    } else if (what < 72) {
      static const char* const words[] = {"3",      "0.5",       "-1",          "z 1..", "class ground",
                                          "splats", "1,0,0",     "opacity=0.3", "dir",   "1e30",
                                          "nope",   "steelblue", "640x480"};
      const std::string word = words[dice(int(std::size(words)))];
      name("type " + word);
      typed_.assign(word.rbegin(), word.rend());
      steps_ = int(word.size()) + 2;
    } else if (what < 75) {
      static const int keys[] = {ImGuiKey_Enter, ImGuiKey_Tab, ImGuiKey_Escape};
      name("key of a field");
      key_ = keys[dice(3)], steps_ = 3;
    } else if (what < 92) {
      // Every key but those that close the window, or fill the disc.
      const auto& keys = view::key_bindings();
      const view::Action action = keys[std::size_t(dice(int(keys.size())))].action;
      name("action " + std::to_string(int(action)));
      const bool writes = action == view::Action::screenshot && ++saved_ > 40;
      if (action != view::Action::quit && action != view::Action::fullscreen && !writes)
        interface_.act(action);
    } else if (what < 94) {
      const std::string file = files_[std::size_t(dice(int(files_.size())))];
      const bool add = dice(2) == 0 && model_.request().files.size() < 2;
      name("open " + file + (add ? " beside" : ""));
      interface_.drop({file}, add);
    } else if (what < 96) {
      name("resize");
      window_.resize(500 + dice(800), 360 + dice(360));
    } else if (what < 98) {
      name("wait");
      steps_ = 30;
    } else {
      name("edit items");
      model_.change("item", [&](view::ViewRequest& next) {
        if (next.items.size() > 2) next.items.clear();
        static const char* const rules[] = {"class ground: soft opacity=0.4", "z 0..: splats", "x ..0: none",
                                            "*: layers", "y 0..: strokes"};
        next.items.push_back(view::DrawRow::from(rules[dice(5)]));
      });
    }
  }

  std::mt19937 random_;
  Window& window_;
  view::ViewModel& model_;
  Interface& interface_;
  std::vector<std::string> files_;
  std::string typed_, last_;
  float x_ = 10, y_ = 10, dx_ = 0, dy_ = 0, wheel_ = 0;
  int button_ = -1, key_ = -1, steps_ = 0, saved_ = 0;
  bool control_ = false, shift_ = false;
  long done_ = 0;
};

int fail(const std::string& what) {
  std::fprintf(stderr, "soak: FAILED: %s\n", what.c_str());
  return 1;
}

int soak(double minutes, unsigned seed, const std::vector<std::string>& files) {
  view::Start start;
  start.request.files = {files.front()};
  start.request.technique = "points";
  const view::ViewRequest plain = start.request;
  Window window(1000, 640, "soak");
  start.wake = [] { Window::wake(); };
  view::ViewModel model(std::move(start));
  Interface interface(window, model);
  Hand hand(seed, window, model, interface, files);
  window.on_input = [&] { hand.move(); };
  long mistakes = 0;
  model.on_message = [&](const view::Message& message) { mistakes += message.is_error; };

  double longest_ms = 0;
  std::string during;
  std::vector<std::string> complaints;
  const auto frame = [&] {
    window.begin_frame(0.004);
    const double before = now_ms();
    model.tick(now_ms());
    interface.draw(now_ms());
    model.tick(now_ms());
    const double took = now_ms() - before;
    window.end_frame(now_ms());
    if (took > longest_ms) longest_ms = took, during = hand.last();
    for (std::string& each : model.take_driver_messages()) complaints.push_back(std::move(each));
  };
  const auto until = [&](double seconds, const std::function<bool()>& done) {
    for (const double end = now_ms() + 1000 * seconds; now_ms() < end && !model.fatal();) {
      frame();
      if (done()) return true;
    }
    return false;
  };

  // Now and then everything is put back and measured: what is held then is held for good.
  std::vector<double> levels;
  std::vector<long> actions;
  const double end_ms = now_ms() + 60'000 * minutes,
               step_ms = std::clamp(60'000 * minutes / 12, 5'000.0, 60'000.0);
  double next_ms = 0;
  while (true) {
    if (model.fatal()) return fail(model.fatal()->message + " (" + hand.last() + ")");
    if (!complaints.empty()) return fail("the driver: " + complaints.front() + " (" + hand.last() + ")");
    if (now_ms() >= next_ms) {
      hand.rest();
      window.resize(1000, 640);
      interface.act(view::Action::clear_picks);
      model.path.clear();
      // By way of another scene, so that the tables of techniques go as well.
      for (const std::string& file : {files.back(), files.front()}) {
        model.change("plain", [&](view::ViewRequest& next) {
          const view::ViewCamera camera = next.camera;
          next = plain;
          next.files = {file};
          next.place(camera);
        });
        const double asked_ms = now_ms();
        if (!until(300, [&] { return now_ms() - asked_ms > 500 && model.settled(); }))
          return fail("no final picture within 300 s after " + hand.last());
      }
      levels.push_back(memory_mb());
      actions.push_back(hand.done());
      std::printf(
          "soak: %.1f min, %ld actions, %.0f MB at rest, %ld messages of mistakes, longest frame %.0f ms "
          "(%s)\n",
          now_ms() / 60'000, hand.done(), levels.back(), mistakes, longest_ms, during.c_str());
      std::fflush(stdout);
      if (now_ms() > end_ms) break;
      hand.go_on();
      next_ms = now_ms() + step_ms;
    }
    frame();
  }
  // The first quarter fills caches: programs of every technique, undo, pools of the allocator and the driver.
  // On a busy machine it takes longer: a hand needs so many actions to come by all of them.
  constexpr long for_all_caches = 2000;
  const auto filled =
      std::size_t(std::lower_bound(actions.begin(), actions.end(), for_all_caches) - actions.begin());
  const std::size_t quarter =
      std::min(std::max({std::size_t(1), levels.size() / 4, filled}), levels.size() - 1);
  const double before = *std::max_element(levels.begin() + 1, levels.begin() + 1 + std::ptrdiff_t(quarter)),
               after = levels.back();
  if (levels.size() > 4 && after > 1.25 * before + 64)
    return fail(fmt::format("memory at rest grew from {:.0f} to {:.0f} MB", before, after));
  std::printf("soak: passed: %ld actions, memory at rest %.0f MB after a quarter, %.0f MB at the end\n",
              hand.done(), before, after);
  return 0;
}

}  // namespace

int main(int count, char** words) {
  double minutes = 10;
  unsigned seed = 1;
  std::filesystem::path scratch =
      std::filesystem::temp_directory_path() / ("sfumato_soak_" + std::to_string(getpid()));
  for (int i = 1; i + 1 < count; i += 2) {
    const std::string option = words[i];
    if (option == "--minutes") minutes = std::atof(words[i + 1]);
    if (option == "--seed") seed = unsigned(std::atol(words[i + 1]));
    if (option == "--scratch") scratch = words[i + 1];
  }
  std::filesystem::create_directories(scratch);
  std::filesystem::current_path(scratch);
  for (const char* scene : {"forest --points 60000 -o a.laz", "courtyard --points 150000 -o b.laz",
                            "tori --points 1100000 -o d.laz", "tori --points 100000 -o c.ply"})
    if (std::system((std::string(SFUMATO_BINARY " synth ") + scene + " --quiet").c_str()) != 0)
      return fail("no scene to look at");
  int code = 1;
  try {
    code = soak(minutes, seed, {"a.laz", "b.laz", "d.laz", "c.ply"});
  } catch (const std::exception& error) {
    code = fail(error.what());
  }
  std::filesystem::current_path(scratch.parent_path());
  std::filesystem::remove_all(scratch);
  return code;
}
