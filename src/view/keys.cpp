#include "view/keys.h"

#include "techniques/technique.h"

namespace sfumato::view {

const std::vector<KeyBinding>& key_bindings() {
  static const std::vector<KeyBinding> all = [] {
    std::vector<KeyBinding> keys;
    const auto& techniques = all_techniques();
    for (int i = 0; i < 9 && i < int(techniques.size()); ++i)
      keys.push_back({Action(int(Action::technique_1) + i), '1' + i, none, std::string(1, char('1' + i)),
                      "draw with " + techniques[std::size_t(i)].name});
    const std::vector<KeyBinding> others = {
        {Action::reset_view, 'R', none, "R", "back to the first view"},
        {Action::frame_view, 'F', none, "F", "frame everything from this side"},
        {Action::orthographic, 'O', none, "O, keypad 5", "orthographic or perspective view"},
        {Action::orthographic, key::keypad_5, none, "", ""},
        {Action::front, key::keypad_1, none, "keypad 1", "from the front (Ctrl: from the back)"},
        {Action::back, key::keypad_1, control, "", ""},
        {Action::right, key::keypad_3, none, "keypad 3", "from the right (Ctrl: from the left)"},
        {Action::left, key::keypad_3, control, "", ""},
        {Action::top, key::keypad_7, none, "keypad 7", "from the top (Ctrl: from below)"},
        {Action::bottom, key::keypad_7, control, "", ""},
        {Action::iso, 'I', none, "I", "isometric"},
        {Action::larger_points, key::equal, none, "+ / -", "larger or smaller points"},
        {Action::larger_points, key::equal, shift, "", ""},
        {Action::larger_points, key::keypad_add, none, "", ""},
        {Action::smaller_points, key::minus, none, "", ""},
        {Action::smaller_points, key::keypad_subtract, none, "", ""},
        {Action::eye_dome, 'L', none, "L", "eye-dome lighting on or off"},
        {Action::shadows, 'L', shift, "Shift+L", "shadows: off, hard, soft"},
        {Action::legend, 'C', none, "C", "legend of the colours"},
        {Action::clear_picks, key::escape, none, "Esc",
         "clear picked points, close their profile; stop a path"},
        {Action::profile, 'V', none, "V", "vertical profile along the picked points"},
        {Action::screenshot, 'P', none, "P, F9",
         "save the picture under a new number, with the command that makes it"},
        {Action::screenshot, key::f9, none, "", ""},
        {Action::copy_command, 'C', control | shift, "Ctrl+Shift+C",
         "copy the command that makes this picture"},
        {Action::copy_camera, 'C', control, "Ctrl+C", "copy the camera as JSON"},
        {Action::paste_camera, 'V', control, "Ctrl+V", "paste a copied camera"},
        {Action::undo, 'Z', control, "Ctrl+Z", "undo"},
        {Action::redo, 'Z', control | shift, "Ctrl+Shift+Z, Ctrl+Y", "redo"},
        {Action::redo, 'Y', control, "", ""},
        {Action::add_key, 'K', none, "K", "add this view to the camera path"},
        {Action::play, key::space, none, "Space", "play the camera path or the sequence, or stop it"},
        {Action::panels, key::tab, control, "Ctrl+Tab", "panels on or off"},
        {Action::fullscreen, key::f11, none, "F11", "full screen"},
        {Action::larger_interface, key::equal, control, "Ctrl + / Ctrl -", "larger or smaller text"},
        {Action::larger_interface, key::equal, control | shift, "", ""},
        {Action::smaller_interface, key::minus, control, "", ""},
        {Action::theme, 'T', none, "T", "dark or light panels"},
        {Action::help, 'H', none, "H, F1", "this list"},
        {Action::help, key::f1, none, "", ""},
        {Action::quit, 'Q', control, "Ctrl+Q", "close"},
    };
    keys.insert(keys.end(), others.begin(), others.end());
    return keys;
  }();
  return all;
}

std::optional<Action> action_of(int code, int modifiers) {
  for (const KeyBinding& binding : key_bindings())
    if (binding.code == code && binding.modifiers == modifiers) return binding.action;
  return std::nullopt;
}

const std::vector<MouseHelp>& mouse_help() {
  static const std::vector<MouseHelp> all = {
      {"left drag", "turn around the point under the cursor"},
      {"right, middle or Shift+left drag", "pan: the point under the cursor follows"},
      {"Ctrl+Shift+left drag", "move the light, as on a sphere around the scan"},
      {"wheel", "zoom to the point under the cursor, or away"},
      {"Shift+wheel", "angle of view"},
      {"click", "pick a point: coordinates and attributes; a second one measures"},
      {"Ctrl+click", "continue the line of picked points"},
      {"double click", "centre the point"},
      {"W A S D, E Q", "fly forward, left, back, right, up, down; with Shift five times as fast"},
      {"files dropped", "open them; with Ctrl in addition to what is open; .json: a preset or a camera path"},
  };
  return all;
}

std::string key_tables() {
  std::string text = "| mouse and motion | |\n|---|---|\n";
  for (const MouseHelp& row : mouse_help()) text += "| " + row.gesture + " | " + row.what + " |\n";
  text += "\n| key | |\n|---|---|\n";
  for (const KeyBinding& row : key_bindings())
    if (!row.keys.empty()) text += "| " + row.keys + " | " + row.what + " |\n";
  return text;
}

}  // namespace sfumato::view
