// Every key of the viewer, once: the window dispatches by this table, its help and the documentation print
// it.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace sfumato::view {

enum class Action {
  technique_1,
  technique_2,
  technique_3,
  technique_4,
  technique_5,
  technique_6,
  technique_7,
  technique_8,
  technique_9,
  reset_view,
  frame_view,
  orthographic,
  front,
  back,
  right,
  left,
  top,
  bottom,
  iso,
  fullscreen,
  panels,
  help,
  quit,
  screenshot,
  copy_command,
  copy_camera,
  paste_camera,
  undo,
  redo,
  larger_points,
  smaller_points,
  eye_dome,
  shadows,
  legend,
  clear_picks,
  profile,
  add_key,
  play,
  larger_interface,
  smaller_interface,
  theme
};

enum Modifier { none = 0, shift = 1, control = 2 };

/// Keys as GLFW numbers them: letters and digits are their ASCII codes.
namespace key {
inline constexpr int escape = 256, tab = 258, space = 32, f1 = 290, f9 = 298, f11 = 300, keypad_0 = 320,
                     keypad_1 = 321, keypad_3 = 323, keypad_5 = 325, keypad_7 = 327, keypad_subtract = 333,
                     keypad_add = 334, minus = 45, equal = 61;
}

struct KeyBinding {
  Action action;
  int code;
  int modifiers;
  std::string keys;  ///< as people read it; empty: another way to the binding before it
  std::string what;
};
const std::vector<KeyBinding>& key_bindings();
/// What a key does; nothing for others.
std::optional<Action> action_of(int code, int modifiers);

struct MouseHelp {
  std::string gesture, what;
};
const std::vector<MouseHelp>& mouse_help();

/// Both as tables in Markdown, for docs/viewer.md.
std::string key_tables();

}  // namespace sfumato::view
