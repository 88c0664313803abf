#include "view/shared_scenes.h"

namespace sfumato::view {

SharedScenes::SharedScenes() {
  const auto gate = std::make_shared<RenderClient::Gate>(2);
  sample = RenderClient::make_thread(gate);
  whole = RenderClient::make_thread(gate);
}

std::shared_ptr<const Loaded> SharedScenes::find(const SceneKey& key) const {
  for (const auto& [its_key, scene] : scenes_)
    if (its_key == key) return scene.lock();
  return nullptr;
}

std::shared_ptr<const Loaded> SharedScenes::keep(const SceneKey& key, Loaded loaded) {
  std::erase_if(scenes_, [&](const auto& each) { return each.second.expired() || each.first == key; });
  loaded.whole = {}, loaded.sample = {};
  auto kept = std::make_shared<const Loaded>(std::move(loaded));
  scenes_.emplace_back(key, kept);
  return kept;
}

}  // namespace sfumato::view
