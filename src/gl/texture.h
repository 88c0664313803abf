// A 2D texture (also used as an image for atomics), move-only and labelled.
#pragma once

#include <epoxy/gl.h>

#include <string>
#include <utility>
#include <variant>

#include "core/image.h"

namespace sfumato::gl {

class Texture {
 public:
  Texture() = default;
  /// Immutable storage; software GL has it once GL needs it. More than one level only where the size halves
  /// exactly (GL rounds down); a pyramid of any size is a list of textures. Filters nearest, clamps to the
  /// edge. Throws Error(out_of_memory) or Error(usage) beyond the driver's size.
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

  /// For GL to read or write.
  GLuint id() const {
    hand_over(), is_here_ = false;
    return id_;
  }
  explicit operator bool() const { return width_ > 0; }
  int width() const { return width_; }
  int height() const { return height_; }
  GLenum format() const { return format_; }
  /// To be read.
  void bind(int unit) const {
    hand_over();
    glBindTextureUnit(GLuint(unit), id_);
  }
  void bind_image(int unit, GLenum access) const {
    glBindImageTexture(GLuint(unit), id(), 0, GL_FALSE, 0, access, format_);
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

  // Where OpenGL is software, a picture goes from loop to loop of the processor (passes/*_cpu.h) in memory:
  // GL gets it when a pass asks for the texture, if one does. T is one type for one texture.

  /// What it holds, until GL may write to it or it is taken or given.
  template <class T>
  const Image<T>& peek() const;
  /// The same, to be changed and given back: until then it holds nothing.
  template <class T>
  Image<T> take();
  /// Memory of its size to be filled and given; what it holds is lost.
  template <class T>
  Image<T> blank();
  /// From here on it holds that.
  template <class T>
  void give(Image<T>&& image);
  /// What it holds is lost, and GL need not have it.
  void forget() { is_here_ = false, is_in_gl_ = true; }

 private:
  void swap(Texture& other) {
    std::swap(id_, other.id_);
    std::swap(label_, other.label_);
    std::swap(width_, other.width_);
    std::swap(height_, other.height_);
    std::swap(levels_, other.levels_);
    std::swap(format_, other.format_);
    std::swap(here_, other.here_);
    std::swap(is_here_, other.is_here_);
    std::swap(is_in_gl_, other.is_in_gl_);
  }
  template <class T>
  bool is_here() const {
    return is_here_ && std::holds_alternative<Image<T>>(here_);
  }
  /// Gives GL what it lacks.
  void hand_over() const {
    if (id_ == 0) make();
    if (!is_in_gl_) send();
  }
  void make() const;
  void send() const;
  template <class T>
  void fetch(Image<T>& image) const;
  mutable GLuint id_ = 0;  ///< 0: not made yet
  std::string label_;
  int width_ = 0, height_ = 0, levels_ = 1;
  GLenum format_ = 0;
  /// Kept where it is no more, as memory for the next.
  mutable std::variant<std::monostate, Image<float>, Image<vec2>, Image<vec3>, Image<vec4>,
                       Image<std::uint32_t>, Image<std::uint8_t>, Image<Rgba8>>
      here_;
  mutable bool is_here_ = false, is_in_gl_ = true;  ///< where its content is; both: alike
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
