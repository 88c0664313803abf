#include "gl/host_canvas.h"

#include <dlfcn.h>
#include <epoxy/egl.h>

#include <string>
#include <utility>

#include "core/error.h"
#include "gl/host_state.h"

namespace sfumato::gl {
namespace {

/// From the end of the range: two steps of 24 bits.
constexpr float last_depth = 0x1p-23f;

/// A context of EGL or of GLX, asked without linking X: who uses GLX has its library loaded.
bool has_context() {
  using CurrentContext = void* (*)();
  for (const char* library : {"libGLX.so.0", "libGL.so.1"})
    if (void* handle = dlopen(library, RTLD_LAZY | RTLD_NOLOAD)) {
      const auto current = reinterpret_cast<CurrentContext>(dlsym(handle, "glXGetCurrentContext"));
      const bool found = current && current();
      dlclose(handle);
      if (found) return true;
    }
  if (void* handle = dlopen("libEGL.so.1", RTLD_LAZY | RTLD_NOLOAD)) {
    dlclose(handle);
    return eglGetCurrentContext() != EGL_NO_CONTEXT;
  }
  return false;
}

}  // namespace

HostCanvas::~HostCanvas() {
  // Whatever context is current now, it may not be the host's: nothing is deleted in it.
  if (program_) program_.abandon();
}

void HostCanvas::require_context() {
  if (!has_context())
    throw Error(
        ErrorCode::no_gl,
        "no OpenGL context is current on this thread: make the host's current before drawing into it");
  if (epoxy_gl_version() < 45 || !epoxy_is_desktop_gl())
    throw Error(ErrorCode::no_gl,
                std::string("drawing into another program's context needs OpenGL 4.5, it has ") +
                    reinterpret_cast<const char*>(glGetString(GL_VERSION)) +
                    "; ask for a newer context, or use the picture itself");
}

void HostCanvas::upload(const Image<Rgba8>& color, const Image<float>& depth) {
  if (width_ != color.width() || height_ != color.height()) {
    glDeleteTextures(2, textures_);
    glCreateTextures(GL_TEXTURE_2D, 2, textures_);
    width_ = color.width(), height_ = color.height();
    int i = 0;
    for (const GLenum format : {GL_RGBA8, GL_R32F}) {
      glTextureStorage2D(textures_[i], 1, format, width_, height_);
      glTextureParameteri(textures_[i], GL_TEXTURE_MIN_FILTER, GL_NEAREST);
      glTextureParameteri(textures_[i++], GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    }
  }
  const HostUnpackState unpack;
  glTextureSubImage2D(textures_[0], 0, 0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, color.data());
  glTextureSubImage2D(textures_[1], 0, 0, 0, width_, height_, GL_RED, GL_FLOAT, depth.data());
}

void HostCanvas::draw(const Image<Rgba8>& color, const Image<float>& depth, std::uint64_t serial,
                      const dmat4& projection, std::uint32_t framebuffer, const std::array<int, 4>& viewport,
                      float opacity) {
  require_context();
  if (serial != serial_ || !textures_[0]) upload(color, depth);
  serial_ = serial;
  if (!program_) program_ = Program::raster("gl/host_picture.vert", "gl/host_picture.frag");

  // Eye depth d to depth in the buffer: clip z and w are linear in d.
  GLint clip_depth = GL_NEGATIVE_ONE_TO_ONE, clip_origin = GL_LOWER_LEFT;
  glGetIntegerv(GL_CLIP_DEPTH_MODE, &clip_depth);
  glGetIntegerv(GL_CLIP_ORIGIN, &clip_origin);
  GLfloat range[2] = {0, 1};
  glGetFloati_v(GL_DEPTH_RANGE, 0, range);
  const dmat4& p = projection;
  const auto ndc = [&](double d) { return (p[3][2] - p[2][2] * d) / (p[3][3] - p[2][3] * d); };
  const bool is_reversed = ndc(1) > ndc(2);  // what is nearer has more depth
  const bool is_less_nearer = is_reversed == (range[0] > range[1]);
  const HostState state(framebuffer, viewport, is_less_nearer ? GL_LEQUAL : GL_GEQUAL);
  program_.set("depth_row", vec4(float(p[3][2]), float(-p[2][2]), float(p[3][3]), float(-p[2][3])))
      .set("half_depth", clip_depth == GL_NEGATIVE_ONE_TO_ONE)
      .set("farthest", is_reversed ? last_depth : 1 - last_depth)
      .set("depth_range", vec2(range[0], range[1]))
      .set("opacity", opacity)
      .set("corner", ivec2(viewport[0], viewport[1]))
      .set("is_bottom_up", clip_origin == GL_LOWER_LEFT);
  program_.use();
  glBindTextureUnit(0, textures_[0]);
  glBindTextureUnit(1, textures_[1]);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void HostCanvas::release() {
  program_ = Program();
  glDeleteTextures(2, textures_);
  textures_[0] = textures_[1] = 0;
  width_ = height_ = 0;
}

}  // namespace sfumato::gl
