// Files that were read, put together to a scene.
#pragma once

#include <functional>

#include "scene/scene.h"

namespace sfumato::scene {

/// `read` gives the file of that number. `may_be_empty`: a file without points is no error as long as another
/// has some.
Scene assemble(const std::vector<SceneFile>& files, const SceneOptions& options,
               const std::function<io::ReadResult(std::size_t)>& read, bool may_be_empty = false);

}  // namespace sfumato::scene
