// GPU buffers and the texture views through which shaders read them. Move-only, labelled.
#pragma once

#include <epoxy/gl.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace sfumato::gl {

class Buffer {
 public:
  Buffer() = default;
  /// Allocates `bytes`; `data` may be null. Throws Error(out_of_memory).
  Buffer(const std::string& label, std::size_t bytes, const void* data = nullptr);
  ~Buffer();
  Buffer(Buffer&& other) noexcept
      : id_(std::exchange(other.id_, 0)),
        bytes_(std::exchange(other.bytes_, 0)),
        memory_(std::exchange(other.memory_, nullptr)) {}
  Buffer& operator=(Buffer&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(bytes_, other.bytes_);
    std::swap(memory_, other.memory_);
    return *this;
  }

  GLuint id() const { return id_; }
  std::size_t bytes() const { return bytes_; }
  explicit operator bool() const { return id_ != 0; }
  void upload(const void* data, std::size_t bytes, std::size_t offset = 0);
  void download(void* data, std::size_t bytes, std::size_t offset = 0) const;
  /// Where software GL keeps it, to be read for as long as it lives by who waits for those who write
  /// (GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT); null on a GPU.
  const void* memory() const;
  /// The same, to be written before what reads it is submitted.
  void* memory_to_write() { return const_cast<void*>(memory()); }
  /// Fills with a repeated 32-bit word.
  void clear(std::uint32_t word);
  void bind_storage(int binding) const { glBindBufferBase(GL_SHADER_STORAGE_BUFFER, GLuint(binding), id_); }
  void bind_uniform(int binding) const { glBindBufferBase(GL_UNIFORM_BUFFER, GLuint(binding), id_); }

 private:
  GLuint id_ = 0;
  std::size_t bytes_ = 0;
  mutable const void* memory_ = nullptr;
};

/// A buffer read through texelFetch: 2x faster than a storage buffer on llvmpipe.
class TextureBuffer {
 public:
  TextureBuffer() = default;
  /// `format`: GL_RGB32F, GL_RGBA8, GL_RG16, GL_R32F, GL_R32UI, GL_RGBA32UI ...
  TextureBuffer(const std::string& label, GLenum format, std::size_t bytes, const void* data = nullptr);
  template <class T>
  TextureBuffer(const std::string& label, GLenum format, std::span<const T> values)
      : TextureBuffer(label, format, values.size_bytes(), values.data()) {}
  ~TextureBuffer();
  TextureBuffer(TextureBuffer&& other) noexcept
      : buffer_(std::move(other.buffer_)), texture_(std::exchange(other.texture_, 0)) {}
  TextureBuffer& operator=(TextureBuffer&& other) noexcept {
    std::swap(buffer_, other.buffer_);
    std::swap(texture_, other.texture_);
    return *this;
  }

  explicit operator bool() const { return texture_ != 0; }
  Buffer& buffer() { return buffer_; }
  const Buffer& buffer() const { return buffer_; }
  GLuint texture() const { return texture_; }
  void bind(int unit) const { glBindTextureUnit(GLuint(unit), texture_); }

 private:
  Buffer buffer_;
  GLuint texture_ = 0;
};

/// Replaces a buffer that has less than `bytes` (or none yet); what it held is lost then. The format must not
/// change.
void grow(Buffer& buffer, const std::string& label, std::size_t bytes);
void grow(TextureBuffer& buffer, const std::string& label, GLenum format, std::size_t bytes);

}  // namespace sfumato::gl
