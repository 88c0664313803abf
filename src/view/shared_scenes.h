// What several view models of one thread have in common: two render threads, and scenes that are read
// once and stand in memory once for all that look at the same points.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "view/loader.h"

namespace sfumato::view {

struct SharedScenes {
  SharedScenes();

  /// Without their clouds, which the render clients have.
  std::shared_ptr<const Loaded> find(const SceneKey& key) const;
  std::shared_ptr<const Loaded> keep(const SceneKey& key, Loaded loaded);

  std::shared_ptr<RenderThread> sample, whole;

 private:
  std::vector<std::pair<SceneKey, std::weak_ptr<const Loaded>>> scenes_;
};

}  // namespace sfumato::view
