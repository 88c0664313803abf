#include "console.h"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <utility>

#include "core/interruption.h"
#include "session/notes.h"

namespace sfumato::cli {
namespace {

void on_interrupt(int) {
  if (interruption.exchange(true)) _exit(130);
}

}  // namespace

void catch_interrupt() {
  struct sigaction action {};
  action.sa_handler = on_interrupt;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  // Whoever reads us may leave, and files may have a limit: writing then fails like on a full disk.
  signal(SIGPIPE, SIG_IGN);
  signal(SIGXFSZ, SIG_IGN);
}

Console::Console(bool quiet, bool verbose)
    : quiet_(quiet), verbose_(verbose), live_(!quiet && isatty(STDERR_FILENO)) {}

/// What was to be said before the work failed may tell why.
Console::~Console() {
  clear();
  if (!cancelled()) say_notes({});
}

void Console::update(double fraction, std::string_view text) {
  if (!live_) return;
  const std::lock_guard lock(mutex_);
  const auto now = Clock::now();
  if (text != text_) text_ = text, text_began_ = now;
  if (shown_ && now - last_ < std::chrono::milliseconds(100)) return;
  last_ = now;
  shown_ = true;
  fraction = std::clamp(fraction, 0.0, 1.0);
  const auto since = [&](Clock::time_point began) {
    return std::chrono::duration<double>(now - began).count();
  };
  // Of many steps the finished ones tell how long the others take, of one step its own part does.
  const std::string left = steps_ > 1 ? remaining_text(double(step_) / double(steps_), since(steps_began_))
                                      : remaining_text(fraction, since(text_began_));
  const double done = steps_ > 1 ? (double(step_) + fraction) / double(steps_) : fraction;
  std::fprintf(stderr, "\r\033[K%s%.*s %3.0f %%%s", stage_.c_str(), int(text.size()), text.data(), 100 * done,
               left.empty() ? "" : (", " + left + " left").c_str());
  std::fflush(stderr);
}

bool Console::cancelled() const { return interruption.load(std::memory_order_relaxed); }

void Console::set_step(const std::string& what, std::size_t step, std::size_t steps) {
  const std::lock_guard lock(mutex_);
  if (step == 0) steps_began_ = Clock::now();
  step_ = step, steps_ = steps;
  stage_ = steps > 1 ? what + " " + std::to_string(step + 1) + "/" + std::to_string(steps) + ": " : "";
}

void Console::tell(const std::string& line) {
  if (verbose_) say(line);
}

void Console::say(const std::string& line) {
  if (!quiet_) complain(line);
}

void Console::note(const std::string& clause) {
  if (!clause.empty()) notes_.push_back(clause);
}

void Console::say_notes(const std::vector<std::string>& files) {
  const std::string line = joined_notes(std::exchange(notes_, {}), files);
  if (!line.empty() && line != last_notes_) say((files.empty() ? "" : "sfumato: ") + line);
  last_notes_ = line;
}

void Console::complain(const std::string& line) {
  clear();
  std::fprintf(stderr, "%s\n", line.c_str());
}

void Console::clear() {
  const std::lock_guard lock(mutex_);
  if (shown_) std::fprintf(stderr, "\r\033[K");
  shown_ = false;
}

std::string remaining_text(double fraction, double seconds) {
  if (fraction <= 0.01 || seconds < 2) return "";  // too early to tell
  const long left = std::lround(seconds * (1 - fraction) / fraction);
  if (left < 100) return std::to_string(left) + " s";
  const long minutes = (left + 30) / 60;
  if (minutes < 100) return std::to_string(minutes) + " min";
  return std::to_string(minutes / 60) + " h " + (minutes % 60 < 10 ? "0" : "") +
         std::to_string(minutes % 60) + " min";
}

void print(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0) return;
  throw Error(ErrorCode::io, std::string("cannot write to standard output: ") + std::strerror(errno));
}

}  // namespace sfumato::cli
