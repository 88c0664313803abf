// Scenes of COPC files that are read by their levels.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "copc/select.h"
#include "scene/scene.h"

namespace sfumato::scene {

/// COPC files with more points than are read at once: seen from afar first, then as far as a view needs.
class LeveledScene {
 public:
  /// Nothing unless all files are COPC, stand where their points say and have more points together than
  /// `read.max_points` and `memory` allow; `always`: also where they have fewer.
  static std::optional<LeveledScene> open(const std::vector<SceneFile>& files, const SceneOptions& options,
                                          std::uint64_t memory, bool always = false);

  /// The coarse levels: from where to look follows from them. They, or the sample that the files bring, go
  /// with all that is read later (`Scene::overview`).
  /// Where nothing of the selection is in them, they hold what the whole has, and a note says so.
  /// `all`, from `unselected_overview`, is not read again unless a box wants other nodes.
  Scene overview(Progress& progress = no_progress(), std::optional<Scene> all = std::nullopt);
  /// What these levels hold whatever is selected, and whatever box.
  Scene unselected_overview(Progress& progress = no_progress()) const;
  /// Where it was read before, of the same files and selection.
  void set_overview(std::shared_ptr<const Overview> overview) { overview_ = std::move(overview); }
  /// As many whole levels as `points` and the budget allow, the coarsest in any case.
  Scene coarse(std::uint64_t points, Progress& progress = no_progress()) const;
  /// What the views need, within the budget. `has_shadows`: what is out of view counts too, coarsely.
  Scene read(std::span<const copc::View> views, bool has_shadows, Progress& progress = no_progress()) const;

  /// The two halves of `read`. `least_px`: the spacing that is not refined any more, in pixels.
  copc::NodeSelection select(std::span<const copc::View> views, bool has_shadows,
                             double least_px = copc::SelectOptions{}.least_px) const;
  Scene read(const copc::NodeSelection& selection, Progress& progress = no_progress()) const;
  /// Nodes are looked for there before they are decoded. Of these very files, in their order.
  /// See `share_of_kept_nodes`.
  void keep_nodes(std::shared_ptr<io::ChunkCache> kept) { kept_ = std::move(kept); }
  bool keeps_nodes() const { return kept_ != nullptr; }

  const std::vector<copc::Tree>& trees() const { return trees_; }
  /// What the headers say of all points, whatever is selected.
  Bounds bounds() const;
  std::uint64_t points() const;

 private:
  /// The same without a selection.
  LeveledScene unselected() const;
  copc::NodeSelection coarse_nodes(std::uint64_t points) const;
  /// All points of the nodes, and what is selected of them.
  Scene gather(const copc::NodeSelection& nodes, Progress& progress) const;
  Scene narrowed(Scene scene) const;
  /// What is selected of the samples that the files bring, as many points of each as of the others in
  /// proportion. Nothing: too few of their points are selected, one is damaged, or files without one are not
  /// small.
  std::optional<PointCloud> sample(Progress& progress) const;

  std::vector<SceneFile> files_;
  std::vector<copc::Tree> trees_;
  SceneOptions options_;
  std::uint64_t budget_ = 0;
  std::shared_ptr<io::ChunkCache> kept_;
  std::shared_ptr<const Overview> overview_;
};

/// What a point takes in memory from file to picture, for most techniques.
inline constexpr std::uint64_t memory_of_point = 100;
/// And on the graphics card: place, normal, colour, radius, and a number each for field, shadow and order.
inline constexpr std::uint64_t gpu_memory_of_point = 48;
/// Nodes as they were decoded may take this part of the memory of the points, beside the points themselves.
inline constexpr std::uint64_t share_of_kept_nodes = 16;
/// What the points of COPC files may take unless the user says so; the others are read whole.
inline constexpr std::uint64_t default_memory = 4'000'000'000;

}  // namespace sfumato::scene
