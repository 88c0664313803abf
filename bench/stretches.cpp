// How long a picture keeps those waiting who cancel it: the longest stretch between two questions to
// Progress, while the file is opened (opening_ms and opening_busy_ms, on a line of their own) and on the
// whole cloud at 1280x720 as the command draws it; one line of JSON for each technique:
//   first_ms    of the first picture, which compiles shaders and computes what the technique derives
//   longest_ms  of each of the pictures after it, the camera turning by a degree: the median, and the least
//               and most of them
//   busy_ms     the same in processor time of all threads, for machines that do something else besides
//   frame_ms    the whole call, the median
//   stretches   questions, the median
//   cpu_ms      processor time of the process for a picture, the median
//
// usage: stretches FILE [TECHNIQUE,...] [PICTURES] [WIDTH HEIGHT]
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <mutex>
#include <sstream>

#include "core/order.h"
#include "processor_time.h"
#include "sfumato/renderer.h"

namespace {

using namespace sfumato;
using bench::cpu_ms;
using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point then) {
  return std::chrono::duration<double, std::milli>(Clock::now() - then).count();
}

/// Notes when it was asked last, by whichever thread.
class Stopwatch final : public Progress {
 public:
  void update(double, std::string_view) override {}
  bool cancelled() const override {
    const std::lock_guard lock(mutex_);
    longest_ = std::max(longest_, ms_since(last_));
    busiest_ = std::max(busiest_, cpu_ms() - last_cpu_);
    last_ = Clock::now(), last_cpu_ = cpu_ms();
    ++asked_;
    return false;
  }
  void start() { last_ = Clock::now(), last_cpu_ = cpu_ms(), longest_ = busiest_ = 0, asked_ = 0; }
  double longest() const { return longest_; }
  double busiest() const { return busiest_; }
  int asked() const { return asked_; }

 private:
  mutable std::mutex mutex_;
  mutable Clock::time_point last_;
  mutable double last_cpu_ = 0, longest_ = 0, busiest_ = 0;
  mutable int asked_ = 0;
};

void measure(HeadlessRenderer& renderer, const std::string& technique, int pictures, int width, int height) {
  const Camera first = renderer.first_view(width, height);
  Stopwatch watch;
  std::vector<double> longest, busiest, frames, asked, cpu;
  double first_ms = 0;
  for (int k = 0; k <= pictures; ++k) {
    Camera camera = first;
    const double angle = glm::radians(double(k));
    const dvec3 away = first.position - first.target, up = glm::normalize(first.up);
    camera.position = first.target + std::cos(angle) * away + std::sin(angle) * glm::cross(up, away) +
                      (1 - std::cos(angle)) * glm::dot(up, away) * up;
    const double cpu_before = cpu_ms();
    const Clock::time_point start = Clock::now();
    watch.start();
    renderer.render(technique, camera, {}, vec3(1), watch);
    const double frame_ms = ms_since(start);
    watch.cancelled();  // what came after the last question
    if (k == 0) {
      first_ms = watch.longest();
      continue;
    }
    longest.push_back(watch.longest());
    busiest.push_back(watch.busiest());
    frames.push_back(frame_ms);
    asked.push_back(watch.asked());
    cpu.push_back(cpu_ms() - cpu_before);
  }
  const double usual = median(longest);  // moves them
  fmt::print(
      "{{\"technique\": \"{}\", \"first_ms\": {:.1f}, \"longest_ms\": [{:.1f}, {:.1f}, {:.1f}], "
      "\"busy_ms\": {:.1f}, \"frame_ms\": {:.1f}, \"stretches\": {}, \"cpu_ms\": {:.1f}}}\n",
      technique, first_ms, usual, *std::min_element(longest.begin(), longest.end()),
      *std::max_element(longest.begin(), longest.end()), median(busiest), median(frames), median(asked),
      median(cpu));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "usage: stretches FILE [TECHNIQUE,...] [PICTURES] [WIDTH HEIGHT]\n");
    return 2;
  }
  const int pictures = argc > 3 ? std::max(1, std::atoi(argv[3])) : 9;
  const int width = argc > 5 ? std::atoi(argv[4]) : 1280, height = argc > 5 ? std::atoi(argv[5]) : 720;
  try {
    HeadlessRenderer renderer;
    Stopwatch watch;
    watch.start();
    renderer.open({.files = {argv[1]}}, watch);
    watch.cancelled();
    fmt::print("{{\"opening_ms\": {:.1f}, \"opening_busy_ms\": {:.1f}}}\n", watch.longest(), watch.busiest());
    renderer.set_outputs({.color = true, .linear = false, .depth = false, .normal = false});
    std::istringstream names(argc > 2 ? argv[2] : "");
    for (std::string name; std::getline(names, name, ',');) measure(renderer, name, pictures, width, height);
  } catch (const std::exception& error) {
    fmt::print(stderr, "stretches: {}\n", error.what());
    return 1;
  }
}
