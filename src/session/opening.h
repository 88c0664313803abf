// From a request to something that can be drawn: the points of its files, or of files larger than the memory
// those that a view needs; which way is up; and from where to look.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "scene/leveled_scene.h"
#include "session/request.h"

namespace sfumato {

class Opening {
 public:
  /// Reads the files, or the coarse levels of files with levels that are larger than the request's memory.
  /// Throws as scene::read_scene does, and Error(usage) where heights are exaggerated of the latter.
  Opening(const Request& request, const std::vector<scene::SceneFile>& files,
          Progress& progress = no_progress());
  /// Files with levels, however large they are. `all`: of them, as LeveledScene::overview takes it.
  Opening(const Request& request, scene::LeveledScene files, Progress& progress = no_progress(),
          std::optional<scene::Scene> all = std::nullopt);
  /// The same where the pose is known: nothing is read but what views need.
  Opening(const Request& request, scene::LeveledScene files, Pose pose);
  /// What is in memory, and selected.
  Opening(const Request& request, scene::Scene scene, Progress& progress = no_progress());

  const Pose& pose() const { return pose_; }
  /// Where the request stands. A panorama without a place stands inside.
  Camera camera() const;
  /// The same direction from where a scanner stood, else from the middle. Not of an opening that was given
  /// its pose.
  Camera inside(Camera camera) const;
  /// Each view has points of its own.
  bool has_levels() const { return leveled_.has_value(); }
  const scene::LeveledScene& levels() const { return *leveled_; }
  /// Whether the points of all these views have room together.
  bool holds(std::span<const Camera> cameras, bool has_shadows) const;
  /// What is decoded for one view is not decoded again for the next.
  void keep_nodes();
  /// What was read before any view asked: all of the files, or their coarse levels. It is given away.
  scene::Scene take() { return std::move(scene_); }
  /// What these views show of files with levels, standing as they do.
  scene::Scene read(std::span<const Camera> cameras, bool has_shadows,
                    Progress& progress = no_progress()) const;
  scene::Scene read(const copc::NodeSelection& nodes, Progress& progress = no_progress()) const;
  /// Other files that are seen as these are, as the frames of a sequence.
  scene::Scene read_next(const std::vector<scene::SceneFile>& files, const Camera& camera, bool has_shadows,
                         Progress& progress = no_progress()) const;

 private:
  scene::Scene read_overview(std::optional<scene::Scene> all, Progress& progress);
  void check_levels() const;
  void find_pose(Progress& progress);

  Request request_;
  std::optional<scene::LeveledScene> leveled_;
  scene::Scene scene_;
  Pose pose_;
  dvec3 place_{0};
};

}  // namespace sfumato
