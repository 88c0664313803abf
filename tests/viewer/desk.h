// A display without a screen (Xvfb), the window of the command on it, and a hand (xdotool).
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "cli/command.h"

namespace sfumato::testing {

class DeskTest : public CommandTest {
 protected:
  static constexpr int screen_width = 1280, screen_height = 720;
  static constexpr int view_width = 950, view_height = 694;  ///< of the picture in it

  void SetUp() override;
  void TearDown() override;

  /// Opens the window of `sfumato words... --verbose` and returns at once.
  void open(const std::vector<std::string>& words);
  /// Waits until stderr holds `text` for the n-th time (from 1); throws when it does not come.
  void wait_for(const std::string& text, int n = 1, double seconds = 60);
  int count(const std::string& text) const;
  std::string said() const;
  /// "mousemove 10 20 click 1", as xdotool takes it.
  void hand(const std::string& words);
  /// Presses P and gives the name of the picture that was saved.
  std::string save();
  /// What another program would paste.
  std::string clipboard();
  /// The pixels on the screen.
  Image<Rgba8> screen() const;
  /// Waits for the window's own end.
  int exit_code(double seconds = 30);
  /// The command in a saved picture, drawn anew without a window: its name.
  std::string drawn_again(const std::string& command, const std::string& name);

 private:
  std::string folder_of_screen_;
  pid_t screen_ = -1, window_ = -1;
};

}  // namespace sfumato::testing
