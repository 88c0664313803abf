#include "gl/host_state.h"

namespace sfumato::gl {
namespace {

GLint number(GLenum name) {
  GLint value = 0;
  glGetIntegerv(name, &value);
  return value;
}

GLint number(GLenum name, GLuint index) {
  GLint value = 0;
  glGetIntegeri_v(name, index, &value);
  return value;
}

/// Alpha test and stipple of old OpenGL hold for shaders as well, and core contexts refuse their names.
bool is_compatibility() { return number(GL_CONTEXT_PROFILE_MASK) & GL_CONTEXT_COMPATIBILITY_PROFILE_BIT; }

}  // namespace

void HostState::set(GLenum capability, bool on) {
  capabilities_.push_back({capability, glIsEnabled(capability)});
  on ? glEnable(capability) : glDisable(capability);
}

HostState::HostState(GLuint framebuffer, const std::array<int, 4>& viewport, GLenum depth_function) {
  framebuffer_ = number(GL_DRAW_FRAMEBUFFER_BINDING);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);

  for (const GLenum off : {GL_CULL_FACE, GL_STENCIL_TEST, GL_COLOR_LOGIC_OP, GL_RASTERIZER_DISCARD,
                           GL_SAMPLE_COVERAGE, GL_SAMPLE_ALPHA_TO_COVERAGE, GL_SAMPLE_ALPHA_TO_ONE,
                           GL_SAMPLE_MASK, GL_SAMPLE_SHADING, GL_FRAMEBUFFER_SRGB, GL_DITHER, GL_DEPTH_CLAMP})
    set(off, false);
  for (GLint i = 0; i < number(GL_MAX_CLIP_DISTANCES); ++i) set(GLenum(GL_CLIP_DISTANCE0 + i), false);
  if (is_compatibility())
    for (const GLenum off : {GL_ALPHA_TEST, GL_POLYGON_STIPPLE}) set(off, false);
  set(GL_DEPTH_TEST, true);

  // Of viewports, scissors and blending the first is drawn with; the host's others stay untouched.
  glGetFloati_v(GL_VIEWPORT, 0, viewport_);
  glViewportIndexedf(0, float(viewport[0]), float(viewport[1]), float(viewport[2]), float(viewport[3]));
  scissor_test_ = glIsEnabledi(GL_SCISSOR_TEST, 0);
  glDisablei(GL_SCISSOR_TEST, 0);
  blend_ = glIsEnabledi(GL_BLEND, 0);
  glEnablei(GL_BLEND, 0);
  blend_source_[0] = number(GL_BLEND_SRC_RGB, 0), blend_source_[1] = number(GL_BLEND_SRC_ALPHA, 0);
  blend_target_[0] = number(GL_BLEND_DST_RGB, 0), blend_target_[1] = number(GL_BLEND_DST_ALPHA, 0);
  blend_equation_[0] = number(GL_BLEND_EQUATION_RGB, 0),
  blend_equation_[1] = number(GL_BLEND_EQUATION_ALPHA, 0);
  glBlendFunci(0, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glBlendEquationi(0, GL_FUNC_ADD);
  // What the shader does not write would be undefined.
  color_masks_.resize(std::size_t(number(GL_MAX_DRAW_BUFFERS)));
  for (std::size_t i = 0; i < color_masks_.size(); ++i) {
    glGetBooleani_v(GL_COLOR_WRITEMASK, GLuint(i), color_masks_[i].data());
    const GLboolean writes = i == 0;
    glColorMaski(GLuint(i), writes, writes, writes, writes);
  }
  glGetBooleanv(GL_DEPTH_WRITEMASK, &depth_mask_);
  glDepthMask(GL_TRUE);
  depth_function_ = number(GL_DEPTH_FUNC);
  glDepthFunc(depth_function);
  glGetIntegerv(GL_POLYGON_MODE, polygon_mode_);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);

  program_ = number(GL_CURRENT_PROGRAM);
  vertex_array_ = number(GL_VERTEX_ARRAY_BINDING);
  glCreateVertexArrays(
      1, &own_vertex_array_);  // vertex arrays are never shared, so one that is here is the context's own
  glBindVertexArray(own_vertex_array_);
  active_unit_ = number(GL_ACTIVE_TEXTURE);
  for (int i = 0; i < texture_units; ++i) {
    glActiveTexture(GLenum(GL_TEXTURE0 + i));
    units_[std::size_t(i)] = {number(GL_TEXTURE_BINDING_2D), number(GL_SAMPLER_BINDING)};
    glBindSampler(GLuint(i), 0);
  }
}

HostState::~HostState() {
  for (int i = 0; i < texture_units; ++i) {
    const Unit& unit = units_[std::size_t(i)];
    glActiveTexture(GLenum(GL_TEXTURE0 + i));
    glBindTexture(GL_TEXTURE_2D, GLuint(unit.texture));
    glBindSampler(GLuint(i), GLuint(unit.sampler));
  }
  glActiveTexture(GLenum(active_unit_));
  glBindVertexArray(GLuint(vertex_array_));
  glDeleteVertexArrays(1, &own_vertex_array_);
  glUseProgram(GLuint(program_));

  // Old OpenGL has a mode for each side.
  if (polygon_mode_[1] != polygon_mode_[0] && polygon_mode_[1] != 0) {
    glPolygonMode(GL_FRONT, GLenum(polygon_mode_[0]));
    glPolygonMode(GL_BACK, GLenum(polygon_mode_[1]));
  } else {
    glPolygonMode(GL_FRONT_AND_BACK, GLenum(polygon_mode_[0]));
  }
  glDepthFunc(GLenum(depth_function_));
  glDepthMask(depth_mask_);
  for (std::size_t i = 0; i < color_masks_.size(); ++i) {
    const std::array<GLboolean, 4>& mask = color_masks_[i];
    glColorMaski(GLuint(i), mask[0], mask[1], mask[2], mask[3]);
  }
  glBlendFuncSeparatei(0, GLenum(blend_source_[0]), GLenum(blend_target_[0]), GLenum(blend_source_[1]),
                       GLenum(blend_target_[1]));
  glBlendEquationSeparatei(0, GLenum(blend_equation_[0]), GLenum(blend_equation_[1]));
  if (!blend_) glDisablei(GL_BLEND, 0);
  if (scissor_test_) glEnablei(GL_SCISSOR_TEST, 0);
  glViewportIndexedfv(0, viewport_);
  for (const Capability& each : capabilities_) each.was_on ? glEnable(each.name) : glDisable(each.name);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, GLuint(framebuffer_));
}

HostUnpackState::HostUnpackState() {
  buffer_ = number(GL_PIXEL_UNPACK_BUFFER_BINDING);
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
  for (std::size_t i = 0; i < values_.size(); ++i) {
    values_[i] = number(names[i]);
    glPixelStorei(names[i], names[i] == GL_UNPACK_ALIGNMENT ? 1 : 0);
  }
}

HostUnpackState::~HostUnpackState() {
  for (std::size_t i = 0; i < values_.size(); ++i) glPixelStorei(names[i], values_[i]);
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, GLuint(buffer_));
}

}  // namespace sfumato::gl
