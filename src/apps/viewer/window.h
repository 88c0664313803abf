// A GLFW window with an OpenGL 3.3 context, Dear ImGui in it, and a texture that holds the picture.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/image.h"
#include "gl/window_picture.h"

struct GLFWwindow;

namespace sfumato::viewer {

class Window {
 public:
  /// Throws Error(no_gl) with one line that names -o.
  Window(int width, int height, const std::string& title);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  bool closing() const;
  void close();
  /// Waits for input, for `wake` or for so long, then starts a frame of the interface.
  void begin_frame(double wait_s);
  /// Ends the frame; shows it unless the last one was shown so short ago that software GL would have no time
  /// for pictures. `in_motion`: without a new picture there is little to see.
  void end_frame(double now_ms, bool in_motion = false);
  /// Milliseconds until a frame that was not shown is due; nothing when all is shown.
  std::optional<double> owed_ms(double now_ms) const;
  /// From any thread.
  static void wake();

  bool is_down(int key) const;
  void set_title(const std::string& title);
  void toggle_fullscreen();
  void resize(int width, int height);
  bool is_dark() const { return dark_; }
  void set_dark(bool dark) { dark_ = dark, restyle_ = true; }
  /// Of letters and everything, against one pixel a point of the layout.
  float scale() const { return scale_; }
  void zoom_interface(float factor);
  void copy(const std::string& text);
  std::string pasted() const;

  /// The picture, kept until the next one. `exact`: shown pixel by pixel.
  void upload(const Image<Rgba8>& image, bool exact);
  /// Where it lies, in pixels of the framebuffer from the top left corner: below all of the interface.
  void place_picture(int width, int height) { picture_size_[0] = width, picture_size_[1] = height; }

  /// Another picture, for the interface to show.
  void upload_plot(const Image<Rgba8>& image) { plot_.upload(image); }
  void* plot() const;

  /// Called when the input of a frame is known and nothing has looked at it: a test puts another hand in its
  /// place.
  std::function<void()> on_input;
  std::function<void(int key, int modifiers)> on_key;
  std::function<void(const std::vector<std::string>& files, bool add)> on_drop;

 private:
  void style();
  void hold_short_keys();
  struct Callbacks;
  GLFWwindow* window_ = nullptr;
  /// Between two frames on software GL: they cost it as much as a picture in motion.
  static constexpr double software_pause_ms = 40, pause_in_motion_ms = 100;
  bool is_software_ = false, owes_frame_ = false, is_new_ = false;
  double pause_ms_ = software_pause_ms;
  double shown_ms_ = -1e9;
  bool dark_ = true, restyle_ = true, is_full_ = false, has_interface_ = false;
  float scale_ = 1, user_scale_ = 1;
  std::vector<int> pressed_, short_keys_;  ///< since the last frame: went down; of those, went up again
  std::vector<int> held_;  ///< shown to the interface as down in this frame, though they are up
  gl::WindowPicture picture_, plot_;
  bool is_exact_ = false;
  int picture_size_[2] = {0, 0};
  int place_[4] = {0, 0, 1280, 720};
};

}  // namespace sfumato::viewer
