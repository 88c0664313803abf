// How the window moves: a hand drags in it for some seconds, then lets go. On a display (xvfb-run); one line
// of JSON:
//   first_ms     from the start of the process to the first picture
//   whole_ms     to the first whole picture
//   motion_ms    between two pictures in motion, the mean
//   latency_ms   from moving the mouse to the picture of that view, the median
//   converge_ms  from letting go to the whole picture
//   cpu_ms       processor time of the process for a picture in motion, the window's own share included
//   drawn_by     the technique of the last picture in motion, its size in pixels
//
// usage: viewer_motion FILE TECHNIQUE [SECONDS [WIDTH HEIGHT]], of the window: 1280 720
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <functional>

#include "apps/viewer/interface.h"
#include "apps/viewer/window.h"
#include "core/error.h"
#include "processor_time.h"

namespace {

using namespace sfumato;
using bench::cpu_ms;
using Clock = std::chrono::steady_clock;
const Clock::time_point began = Clock::now();

double now_ms() { return std::chrono::duration<double, std::milli>(Clock::now() - began).count(); }

struct Motion {
  int pictures = 0;
  double ms = 0, cpu = 0, latency_ms = 0;
  std::string drawn_by;
};

class Desk {
 public:
  Desk(const std::string& file, const std::string& technique, int width, int height)
      : window_(width, height, "motion"), model_(start(file, technique)), interface_(window_, model_) {
    window_.on_input = [this] {
      ImGuiIO& io = ImGui::GetIO();
      io.MousePos = mouse_;
      io.MouseDown[0] = is_down_;
    };
  }

  /// Until `done`; what a person would see as the end of it. Throws when it does not come.
  double wait(const std::function<bool()>& done) {
    const double from = now_ms();
    while (!done()) {
      frame();
      if (now_ms() - from > 120'000) throw Error(ErrorCode::usage, "no whole picture within two minutes");
    }
    return now_ms() - from;
  }
  Motion drag(double seconds) {
    Motion motion;
    std::vector<double> latencies;
    std::deque<std::pair<double, dvec3>> asked;  // when the hand brought the camera where
    std::shared_ptr<const view::Picture> last = model_.picture();
    mouse_ = {475, 350};
    frame();
    is_down_ = true;
    frame();
    const double from = now_ms(), cpu = cpu_ms();
    double first = from;
    for (int k = 0; now_ms() - from < 1000 * seconds; ++k) {
      mouse_.x += k % 200 < 100 ? 3 : -3, mouse_.y += float(k % 5 - 2);
      frame();
      asked.emplace_back(now_ms(), model_.request().camera.position);
      if (asked.size() > 1000) asked.pop_front();
      if (model_.picture() == last) continue;
      last = model_.picture();
      if (++motion.pictures == 1) first = now_ms();
      for (const auto& [when, position] : asked)
        if (position == last->camera.position) {
          latencies.push_back(now_ms() - when);
          break;
        }
    }
    motion.ms = motion.pictures > 1 ? (now_ms() - first) / (motion.pictures - 1) : 1000 * seconds;
    motion.cpu = (cpu_ms() - cpu) / std::max(1, motion.pictures);
    std::sort(latencies.begin(), latencies.end());
    motion.latency_ms = latencies.empty() ? 0 : latencies[latencies.size() / 2];
    motion.drawn_by = fmt::format("{} {}x{}", last->technique, last->image.width(), last->image.height());
    is_down_ = false;
    return motion;
  }
  bool has_picture() const { return model_.picture() != nullptr; }
  bool settled() const { return model_.settled(); }

 private:
  view::Start start(const std::string& file, const std::string& technique) {
    view::Start start;
    start.request.files = {file};
    start.request.technique = technique;
    start.wake = [] { viewer::Window::wake(); };
    return start;
  }
  /// As the window's own loop, with a mouse that reports 125 times a second.
  void frame() {
    window_.begin_frame(0.008);
    model_.tick(now_ms());
    interface_.draw(now_ms());
    model_.tick(now_ms());
    window_.end_frame(now_ms(), model_.moving());
    if (model_.fatal()) throw Error(model_.fatal()->code, model_.fatal()->message);
  }

  viewer::Window window_;
  view::ViewModel model_;
  viewer::Interface interface_;
  ImVec2 mouse_{475, 350};
  bool is_down_ = false;
};

}  // namespace

int main(int count, char** words) {
  if (count < 3)
    return std::fprintf(stderr, "usage: viewer_motion FILE TECHNIQUE [SECONDS [WIDTH HEIGHT]]\n"), 1;
  try {
    const bool has_size = count > 5;
    Desk desk(words[1], words[2], has_size ? std::atoi(words[4]) : 1280,
              has_size ? std::atoi(words[5]) : 720);
    desk.wait([&] { return desk.has_picture(); });
    const double first_ms = now_ms();
    desk.wait([&] { return desk.settled(); });
    const double whole_ms = now_ms();
    desk.drag(3);  // compiles, and finds the rung
    desk.wait([&] { return desk.settled(); });
    const Motion motion = desk.drag(count > 3 ? std::atof(words[3]) : 4);
    const double converge_ms = desk.wait([&] { return desk.settled(); });
    std::printf(
        "{\"first_ms\": %.0f, \"whole_ms\": %.0f, \"motion_ms\": %.1f, \"latency_ms\": %.0f, "
        "\"converge_ms\": %.0f, "
        "\"cpu_ms\": %.1f, \"drawn_by\": \"%s\"}\n",
        first_ms, whole_ms, motion.ms, motion.latency_ms, converge_ms, motion.cpu, motion.drawn_by.c_str());
    return 0;
  } catch (const std::exception& error) {
    return std::fprintf(stderr, "viewer_motion: %s\n", error.what()), 1;
  }
}
