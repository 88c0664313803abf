// A 2D texture (also used as an image for atomics), move-only and labelled.
#pragma once

#include <epoxy/gl.h>

#include <string>
#include <utility>

#include "core/image.h"

namespace sfumato::gl {

class Texture {
 public:
  Texture() = default;
  /// Immutable storage. More than one level only where the size halves exactly (GL rounds down); a pyramid of
  /// any size is a list of textures. Filters nearest, clamps to the edge. Throws Error(out_of_memory) or
  /// Error(usage) beyond the driver's size.
  Texture(const std::string& label, GLenum format, int width, int height, int levels = 1);
  /// One level of `mipmap` as a texture of its own, so that a pass may write one level while it reads
  /// another; or several from that one on.
  static Texture view(const Texture& mipmap, int level, int levels = 1);
  ~Texture();
  Texture(Texture&& other) noexcept { swap(other); }
  Texture& operator=(Texture&& other) noexcept {
    swap(other);
    return *this;
  }

  GLuint id() const { return id_; }
  explicit operator bool() const { return id_ != 0; }
  int width() const { return width_; }
  int height() const { return height_; }
  GLenum format() const { return format_; }
  void bind(int unit) const { glBindTextureUnit(GLuint(unit), id_); }
  void bind_image(int unit, GLenum access) const {
    glBindImageTexture(GLuint(unit), id_, 0, GL_FALSE, 0, access, format_);
  }
  /// Linear within and between levels.
  void set_trilinear_filter();
  /// Every texel to this value; floats for float and normalised formats, integers for integer formats.
  void clear(const vec4& value);
  void clear_uint(std::uint32_t value);
  /// Whole image, top row first. T decides the transfer format: float, vec2, vec3, vec4, uint32, Rgba8; for
  /// uploads also uint8.
  template <class T>
  Image<T> download() const {
    Image<T> image;
    download(image);
    return image;
  }
  /// Into one that is kept: its pages are there where the size is the same.
  template <class T>
  void download(Image<T>& image) const;
  template <class T>
  void upload(const Image<T>& image) {
    upload_rows(image, 0, height_);
  }
  /// The first rows of `image`, as wide, to those from `first` on.
  template <class T>
  void upload_rows(const Image<T>& image, int first, int rows);

 private:
  void swap(Texture& other) {
    std::swap(id_, other.id_);
    std::swap(width_, other.width_);
    std::swap(height_, other.height_);
    std::swap(format_, other.format_);
  }
  GLuint id_ = 0;
  int width_ = 0, height_ = 0;
  GLenum format_ = 0;
};

/// Makes `texture` of that format and size unless it already is; contents are undefined afterwards.
void ensure(Texture& texture, const std::string& label, GLenum format, int width, int height);

/// A framebuffer over existing textures, for raster passes. Cheap; made for each use.
class Framebuffer {
 public:
  /// Colour attachments in order; `depth` may be null.
  Framebuffer(std::initializer_list<const Texture*> colors, const Texture* depth = nullptr);
  ~Framebuffer() { glDeleteFramebuffers(1, &id_); }
  Framebuffer(const Framebuffer&) = delete;
  Framebuffer& operator=(const Framebuffer&) = delete;
  /// Binds for drawing and sets the viewport to the whole.
  void bind() const;
  GLuint id() const { return id_; }

 private:
  GLuint id_ = 0;
  int width_ = 0, height_ = 0;
};

}  // namespace sfumato::gl
