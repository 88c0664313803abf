#include "view/shared_scenes.h"

namespace sfumato::view {

SharedScenes::SharedScenes() {
  const auto gate = std::make_shared<Painter::Gate>(2);
  sample = Painter::make_thread(gate);
  whole = Painter::make_thread(gate);
}

std::shared_ptr<const Loaded> SharedScenes::find(const std::string& scene_key) const {
  const auto found = scenes_.find(scene_key);
  return found == scenes_.end() ? nullptr : found->second.lock();
}

std::shared_ptr<const Loaded> SharedScenes::keep(const std::string& scene_key, Loaded loaded) {
  std::erase_if(scenes_, [](const auto& each) { return each.second.expired(); });
  loaded.whole = {}, loaded.sample = {};
  auto kept = std::make_shared<const Loaded>(std::move(loaded));
  scenes_[scene_key] = kept;
  return kept;
}

}  // namespace sfumato::view
