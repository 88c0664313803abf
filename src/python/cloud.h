// Clouds as Python holds them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bindings.h"
#include "scene/scene.h"

namespace sfumato::python {

/// A scene that was read, made or taken from arrays. Its points are never added or removed while it lives:
/// arrays of Python are views of them.
struct Cloud {
  scene::Scene scene;
  std::string file;                 ///< the first it was read from; empty for arrays
  std::optional<UpAxis> up;         ///< what the user says is up
  std::vector<std::uint32_t> kept;  ///< of arrays with rows that are not finite: the rows that are points

  PointCloud& points() { return scene.cloud; }
};

/// "+Z", or None for nothing. Throws Error(usage).
std::optional<UpAxis> up_axis(const std::optional<std::string>& text);

/// World from points, given as 16 numbers row by row. Throws Error(usage) for what is no such transform.
dmat4 transform_of(const std::vector<double>& rows);

}  // namespace sfumato::python
