#include "gl/window_picture.h"

#include <epoxy/gl.h>

#include "core/error.h"

namespace sfumato::gl {

void WindowPicture::upload(const Image<Rgba8>& image) {
  if (!texture_) {
    glGenTextures(1, &texture_);
    glGenFramebuffers(1, &framebuffer_);
  }
  glBindTexture(GL_TEXTURE_2D, texture_);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  if (image.width() != width_ || image.height() != height_) {
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, image.width(), image.height(), 0, GL_RGBA, GL_UNSIGNED_BYTE,
                 image.data());
    width_ = image.width(), height_ = image.height();
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_);
    glFramebufferTexture2D(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture_, 0);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
    if (glGetError() == GL_OUT_OF_MEMORY)
      throw Error(ErrorCode::out_of_memory,
                  "out of graphics memory for the picture in the window; make it smaller, or write "
                  "pictures with -o");
  } else {
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, image.data());
  }
  glBindTexture(GL_TEXTURE_2D, 0);
}

void WindowPicture::show(int window_width, int window_height, const vec3& ground, int width, int height,
                         bool exact) const {
  glViewport(0, 0, window_width, window_height);
  glClearColor(ground.x, ground.y, ground.z, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  if (width_ == 0) return;
  // The texture's first row is the picture's top.
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_);
  glBlitFramebuffer(0, 0, width_, height_, 0, window_height, width, window_height - height,
                    GL_COLOR_BUFFER_BIT, exact ? GL_NEAREST : GL_LINEAR);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
}

std::string WindowPicture::renderer_name() {
  const auto* name = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  return name ? name : "";
}

}  // namespace sfumato::gl
