// The window: GLFW, Dear ImGui, and what src/view knows.
#pragma once

#include <functional>
#include <string>

#include "view/view_model.h"

namespace sfumato::viewer {

struct Settings {
  int width = 1280, height = 720;  ///< of the window
  bool verbose = false;            ///< a line on stderr for every message, final picture and motion
  std::function<bool()> cancelled = [] { return false; };  ///< closes the window
};

/// Opens a window and stays until it is closed. Returns the exit code. Throws Error(no_gl) without a display
/// or OpenGL, and what the first files or the driver complain of.
int run(view::Start start, const Settings& settings);

}  // namespace sfumato::viewer
