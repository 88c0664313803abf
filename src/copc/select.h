// Which nodes of octrees a picture needs.
//
// The rule: a node is read when the spacing of its parent is wider than `least_px` at its nearest place in
// view. Nodes come in the order of that width, so nearest and coarsest first, until no node is left or the
// budget is used up. The choice follows from views, budget and files alone. Of several trees, as of a folder
// of tiles, the roots in view are read, those that are small on the screen thinned to what pixels tell apart.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "copc/tree.h"
#include "core/camera.h"

namespace sfumato::copc {

struct View {
  Camera camera;
  bool panorama = false;  ///< everything around the camera's position
};

std::vector<View> views_of(std::span<const Camera> cameras, bool panorama = false);

struct SelectOptions {
  std::uint64_t budget = 20'000'000;  ///< points
  double least_px = 0.7;
  /// Pixels around a picture of so many rows that count as in view: techniques look there for neighbours.
  static constexpr int height_of_margin = 720;
  int margin_px = 64;
  /// For nodes out of view the width of their spacing is taken times this; 0 leaves them out. Above 0 for
  /// shadows, which come from outside.
  double outside = 0;
  std::optional<Bounds> box;  ///< only nodes that reach into it
};

struct NodeSelection {
  std::vector<std::vector<std::size_t>> nodes;  ///< by tree: numbers in `Tree::nodes`, sorted
  /// By tree: how many of the points of these nodes are wanted, evenly; ~0: all.
  std::vector<std::uint64_t> wanted;
  std::uint64_t points = 0;         ///< in them
  std::uint64_t points_needed = 0;  ///< by the rule, without a budget
  std::uint64_t points_in_files = 0;
  std::size_t nodes_read = 0, nodes_needed = 0, nodes_in_files = 0;
  /// The widest spacing in pixels that is left where the budget ended the reading; `least_px` or less when it
  /// did not.
  double widest_px = 0;

  bool is_complete() const { return points == points_needed; }
  bool reads_like(const NodeSelection& other) const { return nodes == other.nodes && wanted == other.wanted; }
};

/// Several views: what any of them needs.
NodeSelection select_nodes(std::span<const Tree> trees, std::span<const View> views,
                           const SelectOptions& options);

/// The coarse levels of all trees, where they reach into `box`, as far as `budget` points reach; whole levels
/// of spacing at a time, and one in any case, thinned where that alone is more.
NodeSelection select_overview(std::span<const Tree> trees, std::uint64_t budget,
                              const std::optional<Bounds>& box = {});

}  // namespace sfumato::copc
