// One word that passes set when some pixel says yes; read back after the pass.
#pragma once

#include "gl/texture.h"

namespace sfumato {

class Flag {
 public:
  /// Clears the flag and binds it as image 7.
  void arm();
  /// Waits for the GPU.
  bool is_set();

 private:
  gl::Texture word_;
};

}  // namespace sfumato
