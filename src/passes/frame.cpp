#include "passes/frame.h"

namespace sfumato {

Target::Target(int width, int height)
    : color("target color", GL_RGBA32F, width, height),
      depth("target depth", GL_R32F, width, height),
      normal("target normal", GL_RGBA32F, width, height) {}

}  // namespace sfumato
