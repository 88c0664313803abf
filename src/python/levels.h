// COPC files that are read as far as they are needed.
#pragma once

#include "cloud.h"
#include "scene/leveled_scene.h"
#include "session/session.h"

namespace sfumato::python {

/// How a scene presents itself, and where one stands in it.
struct Stand {
  Pose pose;
  dvec3 place;  ///< to look around from, world
};

/// Files of any size. Only what is asked for is read, within the memory that they may take.
struct Levels {
  scene::LeveledScene scene;
  std::string file;  ///< the first
};

/// The methods that whoever has a stand gives to Python.
struct StandMethods {
  static Camera first_view(const Stand& stand, int width, int height);
  /// The same, as far back as a turn needs.
  static Camera first_of_turn(const Stand& stand, int width, int height);
  static Camera view(const Stand& stand, const py::dict& wishes);
  /// From the place inside, in the same direction.
  static Camera inside(const Stand& stand, Camera camera);
  static py::tuple up_vector(const Stand& stand);
};

}  // namespace sfumato::python
