// What passes and techniques tell OpenGL besides drawing (gl/draw.h): nobody outside this folder names a
// function of it.
#pragma once

#include <span>

#include "gl/buffer.h"
#include "gl/texture.h"

namespace sfumato::gl {

/// What shaders wrote is there for these uses of it, GL_..._BARRIER_BIT.
inline void barrier(GLbitfield uses) { glMemoryBarrier(uses); }
/// Waits until all that was told is done.
inline void finish() { glFinish(); }

/// A texture as one of another format, whose texels have as many bits: the bits of floats as integers.
/// Drivers may write nothing where shaders declare another format than the one that is bound.
inline void bind_image(int unit, const Texture& texture, GLenum access, GLenum format) {
  glBindImageTexture(GLuint(unit), texture.id(), 0, GL_FALSE, 0, access, format);
}
inline void bind_image(int unit, const TextureBuffer& buffer, GLenum access, GLenum format) {
  glBindImageTexture(GLuint(unit), buffer.texture(), 0, GL_FALSE, 0, access, format);
}

/// A rectangle of textures of one format.
inline void copy(const Texture& from, const ivec2& corner, const Texture& to, const ivec2& to_corner,
                 const ivec2& size) {
  glCopyImageSubData(from.id(), GL_TEXTURE_2D, 0, corner.x, corner.y, 0, to.id(), GL_TEXTURE_2D, 0,
                     to_corner.x, to_corner.y, 0, size.x, size.y, 1);
}
/// Of the beginning of a buffer.
inline void copy(const Buffer& from, const Buffer& to, std::size_t bytes) {
  glCopyNamedBufferSubData(from.id(), to.id(), 0, 0, GLsizeiptr(bytes));
}
inline void make_mipmap(const Texture& texture) { glGenerateTextureMipmap(texture.id()); }

/// To the far plane.
inline void clear_depth(const Framebuffer& framebuffer) {
  const float farthest = 1;
  glClearNamedFramebufferfv(framebuffer.id(), GL_DEPTH, 0, &farthest);
}
/// Of the framebuffer that is bound.
inline void clear_color(int attachment, const vec4& value) {
  glClearBufferfv(GL_COLOR, attachment, &value.x);
}
inline void set_viewport(const ivec2& corner, const ivec2& size) {
  glViewport(corner.x, corner.y, size.x, size.y);
}

/// All vertices of a pass over the screen.
inline void draw_screen() { glDrawArrays(GL_TRIANGLES, 0, 3); }
inline void draw_ranges(GLenum mode, std::span<const GLint> first, std::span<const GLsizei> count) {
  glMultiDrawArrays(mode, first.data(), count.data(), GLsizei(first.size()));
}
/// As the command in a buffer says.
inline void draw_indirect(GLenum mode, const Buffer& command) {
  glBindBuffer(GL_DRAW_INDIRECT_BUFFER, command.id());
  glDrawArraysIndirect(mode, nullptr);
}
inline void bind_elements(const Buffer& elements) { glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, elements.id()); }

/// A buffer in the memory of the program, to be read and written while this lives; null where the driver
/// cannot.
class Mapped {
 public:
  explicit Mapped(const Buffer& buffer)
      : id_(buffer.id()),
        data_(glMapNamedBufferRange(id_, 0, GLsizeiptr(buffer.bytes()), GL_MAP_WRITE_BIT | GL_MAP_READ_BIT)) {
  }
  ~Mapped() {
    if (data_) glUnmapNamedBuffer(id_);
  }
  Mapped(const Mapped&) = delete;
  Mapped& operator=(const Mapped&) = delete;
  void* data() const { return data_; }

 private:
  GLuint id_;
  void* data_;
};

}  // namespace sfumato::gl
