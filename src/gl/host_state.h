// The state of a context that belongs to somebody else: what a full-screen draw of ours touches, saved and
// restored.
#pragma once

#include <epoxy/gl.h>

#include <array>
#include <vector>

namespace sfumato::gl {

/// While it lives, the context that is current draws one triangle without attributes over `viewport` of
/// `framebuffer`, whatever its owner had set: with depth test and depth writes, premultiplied colours blended
/// over what is there. After it everything is as it was. For OpenGL 4.5, core or compatibility; not within a
/// conditional render or an unpaused transform feedback of the host, which OpenGL does not let a library see.
/// It asks for no errors, so that the host's own stay.
class HostState {
 public:
  static constexpr int texture_units = 2;  ///< from 0 on: theirs to bind

  /// `viewport`: x, y, width, height in pixels of the framebuffer, as of glViewport.
  HostState(GLuint framebuffer, const std::array<int, 4>& viewport, GLenum depth_function);
  ~HostState();
  HostState(const HostState&) = delete;
  HostState& operator=(const HostState&) = delete;

 private:
  struct Capability {
    GLenum name;
    GLboolean was_on;
  };
  /// Turns it on or off, and remembers.
  void set(GLenum capability, bool on);

  std::vector<Capability> capabilities_;
  GLboolean scissor_test_ = GL_FALSE, blend_ = GL_FALSE, depth_mask_ = GL_TRUE;
  GLint framebuffer_ = 0, program_ = 0, vertex_array_ = 0, active_unit_ = 0, depth_function_ = 0,
        polygon_mode_[2] = {};
  GLint blend_source_[2] = {}, blend_target_[2] = {}, blend_equation_[2] = {};
  GLfloat viewport_[4] = {};
  std::vector<std::array<GLboolean, 4>> color_masks_;  ///< of every draw buffer
  struct Unit {
    GLint texture, sampler;
  };
  std::array<Unit, texture_units> units_{};
  GLuint own_vertex_array_ = 0;
};

/// Pixels are read from our memory as they lie there, tightly packed, while this lives.
class HostUnpackState {
 public:
  HostUnpackState();
  ~HostUnpackState();
  HostUnpackState(const HostUnpackState&) = delete;
  HostUnpackState& operator=(const HostUnpackState&) = delete;

 private:
  static constexpr GLenum names[] = {GL_UNPACK_SWAP_BYTES,  GL_UNPACK_LSB_FIRST,   GL_UNPACK_ROW_LENGTH,
                                     GL_UNPACK_SKIP_ROWS,   GL_UNPACK_SKIP_PIXELS, GL_UNPACK_ALIGNMENT,
                                     GL_UNPACK_SKIP_IMAGES, GL_UNPACK_IMAGE_HEIGHT};
  std::array<GLint, std::size(names)> values_{};
  GLint buffer_ = 0;
};

}  // namespace sfumato::gl
