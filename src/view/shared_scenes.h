// What several workbenches of one thread have in common: two threads that paint, and scenes that are read
// once and stand in memory once for all that look at the same points.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "view/loader.h"

namespace sfumato::view {

struct SharedScenes {
  SharedScenes();

  /// By `Wishes::scene_key`; without their clouds, which the painters have.
  std::shared_ptr<const Loaded> find(const std::string& scene_key) const;
  std::shared_ptr<const Loaded> keep(const std::string& scene_key, Loaded loaded);

  std::shared_ptr<PaintThread> sample, whole;

 private:
  std::map<std::string, std::weak_ptr<const Loaded>> scenes_;
};

}  // namespace sfumato::view
