// A finished picture in a window of OpenGL 3.3, whose context is current.
#pragma once

#include <string>

#include "core/image.h"

namespace sfumato::gl {

/// Objects of a context that ends with its window: nothing is to be deleted.
class WindowPicture {
 public:
  /// Kept until the next one. Throws Error(out_of_memory).
  void upload(const Image<Rgba8>& image);
  /// Clears the window and copies the picture to `width` x `height` pixels at its top left. Copied, not
  /// drawn: software GL takes several times as long to blend it. `exact`: pixel by pixel.
  void show(int window_width, int window_height, const vec3& ground, int width, int height, bool exact) const;
  /// For who draws it otherwise, pixel by pixel; 0: none.
  unsigned texture() const { return texture_; }

  /// Of the current context.
  static std::string renderer_name();

 private:
  unsigned texture_ = 0, framebuffer_ = 0;
  int width_ = 0, height_ = 0;
};

}  // namespace sfumato::gl
