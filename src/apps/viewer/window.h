// A GLFW window with an OpenGL 3.3 context, Dear ImGui in it, and a texture that holds the picture.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/image.h"

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
  void end_frame();
  /// From any thread.
  static void wake();

  bool is_down(int key) const;
  void set_title(const std::string& title);
  void toggle_fullscreen();
  bool is_dark() const { return dark_; }
  void set_dark(bool dark) { dark_ = dark, restyle_ = true; }
  /// Of letters and everything, against one pixel a point of the layout.
  float scale() const { return scale_; }
  void zoom_interface(float factor);
  void copy(const std::string& text);
  std::string pasted() const;

  /// The picture, kept until the next one. `exact`: shown pixel by pixel.
  void upload(const Image<Rgba8>& image, bool exact);
  void* texture() const;

  std::function<void(int key, int modifiers)> on_key;
  std::function<void(const std::vector<std::string>& files, bool add)> on_drop;

 private:
  void style();
  struct Callbacks;
  GLFWwindow* window_ = nullptr;
  bool dark_ = true, restyle_ = true, is_full_ = false, has_interface_ = false;
  float scale_ = 1, user_scale_ = 1;
  unsigned texture_ = 0;
  int texture_width_ = 0, texture_height_ = 0;
  int place_[4] = {0, 0, 1280, 720};
};

}  // namespace sfumato::viewer
