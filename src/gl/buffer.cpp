#include "gl/buffer.h"

#include <algorithm>
#include <mutex>

#include "gl/context.h"

namespace sfumato::gl {
namespace {

constexpr GLbitfield software_map = GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;

}  // namespace

Buffer::Buffer(const std::string& label, std::size_t bytes, const void* data) : bytes_(bytes) {
  for (int i = 0; i < 100 && glGetError() != GL_NO_ERROR; ++i) {  // a lost context has no end of them
  }
  glCreateBuffers(1, &id_);
  // Zero-sized storage is an error in GL; an empty cloud is not one in sfumato. GL reads as much as it
  // stores, so less than the least size comes afterwards.
  constexpr std::size_t least = 16;
  // On software GL the processor may fill a buffer where it lies, and read it there while passes do.
  const GLbitfield map = GL_MAP_READ_BIT | (limits().software ? software_map : 0u);
  glNamedBufferStorage(id_, GLsizeiptr(std::max(bytes, least)), bytes < least ? nullptr : data,
                       GL_DYNAMIC_STORAGE_BIT | map);
  if (bytes < least && data) upload(data, bytes);
  check_memory(label);
  glObjectLabel(GL_BUFFER, id_, GLsizei(label.size()), label.data());
}

Buffer::~Buffer() {
  if (id_) glDeleteBuffers(1, &id_);
}

void Buffer::upload(const void* data, std::size_t bytes, std::size_t offset) {
  if (bytes) glNamedBufferSubData(id_, GLintptr(offset), GLsizeiptr(bytes), data);
}

void Buffer::download(void* data, std::size_t bytes, std::size_t offset) const {
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  if (bytes) glGetNamedBufferSubData(id_, GLintptr(offset), GLsizeiptr(bytes), data);
}

const void* Buffer::memory() const {
  static std::mutex mutex;  // contexts share buffers, and a buffer is mapped once
  const std::lock_guard lock(mutex);
  if (!memory_ && limits().software)
    memory_ = glMapNamedBufferRange(id_, 0, GLsizeiptr(std::max<std::size_t>(bytes_, 1)),
                                    GL_MAP_READ_BIT | software_map);
  return memory_;
}

void Buffer::clear(std::uint32_t word) {
  glClearNamedBufferData(id_, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &word);
}

TextureBuffer::TextureBuffer(const std::string& label, GLenum format, std::size_t bytes, const void* data)
    : buffer_(label, bytes, data) {
  glCreateTextures(GL_TEXTURE_BUFFER, 1, &texture_);
  glTextureBuffer(texture_, format, buffer_.id());
  glObjectLabel(GL_TEXTURE, texture_, GLsizei(label.size()), label.data());
}

TextureBuffer::~TextureBuffer() {
  if (texture_) glDeleteTextures(1, &texture_);
}

void grow(Buffer& buffer, const std::string& label, std::size_t bytes) {
  if (!buffer || buffer.bytes() < bytes) buffer = Buffer(label, bytes);
}

void grow(TextureBuffer& buffer, const std::string& label, GLenum format, std::size_t bytes) {
  if (!buffer || buffer.buffer().bytes() < bytes) buffer = TextureBuffer(label, format, bytes);
}

}  // namespace sfumato::gl
