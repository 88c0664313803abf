#include "console.h"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>

namespace sfumato::cli {
namespace {

std::atomic<bool> interrupted = false;
static_assert(std::atomic<bool>::is_always_lock_free, "used in a signal handler");

void on_interrupt(int) {
  if (interrupted.exchange(true)) _exit(130);
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

Console::Console(bool quiet) : quiet_(quiet), live_(!quiet && isatty(STDERR_FILENO)) {}

void Console::update(double fraction, std::string_view text) {
  if (!live_) return;
  const std::lock_guard lock(mutex_);
  const auto now = std::chrono::steady_clock::now();
  if (shown_ && now - last_ < std::chrono::milliseconds(100)) return;
  last_ = now;
  shown_ = true;
  std::fprintf(stderr, "\r\033[K%s%.*s %3.0f %%", stage_.c_str(), int(text.size()), text.data(),
               100 * std::clamp(fraction, 0.0, 1.0));
  std::fflush(stderr);
}

bool Console::cancelled() const {
  return interrupted.load(std::memory_order_relaxed);
}

void Console::set_stage(const std::string& stage) {
  const std::lock_guard lock(mutex_);
  stage_ = stage.empty() ? "" : stage + ": ";
}

void Console::say(const std::string& line) {
  if (quiet_) return;
  clear();
  std::fprintf(stderr, "%s\n", line.c_str());
}

void Console::clear() {
  const std::lock_guard lock(mutex_);
  if (shown_) std::fprintf(stderr, "\r\033[K");
  shown_ = false;
}

void print(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0) return;
  throw Error(ErrorCode::io, std::string("cannot write to standard output: ") + std::strerror(errno));
}

}  // namespace sfumato::cli
