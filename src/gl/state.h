// Draw state as a value, complete at every draw: no pass inherits state from another.
#pragma once

#include <epoxy/gl.h>

namespace sfumato::gl {

struct State {
  enum class Depth { off, test, test_and_write };
  enum class Blend { off, add, min, premultiplied_over, premultiplied_under };
  Depth depth = Depth::off;
  GLenum depth_func = GL_LESS;
  Blend blend = Blend::off;

  void apply() const {
    glDisable(GL_CULL_FACE);
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_STENCIL_TEST);
    if (depth == Depth::off) {
      glDisable(GL_DEPTH_TEST);
    } else {
      glEnable(GL_DEPTH_TEST);
      glDepthFunc(depth_func);
    }
    glDepthMask(depth == Depth::test_and_write);
    if (blend == Blend::off) {
      glDisable(GL_BLEND);
      return;
    }
    glEnable(GL_BLEND);
    glBlendEquation(blend == Blend::min ? GL_MIN : GL_FUNC_ADD);
    switch (blend) {
      case Blend::premultiplied_over: glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA); break;
      case Blend::premultiplied_under: glBlendFunc(GL_ONE_MINUS_DST_ALPHA, GL_ONE); break;
      default: glBlendFunc(GL_ONE, GL_ONE);
    }
  }
};

}  // namespace sfumato::gl
