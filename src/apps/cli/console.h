// What the user sees while the command works: progress on a terminal, lines on stderr, Ctrl-C.
#pragma once

#include <chrono>
#include <mutex>
#include <string>
#include <vector>

#include "common_options.h"
#include "core/progress.h"

namespace sfumato::cli {

/// From now on Ctrl-C sets a flag that `Console::cancelled` sees; a second one ends the program at once.
void catch_interrupt();

class Console final : public Progress {
 public:
  /// Shows progress only when stderr is a terminal and the user did not ask for quiet.
  explicit Console(bool quiet = false, bool verbose = false);
  explicit Console(const CommonOptions& common) : Console(common.quiet, common.verbose) {}
  ~Console() override;

  void update(double fraction, std::string_view text) override;
  bool cancelled() const override;
  /// Step `step` of `steps`, counted from 0, called `what` ("frame"): stands before the text of every update
  /// and tells how long the others will take.
  void set_step(const std::string& what, std::size_t step, std::size_t steps);
  /// A line on stderr unless quiet.
  void say(const std::string& line);
  /// A clause of the next line of notes, unless quiet.
  void note(const std::string& clause);
  /// Says the clauses since the last time in one line (session/notes.h), unless that is the same line again.
  void say_notes(const std::vector<std::string>& files);
  /// The same for errors, which --quiet does not silence.
  void complain(const std::string& line);
  /// A line on stderr with --verbose.
  void tell(const std::string& line);

 private:
  void clear();

  using Clock = std::chrono::steady_clock;

  const bool quiet_, verbose_, live_;
  std::mutex mutex_;
  std::string stage_, text_, last_notes_;
  std::vector<std::string> notes_;
  std::size_t step_ = 0, steps_ = 1;
  bool shown_ = false;
  Clock::time_point last_{}, text_began_ = Clock::now(), steps_began_ = text_began_;
};

/// What is left of work of which `fraction` took `seconds`: "12 s", "3 min", "2 h 05 min"; empty while nobody
/// knows.
std::string remaining_text(double fraction, double seconds);
/// Writes to stdout and makes sure that it arrived; Error(io) otherwise.
void print(const std::string& text);

}  // namespace sfumato::cli
