#include "gl/texture.h"

#include <algorithm>
#include <cassert>
#include <type_traits>

#include "core/error.h"
#include "gl/context.h"

namespace sfumato::gl {

Texture::Texture(const std::string& label, GLenum format, int width, int height, int levels)
    : label_(label), width_(width), height_(height), levels_(levels), format_(format) {
  const int limit = limits().max_texture_size;
  if (width > limit || height > limit)
    throw Error(ErrorCode::usage, "an image of " + std::to_string(width) + "x" + std::to_string(height) +
                                      " is larger than this driver's limit of " + std::to_string(limit) +
                                      " pixels a side; use a smaller --resolution");
  if (!limits().software) make();
}

void Texture::make() const {
  for (int i = 0; i < 100 && glGetError() != GL_NO_ERROR; ++i) {  // a lost context has no end of them
  }
  glCreateTextures(GL_TEXTURE_2D, 1, &id_);
  glTextureStorage2D(id_, levels_, format_, width_, height_);
  check_memory(label_);
  glTextureParameteri(id_, GL_TEXTURE_MIN_FILTER, levels_ > 1 ? GL_NEAREST_MIPMAP_NEAREST : GL_NEAREST);
  glTextureParameteri(id_, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glTextureParameteri(id_, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTextureParameteri(id_, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glObjectLabel(GL_TEXTURE, id_, GLsizei(label_.size()), label_.data());
}

Texture Texture::view(const Texture& mipmap, int level, int levels) {
  Texture texture;
  texture.width_ = std::max(1, mipmap.width_ >> level);
  texture.height_ = std::max(1, mipmap.height_ >> level);
  texture.format_ = mipmap.format_;
  glGenTextures(1, &texture.id_);
  glTextureView(texture.id_, GL_TEXTURE_2D, mipmap.id(), mipmap.format_, GLuint(level), GLuint(levels), 0, 1);
  glTextureParameteri(texture.id_, GL_TEXTURE_MIN_FILTER,
                      levels > 1 ? GL_NEAREST_MIPMAP_NEAREST : GL_NEAREST);
  glTextureParameteri(texture.id_, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  return texture;
}

Texture::~Texture() {
  if (id_) glDeleteTextures(1, &id_);
}

void Texture::set_trilinear_filter() {
  hand_over();
  glTextureParameteri(id_, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTextureParameteri(id_, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
}

void Texture::clear(const vec4& value) {
  forget(), hand_over();
  glClearTexImage(id_, 0, GL_RGBA, GL_FLOAT, &value);
}

void Texture::clear_uint(std::uint32_t value) {
  const std::uint32_t texel[4] = {value, value, value, value};
  forget(), hand_over();
  glClearTexImage(id_, 0, GL_RGBA_INTEGER, GL_UNSIGNED_INT, texel);
}

namespace {

template <class T>
struct Transfer;
template <>
struct Transfer<float> {
  static constexpr GLenum format = GL_RED, type = GL_FLOAT;
};
template <>
struct Transfer<vec2> {
  static constexpr GLenum format = GL_RG, type = GL_FLOAT;
};
template <>
struct Transfer<vec3> {
  static constexpr GLenum format = GL_RGB, type = GL_FLOAT;
};
template <>
struct Transfer<vec4> {
  static constexpr GLenum format = GL_RGBA, type = GL_FLOAT;
};
template <>
struct Transfer<std::uint32_t> {
  static constexpr GLenum format = GL_RED_INTEGER, type = GL_UNSIGNED_INT;
};
template <>
struct Transfer<std::uint8_t> {
  static constexpr GLenum format = GL_RED, type = GL_UNSIGNED_BYTE;
};
template <>
struct Transfer<Rgba8> {
  static constexpr GLenum format = GL_RGBA, type = GL_UNSIGNED_BYTE;
};

}  // namespace

template <class T>
void Texture::fetch(Image<T>& image) const {
  glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
  if (image.width() != width_ || image.height() != height_) image = Image<T>(width_, height_);
  if constexpr (sizeof(T) < 4) glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glGetTextureImage(id_, 0, Transfer<T>::format, Transfer<T>::type, GLsizei(image.size() * sizeof(T)),
                    image.data());
}

template <class T>
void Texture::download(Image<T>& image) const {
  if (is_here<T>()) {
    image = std::get<Image<T>>(here_);
    return;
  }
  hand_over();
  fetch(image);
}

template <class T>
void Texture::upload_rows(const Image<T>& image, int first, int rows) {
  if (rows == height_) forget();
  hand_over(), is_here_ = false;
  if constexpr (sizeof(T) < 4) glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTextureSubImage2D(id_, 0, 0, first, width_, rows, Transfer<T>::format, Transfer<T>::type, image.data());
}

void Texture::send() const {
  is_in_gl_ = true;
  std::visit(
      [&]<class Held>(const Held& image) {
        if constexpr (!std::is_same_v<Held, std::monostate>) {
          using T = std::decay_t<decltype(*image.data())>;
          if constexpr (sizeof(T) < 4) glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
          glTextureSubImage2D(id_, 0, 0, 0, width_, height_, Transfer<T>::format, Transfer<T>::type,
                              image.data());
        }
      },
      here_);
}

template <class T>
const Image<T>& Texture::peek() const {
  if (!is_here<T>()) {
    hand_over();
    is_here_ = false;
    if (!std::holds_alternative<Image<T>>(here_)) here_ = Image<T>();
    fetch(std::get<Image<T>>(here_));
    is_here_ = true;
  }
  return std::get<Image<T>>(here_);
}

template <class T>
Image<T> Texture::take() {
  peek<T>();
  return blank<T>();
}

template <class T>
Image<T> Texture::blank() {
  is_here_ = false, is_in_gl_ = true;
  Image<T>* kept = std::get_if<Image<T>>(&here_);
  Image<T> image = kept ? std::move(*kept) : Image<T>();
  here_ = std::monostate();
  if (image.width() != width_ || image.height() != height_) image = Image<T>(width_, height_);
  return image;
}

template <class T>
void Texture::give(Image<T>&& image) {
  assert(image.width() == width_ && image.height() == height_);
  here_ = std::move(image);
  is_here_ = true, is_in_gl_ = false;
}

template void Texture::download(Image<float>&) const;
template void Texture::download(Image<vec2>&) const;
template void Texture::download(Image<vec3>&) const;
template void Texture::download(Image<vec4>&) const;
template void Texture::download(Image<std::uint32_t>&) const;
template void Texture::download(Image<Rgba8>&) const;
template void Texture::upload_rows(const Image<float>&, int, int);
template void Texture::upload_rows(const Image<vec2>&, int, int);
template void Texture::upload_rows(const Image<vec3>&, int, int);
template void Texture::upload_rows(const Image<vec4>&, int, int);
template void Texture::upload_rows(const Image<std::uint32_t>&, int, int);
template void Texture::upload_rows(const Image<Rgba8>&, int, int);
template void Texture::upload_rows(const Image<std::uint8_t>&, int, int);

#define SFUMATO_HOLDS(T)                             \
  template const Image<T>& Texture::peek<T>() const; \
  template Image<T> Texture::take<T>();              \
  template Image<T> Texture::blank<T>();             \
  template void Texture::give<T>(Image<T> &&);
SFUMATO_HOLDS(float)
SFUMATO_HOLDS(vec4)
SFUMATO_HOLDS(std::uint32_t)
SFUMATO_HOLDS(std::uint8_t)
SFUMATO_HOLDS(Rgba8)
#undef SFUMATO_HOLDS

void ensure(Texture& texture, const std::string& label, GLenum format, int width, int height) {
  if (texture && texture.width() == width && texture.height() == height && texture.format() == format)
    return texture.forget();
  texture = Texture(label, format, width, height);
}

Framebuffer::Framebuffer(std::initializer_list<const Texture*> colors, const Texture* depth) {
  glCreateFramebuffers(1, &id_);
  GLenum buffers[8];
  int count = 0;
  for (const Texture* color : colors) {
    glNamedFramebufferTexture(id_, GL_COLOR_ATTACHMENT0 + GLenum(count), color->id(), 0);
    buffers[count] = GL_COLOR_ATTACHMENT0 + GLenum(count);
    ++count;
    width_ = color->width();
    height_ = color->height();
  }
  if (depth) {
    glNamedFramebufferTexture(id_, GL_DEPTH_ATTACHMENT, depth->id(), 0);
    width_ = depth->width();
    height_ = depth->height();
  }
  if (count)
    glNamedFramebufferDrawBuffers(id_, count, buffers);
  else
    glNamedFramebufferDrawBuffer(id_, GL_NONE);
  if (glCheckNamedFramebufferStatus(id_, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw Error(ErrorCode::no_gl, "the driver refuses a framebuffer of " + std::to_string(count) +
                                      " float targets; run `sfumato doctor`");
}

void Framebuffer::bind() const {
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, id_);
  glViewport(0, 0, width_, height_);
}

}  // namespace sfumato::gl
