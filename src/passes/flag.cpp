#include "passes/flag.h"
#include "gl/commands.h"

#include <cstdint>

namespace sfumato {

void Flag::arm() {
  gl::ensure(word_, "flag", GL_R32UI, 1, 1);
  word_.clear_uint(0);
  word_.bind_image(7, GL_WRITE_ONLY);
}

bool Flag::is_set() {
  gl::barrier(GL_TEXTURE_UPDATE_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
  return word_.download<std::uint32_t>().at(0, 0) != 0;
}

}  // namespace sfumato
