#include "scene/leveled_scene.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "io/byte_source.h"
#include "scene/assemble.h"

namespace sfumato::scene {
namespace {

// Points of the first look: enough to tell what the scan is, read in a moment.
constexpr std::uint64_t overview_points = 300'000;
// Of what is out of view only shadows are seen: their details are wider than those of the surface.
constexpr double outside_with_shadows = 0.25;
// Of a sample of fewer points, the levels are no worse.
constexpr std::size_t least_selected = 4096;

}  // namespace

std::optional<LeveledScene> LeveledScene::open(const std::vector<SceneFile>& files,
                                               const SceneOptions& options, std::uint64_t memory,
                                               bool always) {
  const auto is_tree = [](const SceneFile& file) { return !file.transform && copc::is_tree(file.name); };
  if (files.empty() || !std::all_of(files.begin(), files.end(), is_tree)) return std::nullopt;
  LeveledScene scene;
  for (const SceneFile& file : files) scene.trees_.push_back(copc::read_tree(file.name));
  scene.budget_ = std::max<std::uint64_t>(1, memory / memory_of_point);
  if (options.read.max_points) scene.budget_ = std::min(scene.budget_, *options.read.max_points);
  // Views are measured in metres.
  if (!options.keep_degrees)
    for (const copc::Tree& tree : scene.trees_)
      if (local_metres_of(tree.crs, tree.bounds, tree.bounds)) return std::nullopt;
  const bool is_far =
      std::any_of(files.begin(), files.end(), [](const SceneFile& file) { return io::is_remote(file.name); });
  if (scene.points() <= scene.budget_ && !always && !is_far) return std::nullopt;
  // What the first look has fetched is not fetched again.
  if (is_far) scene.keep_nodes(std::make_shared<io::ChunkCache>(memory / share_of_kept_nodes));
  scene.files_ = files;
  scene.options_ = options;
  // Shares of a box mean that of the files, not that of the nodes which happen to be read.
  Selection& selection = scene.options_.selection;
  if (selection.crop_share) {
    const Bounds all = scene.bounds(), share = *selection.crop_share;
    selection.crop = Bounds{all.min + share.min * all.size(), all.min + share.max * all.size()};
    selection.crop_share.reset();
  }
  return scene;
}

LeveledScene LeveledScene::unselected() const {
  LeveledScene all = *this;
  all.options_.selection = {};
  return all;
}

Bounds LeveledScene::bounds() const {
  Bounds all = trees_[0].bounds;
  for (const copc::Tree& tree : trees_)
    all.min = glm::min(all.min, tree.bounds.min), all.max = glm::max(all.max, tree.bounds.max);
  return all;
}

std::uint64_t LeveledScene::points() const {
  std::uint64_t all = 0;
  for (const copc::Tree& tree : trees_) all += tree.points;
  return all;
}

Scene LeveledScene::unselected_overview(Progress& progress) const {
  const LeveledScene all = unselected();
  return all.gather(all.coarse_nodes(overview_points), progress);
}

Scene LeveledScene::overview(Progress& progress, std::optional<Scene> all) {
  Scene scene;
  try {
    const bool is_there = all && !options_.selection.crop;
    scene = is_there ? narrowed(std::move(*all)) : coarse(overview_points, progress);
  } catch (const NothingSelected& nothing) {
    scene = unselected().coarse(overview_points, progress);
    scene.notes.push_back("nothing of the selection is in the coarse levels (" + std::string(nothing.what()) +
                          "): the view is that of all points");
  }
  if (!overview_) {
    std::optional<PointCloud> sampled = sample(progress);
    overview_ = std::make_shared<const Overview>(
        sampled ? Overview{std::move(*sampled), std::make_shared<const PointCloud>(scene.cloud)}
                : Overview{scene.cloud, nullptr});
  }
  scene.overview = overview_;
  return scene;
}

std::optional<PointCloud> LeveledScene::sample(Progress& progress) const {
  // The levels have more points of a box than a sample of everything.
  if (options_.selection.crop) return std::nullopt;
  // Files that are too small to bring one are read whole, as far as the levels would be.
  std::uint64_t without = 0;
  double share = double(copc::RecordSample::most) / double(points());  // the same of each
  for (const copc::Tree& tree : trees_)
    if (tree.sample)
      share = std::min(share, double(tree.sample->count) / double(tree.points));
    else
      without += tree.points;
  if (without > overview_points || without == points()) return std::nullopt;
  SceneOptions all = options_;
  all.read.max_points.reset();
  const auto read_one = [&](std::size_t i) {
    const copc::Tree& tree = trees_[i];
    const io::KeptChunks kept{kept_.get(), i};
    std::optional<io::ReadResult> sampled;
    if (tree.sample) {
      sampled = copc::read_sample(tree, progress, kept);
      if (!sampled) throw Error(ErrorCode::bad_input, files_[i].name + ": its sample is damaged");
    } else {
      std::vector<std::size_t> nodes(tree.nodes.size());
      std::iota(nodes.begin(), nodes.end(), std::size_t{0});
      sampled = copc::read_nodes(tree, nodes, progress, kept);
    }
    const auto wanted = std::size_t(std::ceil(share * double(tree.points)));
    if (sampled->cloud.size() > wanted) sampled->cloud = subsample(sampled->cloud, wanted);
    return std::move(*sampled);
  };
  try {
    Scene scene = assemble(files_, all, read_one, true);
    if (scene.cloud.size() < least_selected) return std::nullopt;
    return std::move(scene.cloud);
  } catch (const Cancelled&) {
    throw;
  } catch (const Error&) {
    return std::nullopt;  // one is damaged, or nothing of the selection is in them
  }
}

copc::NodeSelection LeveledScene::coarse_nodes(std::uint64_t points) const {
  return copc::select_overview(trees_, std::min(budget_, points), options_.selection.crop);
}

Scene LeveledScene::coarse(std::uint64_t points, Progress& progress) const {
  return read(coarse_nodes(points), progress);
}

copc::NodeSelection LeveledScene::select(std::span<const copc::View> views, bool has_shadows,
                                         double least_px) const {
  copc::SelectOptions wanted;
  wanted.budget = budget_;
  wanted.least_px = least_px;
  wanted.outside = has_shadows ? outside_with_shadows : 0;
  wanted.box = options_.selection.crop;
  return copc::select_nodes(trees_, views, wanted);
}

Scene LeveledScene::read(std::span<const copc::View> views, bool has_shadows, Progress& progress) const {
  return read(select(views, has_shadows), progress);
}

Scene LeveledScene::read(const copc::NodeSelection& selection, Progress& progress) const {
  return narrowed(gather(selection, progress));
}

Scene LeveledScene::gather(const copc::NodeSelection& selection, Progress& progress) const {
  if (kept_) kept_->begin_read();
  const auto read_one = [&](std::size_t i) {
    io::ReadResult result =
        copc::read_nodes(trees_[i], selection.nodes[i], progress, io::KeptChunks{kept_.get(), i});
    if (result.cloud.size() > selection.wanted[i])
      result.cloud = subsample(result.cloud, std::size_t(selection.wanted[i]));
    return result;
  };
  SceneOptions all = options_;
  all.selection = {};
  all.read.max_points.reset();
  Scene scene = assemble(files_, all, read_one, true);
  scene.levels = {selection.points,     selection.points_needed, selection.points_in_files,
                  selection.nodes_read, selection.nodes_needed,  selection.nodes_in_files,
                  selection.widest_px};
  scene.overview = overview_;
  return scene;
}

Scene LeveledScene::narrowed(Scene scene) const {
  try {
    narrow(scene, files_, options_);
  } catch (const NothingSelected& nothing) {
    throw NothingSelected(std::string(nothing.what()) +
                          " (of the points that are read for this view; a nearer one reads finer levels)");
  }
  return scene;
}

}  // namespace sfumato::scene
