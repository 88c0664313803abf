// What the user sees while the command works: progress on a terminal, lines on stderr, Ctrl-C.
#pragma once

#include <chrono>
#include <mutex>
#include <string>

#include "core/progress.h"

namespace sfumato::cli {

/// From now on Ctrl-C sets a flag that `Console::cancelled` sees; a second one ends the program at once.
void catch_interrupt();

class Console final : public Progress {
 public:
  /// Shows progress only when stderr is a terminal and the user did not ask for quiet.
  explicit Console(bool quiet = false);
  ~Console() override { clear(); }

  void update(double fraction, std::string_view text) override;
  bool cancelled() const override;
  /// Stands before the text of every update: "frame 3/90".
  void set_stage(const std::string& stage);
  /// A line on stderr unless quiet.
  void say(const std::string& line);
  bool quiet() const { return quiet_; }

 private:
  void clear();

  const bool quiet_, live_;
  std::mutex mutex_;
  std::string stage_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point last_{};
};

/// Writes to stdout and makes sure that it arrived; Error(io) otherwise.
void print(const std::string& text);

}  // namespace sfumato::cli
