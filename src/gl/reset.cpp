#include "gl/reset.h"

#include <epoxy/gl.h>

#include <string>

#include "core/error.h"

namespace sfumato::gl {

void check_reset() {
  const GLenum status = glGetGraphicsResetStatus();
  if (status == GL_NO_ERROR) return;
  const std::string cause = status == GL_GUILTY_CONTEXT_RESET     ? "by what sfumato drew"
                            : status == GL_INNOCENT_CONTEXT_RESET ? "by another program"
                                                                  : "for an unknown cause";
  throw Error(ErrorCode::no_gl, "the graphics driver was reset (" + cause +
                                    ") and all on the GPU is lost; start sfumato "
                                    "again, with fewer points (--max-points) if it happens again");
}

}  // namespace sfumato::gl
