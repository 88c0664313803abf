// COPC files that are read as far as they are needed.
#pragma once

#include "scene/leveled_scene.h"

namespace sfumato::python {

/// Files of any size. Only what is asked for is read, within the memory that they may take.
struct Levels {
  scene::LeveledScene scene;
  std::string file;  ///< the first
};

}  // namespace sfumato::python
